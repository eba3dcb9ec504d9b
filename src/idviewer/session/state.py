"""The nouns that cross layers and threads: Query, Display, State, Frame and what else the pipeline yields.

All are frozen, and their arrays are read-only, so any thread may read them at any time.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from idviewer.core import Diffusion, DiscretisationError, Distance, Mesh, Plane, Repairs, Shape
from idviewer.core.sampling import SliceValues
from idviewer.core.shapes import AXES, Health, RawBody, RepairOutcome
from idviewer.core.spectrum import Refine
from idviewer.core.validation import ComponentChoice

Quantity = Literal["distance", "potential"]
Point = tuple[float, float, float]


@dataclass(frozen=True)
class Query:
    """The computation that is asked for.

    Attributes:
        planes: the slicing planes, each giving one slice; a polygon has one slice, in z = 0, in any case.
        source: where distances are measured from, with z = 0 in a polygon; None stands for the barycentroid.
        distance: the boundary distance that is carried inside.
        quantity: "distance" from the source, or the barycentroid's "potential" U.
        coordinates: the name of the coordinates that carry it.
        refine: how the boundary is refined: "auto", "no", or the longest edge allowed, in the shape's unit.
    """

    planes: tuple[Plane, ...] = ()
    source: Point | None = None
    distance: Distance = field(default_factory=Diffusion)
    quantity: Quantity = "distance"
    coordinates: str = "mean_value"
    refine: Refine = "auto"


MAX_ISOLINES = 200
"""Of a picture: more of them merge."""


@dataclass(frozen=True)
class Display:
    """Appearance of the result; nothing here makes the pipeline compute anything.

    Attributes:
        isolines: number of equal steps of the value range that isolines separate; 0 draws none.
        colormap: a name of `idviewer.view.colormaps`.
        opacity: of the body, 0 to 1.
        barycentroid: whether the blue sphere is shown.
        scale_bar: whether the scale bar is shown.
        handle: whether the active plane's handle is shown.
        active_plane: index of the plane that the handle and the slider move.
    """

    isolines: int = 20
    colormap: str = "paper"
    opacity: float = 0.25
    barycentroid: bool = False
    scale_bar: bool = True
    handle: bool = True
    active_plane: int = 0


@dataclass(frozen=True)
class State:
    """A shape (None before the first one is open), a query and a display."""

    shape: Shape | None = None
    query: Query = field(default_factory=Query)
    display: Display = field(default_factory=Display)

    def with_(self, **fields: object) -> State:
        """A copy in which fields of the query or the display, given by name, are replaced.

        >>> State().with_(isolines=12, quantity="potential").display.isolines
        12
        """
        query = {name: value for name, value in fields.items() if name in Query.__dataclass_fields__}
        display = {name: value for name, value in fields.items() if name in Display.__dataclass_fields__}
        unknown = fields.keys() - query.keys() - display.keys()
        if unknown:
            raise TypeError(f"neither a query nor a display has {', '.join(sorted(unknown))}")
        return replace(self, query=replace(self.query, **query), display=replace(self.display, **display))  # type: ignore[arg-type]


@dataclass(frozen=True)
class Frame:
    """A computed picture that describes itself; the view draws what the frame says.

    Attributes:
        shape: the shape it belongs to.
        query: the query it answers.
        slices: one for each plane of the query; of a polygon one.
        level: 0 for the coarsest; a finer level adds samples.
        exact: whether no better frame will come: every value is a direct computation, nothing interpolated,
            and the barycentroid is that of the query's distance.
        error: estimated largest error of a value, in the values' unit (0.0 when exact).
        source: (3,) where the distance is measured from.
        barycentroid: (3,) the shape's barycentroid; in a frame that is not exact it may be that of the
            distance shown before, and the source with it.
        value_range: smallest and largest value over the whole body: what the colours span.
        title: names the quantity and its parameters, for the scale bar.
        lambda_2: the shape's first non-zero eigenvalue, which a distance's parameters are measured by; None
            while no eigenpairs are there.
        modes: the number of eigenpairs that are used; 0 without.
        remarks: what the user has to know of the values, one sentence each.
        preview: None, or of a picture made from a simplified mesh while the mesh's own eigenpairs are being
            computed, the estimated largest error of a distance as a share of the largest on the boundary.
        discretisation: the estimated errors by the discretisation of the boundary; None where they are not
            known yet, or there are none.
        refinement: in words, how many vertices were added to the boundary and why; empty where none were.
    """

    shape: Shape
    query: Query
    slices: tuple[SliceValues, ...]
    level: int
    exact: bool
    error: float
    source: NDArray[np.float64]
    barycentroid: NDArray[np.float64]
    value_range: tuple[float, float]
    title: str
    lambda_2: float | None = None
    modes: int = 0
    remarks: tuple[str, ...] = ()
    preview: float | None = None
    refinement: str = ""
    discretisation: DiscretisationError | None = None


@dataclass(frozen=True)
class Snapshot:
    """Everything that is shown: the state, the file it came from, the last frame, and what is known of it."""

    state: State
    path: Path | None
    frame: Frame | None
    ready: Ready | None


@dataclass(frozen=True)
class Progress:
    """A stage of long work, in words for the user, and the share done (None where it cannot be told)."""

    stage: str
    share: float | None = None


@dataclass(frozen=True)
class Opened:
    """A shape was read from path."""

    shape: Shape
    path: Path


@dataclass(frozen=True)
class Ready:
    """A shape's embedding is there: its number of modes (0 without eigenpairs) and (3,) a barycentroid.

    In a preview they are those of a simplified mesh. Where a first view was kept, plane is the one it shows.
    """

    shape: Shape
    modes: int
    barycentroid: NDArray[np.float64]
    preview: bool = False
    plane: Plane | None = None


@dataclass(frozen=True)
class Failure:
    """Something asked for could not be done; errors are results, not crashes."""

    error: Exception


@dataclass(frozen=True)
class Finished:
    """Everything asked for by a request has been delivered."""


@dataclass(frozen=True)
class OpenRequest:
    """Read a mesh or a polygon.

    Attributes:
        path: of the file.
        component: of a mesh's components, which to take, 1 for that of the largest volume.
        part: of several shapes in the file, the name of the one to take.
    """

    path: Path
    component: ComponentChoice | None = None
    part: str | None = None


@dataclass(frozen=True)
class FrameRequest:
    """Compute frames of a shape, coarse to fine.

    Attributes:
        shape: the shape.
        query: what to compute.
        centre: the barycentroid before the shape's vertices were moved; it stands for the new one, if it is
            inside, until that is found.
    """

    shape: Shape
    query: Query
    centre: Point | None = None


@dataclass(frozen=True)
class ExamineRequest:
    """Find everything that is wrong with a body, and where."""

    body: RawBody


@dataclass(frozen=True)
class RepairRequest:
    """Repair a body.

    Attributes:
        body: as it was read.
        repairs: to make.
        foretell: whether what they would change is only told.
    """

    body: RawBody
    repairs: Repairs
    foretell: bool = False


@dataclass(frozen=True)
class DropRequest:
    """Stop, and forget half-done work."""


@dataclass(frozen=True)
class Examined:
    """A body was looked at."""

    health: Health


@dataclass(frozen=True)
class Foretold:
    """An account of what repairs change; they have not been made."""

    outcome: RepairOutcome


@dataclass(frozen=True)
class Repaired:
    """A body was repaired."""

    shape: Mesh
    outcome: RepairOutcome


BodyRequest = OpenRequest | ExamineRequest | RepairRequest
"""Requests that must not be replaced by frames, which come again when they are done."""
Request = BodyRequest | FrameRequest | DropRequest
Result = Frame | Progress | Opened | Ready | Examined | Foretold | Repaired | Failure | Finished


def default_plane(shape: Shape) -> Plane:
    """The plane through the middle of a shape's bounding box, across its shortest side: the broadest view.

    Its normal points to where shapes are looked at from: -y is the front of one that stands on z.
    """
    axis = list(AXES)[int(np.argmin(np.ptp(shape.bounds, axis=0)))]
    plane = Plane.along(axis, 0.5, shape.bounds)
    return Plane(plane.origin, (0.0, -1.0, 0.0)) if axis == "y" else plane
