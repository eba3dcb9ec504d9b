"""Options of the commands on collections of shapes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from idviewer.cli.options import DisplayOptions, Flag, PictureQuery


@Parameter(name="*")
@dataclass(frozen=True)
class CollectionOptions:
    """Which shapes, and how the work on them is shared out.

    Attributes:
        manifest: A CSV file that lists shapes in a column `path`, with options of their own in others.
        shard: Do only the I-th of N shares of the shapes, counted from 1.
        jobs: Processes on this machine; as many as it has cores and memory for by default.
        memory: Gigabytes that they may take together; most of what there is by default.
        scheduler: Have the workers of this Dask scheduler do it instead.
        parquet: Write the table as Parquet, too.
        quiet: Tell nothing on standard error but errors.
    """

    manifest: Annotated[Path | None, Parameter(metavar="LIST.csv")] = None
    shard: Annotated[str | None, Parameter(metavar="I/N")] = None
    jobs: Annotated[int | None, Parameter(metavar="N")] = None
    memory: Annotated[float | None, Parameter(metavar="GB")] = None
    scheduler: Annotated[str | None, Parameter(metavar="tcp://HOST:PORT")] = None
    parquet: Flag = False
    quiet: Flag = False


@Parameter(name="*")
@dataclass(frozen=True)
class OutputOptions:
    """What is written of each shape beside its JSON file.

    Attributes:
        pictures: A picture.
        descriptors: Descriptors, by which `idviewer compare` compares shapes.
        landmarks: Distances between the points of a CSV file; {name} and {stem} stand for the shape's.
        fields: The potential and the distance from the barycentroid at the vertices, as VTP.
        grids: Both on a regular grid inside, with so many nodes along the longest side.
        grid_format: Of the grid's file.
        query: Contents of the picture.
        display: Appearance of the picture.
    """

    pictures: Flag = False
    descriptors: Flag = False
    landmarks: Annotated[str | None, Parameter(metavar="POINTS.csv")] = None
    fields: Flag = False
    grids: Annotated[int | None, Parameter(metavar="N")] = None
    grid_format: Literal["npz", "vti"] = "npz"
    query: PictureQuery = field(default_factory=PictureQuery)
    display: DisplayOptions = field(default_factory=DisplayOptions)


@Parameter(name="*")
@dataclass(frozen=True)
class ComparisonOptions:
    """What shapes are compared by, and what is written.

    Attributes:
        by: A part of the descriptors, or the sum of all.
        with_size: Tell shapes of different sizes apart, by eigenvalues in one over the unit squared.
        matrix: Write the matrix into a CSV file instead of standard output.
        picture: Draw a dendrogram.
        json: Print JSON, which has all parts and the errors of sampling.
        jobs: Processes; as many as there are cores and memory for by default.
    """

    by: Literal["all", "eigenvalues", "distances", "potential"] = "all"
    with_size: Flag = False
    matrix: Annotated[Path | None, Parameter(metavar="OUT.csv")] = None
    picture: Annotated[Path | None, Parameter(metavar="OUT.png")] = None
    json: Flag = False
    jobs: Annotated[int | None, Parameter(metavar="N")] = None
