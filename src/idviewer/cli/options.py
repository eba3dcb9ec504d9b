"""Options that belong together, and how they are spelt and explained."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from cyclopts import Parameter

Flag = Annotated[bool, Parameter(negative="", show_default=False)]
PointText = Annotated[str | None, Parameter(allow_leading_hyphen=True, metavar="X,Y[,Z]")]
SOURCE_OPTION = Parameter(allow_leading_hyphen=True, metavar="X,Y[,Z]|barycentroid")
PlaneTexts = Annotated[
    tuple[str, ...],
    Parameter(
        allow_leading_hyphen=True, negative="", show_default=False, metavar="AXIS=FRACTION|OX,OY,OZ/NX,NY,NZ"
    ),
]
ParameterTexts = Annotated[
    tuple[str, ...],
    Parameter(allow_leading_hyphen=True, negative="", show_default=False, metavar="NAME=VALUE"),
]
PartName = Annotated[
    str | None, Parameter(name=("--part", "--label"), metavar="NAME", allow_leading_hyphen=True)
]
Component = Annotated[str | None, Parameter(metavar="N|largest|all", allow_leading_hyphen=True)]
EVERY_COMPONENT = "all"
"""The word for all components, each on its own."""

RefineText = Annotated[str, Parameter(metavar="no|auto|H", allow_leading_hyphen=True)]
NoCache = Annotated[bool, Parameter(name="--no-cache", negative="", show_default=False)]


@Parameter(name="*")
@dataclass(frozen=True)
class DistanceOptions:
    """The distance that is carried inside, and its coordinates.

    Attributes:
        distance: The boundary distance that is carried inside; listed below.
        set: A parameter of the distance, listed below; may be repeated.
        time: The same as --set time=T, the diffusion time in the shape's unit squared.
        coordinates: The barycentric coordinates that carry it; listed below.
        refine: Whether edges that are too long for the distance are cut: no, auto, or the longest allowed.
    """

    distance: Annotated[str, Parameter(metavar="NAME")] = "diffusion"
    set: ParameterTexts = ()
    time: Annotated[float | None, Parameter(metavar="T", allow_leading_hyphen=True)] = None
    coordinates: Annotated[str, Parameter(metavar="NAME")] = "mean_value"
    refine: RefineText = "auto"


@Parameter(name="*")
@dataclass(frozen=True)
class PictureQuery:
    """Contents of a picture.

    Attributes:
        source: Where distances are measured from.
        plane: A slicing plane of a mesh, such as z=0.5 (half-way through the body); may be repeated.
        quantity: The distance from the source, or the barycentroid's potential U.
    """

    source: Annotated[str, SOURCE_OPTION] = "barycentroid"
    plane: PlaneTexts = ()
    quantity: Literal["distance", "potential"] = "distance"


@Parameter(name="*")
@dataclass(frozen=True)
class DisplayOptions:
    """Appearance of a picture.

    Attributes:
        isolines: Number of equal steps that isolines separate; 0 draws none.
        colormap: Blue to red as in the paper, or perceptually even.
        opacity: Of the body, 0 to 1.
        size: In pixels.
        transparent: Leave the background transparent.
    """

    isolines: int = 20
    colormap: Literal["paper", "even"] = "paper"
    opacity: float = 0.25
    size: Annotated[str, Parameter(metavar="WxH")] = "1280x900"
    transparent: Flag = False


@Parameter(name="*")
@dataclass(frozen=True)
class Endpoints:
    """Between which points distances are wanted: --from and --to, or --source and --points.

    Attributes:
        from_: One point.
        to: The other point.
        source: The point that many distances are measured from.
        points: The many: a table with columns x,y,z, or x,y for a polygon, and perhaps others, such as an id;
            - is standard input.
        out: A file for the result of --points; - is standard output.
    """

    from_: Annotated[PointText, Parameter(name="--from")] = None
    to: PointText = None
    source: Annotated[str | None, SOURCE_OPTION] = None
    points: Annotated[str | None, Parameter(metavar="FILE|-", allow_leading_hyphen=True)] = None
    out: Annotated[str | None, Parameter(metavar="FILE|-", allow_leading_hyphen=True)] = None


@Parameter(name="*")
@dataclass(frozen=True)
class RepairOptions:
    """Repairs that change a mesh, and are made only where they are asked for.

    Attributes:
        weld: Close gaps up to this width, in the shape's unit.
        fill_holes: Fill holes of at most so many edges.
        drop_walls: Leave out walls inside, and faces that bound no solid.
        unite: Make one body of closed parts that overlap each other.
    """

    weld: Annotated[float | None, Parameter(metavar="W", allow_leading_hyphen=True)] = None
    fill_holes: Annotated[int | None, Parameter(metavar="N", allow_leading_hyphen=True)] = None
    drop_walls: Flag = False
    unite: Flag = False


@Parameter(name="*")
@dataclass(frozen=True)
class BodyChoice:
    """Which of several bodies is meant.

    Attributes:
        component: Which of a mesh's components to take: its number, 1 or largest for that of the largest
            volume, or all.
        part: Which of several shapes in a file to take, by its name.
    """

    component: Component = None
    part: PartName = None


@Parameter(name="*")
@dataclass(frozen=True)
class ReadingOptions(RepairOptions):
    """Options for reading a shape and its eigenpairs.

    Attributes:
        weld: Close gaps of a mesh up to this width, in its unit.
        fill_holes: Fill a mesh's holes of at most so many edges.
        drop_walls: Leave out a mesh's walls inside, and faces that bound no solid.
        unite: Make one body of a mesh's closed parts that overlap each other.
        component: Which of a mesh's components to take: its number, 1 or largest for that of the largest
            volume, or all, each on its own.
        part: Which of several shapes in a file to take, by its name; the label of a volume, or a threshold;
            or all, each on its own.
        no_cache: Neither read nor keep eigenpairs on disk.
    """

    component: Component = None
    part: PartName = None
    no_cache: NoCache = False

    @property
    def takes_all(self) -> bool:
        """Whether all components, or all parts of a file, are to be taken, each on its own."""
        return EVERY_COMPONENT in (self.component, self.part)
