"""What the verbs do once their words are understood. Heavy modules are imported where they are used."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from idviewer.cli import output, words
from idviewer.cli.options import Asked, Ends, Looks

if TYPE_CHECKING:
    from idviewer.cli.words import Triple
    from idviewer.core import Distance, InteriorDistance, Mesh, Shape
    from idviewer.session.pipeline import Pipeline
    from idviewer.session.state import Frame, Query

MOST_ISOLINES = 200


def pair(ends: Ends, solver: Callable[[], InteriorDistance], json: bool) -> str:
    """The distance of two points, in words or JSON."""
    points = [words.point_of(ends.from_ or "", "--from"), words.point_of(ends.to or "", "--to")]
    made = solver()
    _refuse_outside(made, points, ["--from", "--to"])
    inside, straight = float(made.distance(points[:1], points[1:])[0]), math.dist(*points)
    if json:
        content = {**kind_of(made), "from": points[0], "to": points[1]}
        return output.as_json({**content, "interior": inside, "euclidean": straight})
    return f"interior   {inside!r}  ({made.description})\nEuclidean  {straight!r}"


def many(ends: Ends, solver: Callable[[], InteriorDistance], json: bool) -> str:
    """The distances of many points from one, as a table or JSON."""
    source = words.source_of(ends.source or "")
    points, lines, header = words.points_in(Path(ends.points or ""))
    made = solver()
    if source is None:
        source = tuple(made.barycentroid().point.tolist())
    places = ["--source", *(f"{ends.points}, line {n}" for n in lines)]
    _refuse_outside(made, [source, *points], places)
    distances = made.field(source, points).tolist()
    if json:
        content = {**kind_of(made), "source": source, "points": points}
        return output.as_json(
            {**content, "interior": distances, "euclidean": [math.dist(source, p) for p in points]}
        )
    rows = [(*point, value) for point, value in zip(points, distances, strict=True)]
    return output.table(("x", "y", "z", "distance"), rows, header)


def _refuse_outside(solver: InteriorDistance, points: Sequence[Triple], places: list[str]) -> None:
    """An error that says which points are not in the body."""
    mesh = solver.shape
    outside = [index for index, inside in enumerate(solver.contains(points)) if not inside]
    if outside:
        more = f" (and {len(outside) - 1} more)" if len(outside) > 1 else ""
        point = output.coordinates(points[outside[0]])
        raise ValueError(f"{places[outside[0]]}: the point {point} lies outside the mesh{more}, {_box(mesh)}")


def _box(mesh: Shape) -> str:
    """Where the body is, for those who looked for it elsewhere."""
    corners = ("(" + ", ".join(f"{value:.4g}" for value in corner) + ")" for corner in mesh.bounds)
    return f"whose bounding box is {' to '.join(corners)}"


def solver_of(mesh: Mesh, distance: Distance) -> InteriorDistance:
    """The solver of a mesh, with its eigenpairs computed."""
    from idviewer.core import InteriorDistance

    _tell("computing the embedding; the first run also compiles kernels ...")
    return InteriorDistance(mesh, distance)


def kind_of(solver: InteriorDistance) -> dict[str, Any]:
    """The distance's name and the values of its parameters, for JSON."""
    from idviewer.core.distances import values_of

    distance = solver.distance_kind
    lambda_2 = float(solver.spectrum.values[0]) if distance.spectral else None
    return {"distance": distance.name, **values_of(distance, lambda_2)}


def check(asked: Asked, looks: Looks) -> None:
    """Refuses what cannot be drawn, before anything is read or computed."""
    words.source_of(asked.source)
    words.size_of(looks.size)
    if not 0 <= looks.isolines <= MOST_ISOLINES:
        raise ValueError(f"--isolines {looks.isolines}: 0 to {MOST_ISOLINES} can be drawn")
    if not 0.0 <= looks.opacity <= 1.0:
        raise ValueError(f"--opacity {looks.opacity}: it lies between 0 (not seen) and 1")


def draw(mesh: Mesh, out: Path, distance: Distance, asked: Asked, looks: Looks) -> None:
    """Computes a picture and writes it."""
    words.need_picture_libraries()
    from idviewer.core import Plane
    from idviewer.session.state import Display, Query, State
    from idviewer.view.images import write_image

    planes = tuple(Plane.parse(plane, mesh.bounds) for plane in asked.plane)
    query = Query(planes, words.source_of(asked.source), distance, asked.quantity)
    display = Display(isolines=looks.isolines, colormap=looks.colormap, opacity=looks.opacity)
    frame = _frame(mesh, query)
    for text, section in zip(asked.plane, frame.slices, strict=False):
        if not len(section.points):
            raise ValueError(f"--plane {text}: the plane misses the body, {_box(mesh)}")
    state = State(mesh, frame.query, display)
    try:
        write_image(out, state, frame, words.size_of(looks.size), transparent=looks.transparent)
    except RuntimeError as error:
        raise OSError(str(error)) from error


def _frame(mesh: Mesh, query: Query) -> Frame:
    """What a query asks for; without a plane, on the one that the window shows first."""
    from idviewer.core import Plane
    from idviewer.session.pipeline import Pipeline
    from idviewer.session.session import default_plane

    pipeline = Pipeline()
    if not query.planes:
        centre = _finest(pipeline, mesh, query).barycentroid
        query = replace(query, planes=(Plane(tuple(centre.tolist()), default_plane(mesh).normal),))
    return _finest(pipeline, mesh, query)


def _finest(pipeline: Pipeline, mesh: Mesh, query: Query) -> Frame:
    """The exact frame of a query; a person who waits at a terminal is told the stages."""
    from idviewer.session.state import Failure, Frame, FrameRequest, Progress

    frame, told = None, ""
    for result in pipeline.results(FrameRequest(mesh, query)):
        if isinstance(result, Failure):
            raise result.error
        if isinstance(result, Progress) and result.stage != told:
            told = result.stage
            _tell(f"{told} ...")
        frame = result if isinstance(result, Frame) else frame
    assert frame is not None
    return frame


def _tell(progress: str) -> None:
    if sys.stderr.isatty():
        print(f"idviewer: {progress}", file=sys.stderr)
