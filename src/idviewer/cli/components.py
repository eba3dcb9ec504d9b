"""Commands on all components of a mesh, each on its own: `--component all`."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from idviewer.cli import commands, output, parsing, point_distances, shape_info
from idviewer.cli.options import EVERY_COMPONENT, DisplayOptions, Endpoints, PictureQuery, ReadingOptions

if TYPE_CHECKING:
    from idviewer.cli.distance_options import ChosenDistance
    from idviewer.core import InteriorDistance, Shape
    from idviewer.session import Frame, SpectrumCache


def shapes_of(name: str, reading: ReadingOptions) -> tuple[Shape, ...]:
    """All components or parts in the file of that name; what was repaired is told on standard error."""
    from idviewer.core import read_mesh, read_meshes
    from idviewer.view.vtk_files import register_vtk_reader

    register_vtk_reader()
    path = parsing.path_of(name)
    if shape_info.is_polygon(path):
        raise ValueError(
            f"{name}: a polygon has no components, and one is taken at a time; choose it by --part NAME"
        )
    repairs = parsing.repairs_of(reading)
    shapes: list[Shape] = []
    for part in parsing.parts_of(path) if reading.part == EVERY_COMPONENT else [reading.part]:
        if reading.component == EVERY_COMPONENT:
            found = list(read_meshes(path, part, repairs))
        else:
            found = [read_mesh(path, parsing.component_of(reading.component), part, repairs)]
        if part is not None:
            numbers = ", ".join(str(len(shapes) + one) for one in range(1, len(found) + 1))
            print(f"idviewer: {name}: part {part} is component {numbers} of the result", file=sys.stderr)
        shapes += found
    for note in dict.fromkeys(note for shape in shapes for note in shape.notes):
        print(f"idviewer: {name}: {note}", file=sys.stderr)
    return tuple(shapes)


def barycentroids(
    shapes: Sequence[Shape], chosen: ChosenDistance, cache: SpectrumCache | None, json: bool
) -> str:
    """The barycentroid of each component: a row each of a table, or a list in JSON."""
    rows, entries = [], []
    for number, shape in enumerate(shapes, 1):
        solver = commands.solver_of(shape, chosen, cache)
        found = solver.barycentroid()
        commands.print_remarks(commands.remarks_on_weights(solver))
        rows.append([number, *found.point.tolist(), found.potential])
        entries.append(
            {"component": number, **_head(solver), "point": found.point, "potential": found.potential}
        )
    if json:
        return output.as_json({"components": entries})
    return _table(("component", "x", "y", "z", "potential"), rows)


def distances(
    endpoints: Endpoints,
    shapes: Sequence[Shape],
    chosen: ChosenDistance,
    cache: SpectrumCache | None,
    json: bool,
) -> str:
    """Distances within each component; points that do not lie in it have none there."""
    if endpoints.points is None:
        return _distances_of_pair(endpoints, shapes, chosen, cache, json)
    from idviewer.core.interior import place_points

    named = parsing.source_of(endpoints.source or "", 3)
    table = point_distances.read_table(str(endpoints.points), 3)
    points = table.points.tolist()
    owners = np.zeros(len(points), np.int64)
    found = np.full(len(points), np.nan)
    entries: list[dict[str, Any]] = []
    for number, shape in enumerate(shapes, 1):
        solver = commands.solver_of(shape, chosen, cache)
        placed = place_points(solver.coordinates, table.points, table.rounding)
        inside = np.ones(len(points), bool)
        inside[placed.outside] = False
        source = named if named is not None else tuple(solver.barycentroid().point.tolist())
        owners[inside & (owners == 0)] = number
        values = np.full(len(points), np.nan)
        if inside.any() and bool(solver.contains([source])[0]):
            values[inside] = solver.field(source, placed.points[inside])
        found = np.where((owners == number) & inside, values, found)
        entries.append({"component": number, **_head(solver), "source": source, "interior": values})
    if json:
        straight = [[math.dist(entry["source"], point) for point in points] for entry in entries]
        for entry, lengths in zip(entries, straight, strict=True):
            entry["euclidean"] = lengths
        return output.as_json({"points": points, "components": entries})
    rows = [
        [*point, owner or math.nan, value] for point, owner, value in zip(points, owners, found, strict=True)
    ]
    return _table(("x", "y", "z", "component", "distance"), rows)


def _distances_of_pair(
    endpoints: Endpoints,
    shapes: Sequence[Shape],
    chosen: ChosenDistance,
    cache: SpectrumCache | None,
    json: bool,
) -> str:
    ends = [
        parsing.point_of(text or "", option, 3)
        for option, text in (("--from", endpoints.from_), ("--to", endpoints.to))
    ]
    rows, entries = [], []
    for number, shape in enumerate(shapes, 1):
        solver = commands.solver_of(shape, chosen, cache)
        both = bool(solver.contains(ends).all())
        inside = float(solver.distance(ends[:1], ends[1:])[0]) if both else math.nan
        rows.append([number, inside])
        entries.append({"component": number, **_head(solver), "interior": inside})
    if all(math.isnan(row[1]) for row in rows):
        raise ValueError(
            f"--from {endpoints.from_} --to {endpoints.to}: no component contains both points, "
            "and there is no distance from one to another"
        )
    if json:
        content = {"from": ends[0], "to": ends[1], "euclidean": math.dist(*ends), "components": entries}
        return output.as_json(content)
    return _table(("component", "distance"), rows)


def draw(
    shapes: Sequence[Shape],
    out: Path,
    chosen: ChosenDistance,
    picture: PictureQuery,
    options: DisplayOptions,
    cache: SpectrumCache | None,
) -> None:
    """Compute a picture of all components, on one scale of colours, and write it."""
    parsing.need_picture_libraries()
    from idviewer.core import Plane
    from idviewer.session import Display, State
    from idviewer.view.images import write_image_of_all

    boxes = np.array([shape.bounds for shape in shapes])
    bounds = np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
    planes = [Plane.parse(text, bounds) for text in picture.plane]
    texts = tuple(f"{output.coordinates(p.origin)}/{output.coordinates(p.normal)}" for p in planes)
    owners = _owners(shapes, picture.source)
    frames: list[Frame] = []
    for shape in shapes:
        source = picture.source if shape in owners else parsing.BARYCENTROID
        query = commands.query_of(shape, chosen, replace(picture, source=source, plane=texts))
        frames.append(commands.frame_of(shape, query, cache))
    for place, text in enumerate(picture.plane):
        if not any(len(frame.slices[place].points) for frame in frames):
            raise ValueError(f"--plane {text}: the plane misses all components")
    display = Display(isolines=options.isolines, colormap=options.colormap, opacity=options.opacity)
    drawn = [(State(one.shape, one.query, display), one) for one in on_one_scale(frames)]
    try:
        write_image_of_all(out, drawn, parsing.size_of(options.size), transparent=options.transparent)
    except RuntimeError as error:
        raise OSError(str(error)) from error
    commands.print_remarks(list(dict.fromkeys(remark for frame in frames for remark in frame.remarks)))


def on_one_scale(frames: Sequence[Frame]) -> list[Frame]:
    """The same frames, coloured from the smallest to the largest value of all; the title tells of it."""
    if len(frames) == 1:
        return list(frames)
    low = min(frame.value_range[0] for frame in frames)
    high = max(frame.value_range[1] for frame in frames)
    titles = {frame.title for frame in frames}
    named = (
        titles.pop() if len(titles) == 1 else f"{frames[0].query.distance.title} of each by its own lambda_2"
    )
    title = f"{named}; {len(frames)} components on one scale"
    return [replace(frame, value_range=(low, high), title=title) for frame in frames]


def _owners(shapes: Sequence[Shape], source: str) -> list[Shape]:
    """The components that contain the source; all others have their own barycentroids."""
    point = parsing.source_of(source, 3)
    if point is None:
        return []
    owners = [shape for shape in shapes if _is_inside(shape, point)]
    if not owners:
        raise ValueError(f"--source {source}: no component contains this point")
    if len(shapes) > len(owners):
        commands.print_remarks(["components without the source show distances from their own barycentroids"])
    return owners


def _is_inside(shape: Shape, point: parsing.Point) -> bool:
    """As everywhere: a point that rounding put just outside is on the surface."""
    from idviewer.core import MeanValueCoordinates
    from idviewer.core.interior import place_points

    return len(place_points(MeanValueCoordinates(shape), [point]).outside) == 0


def _head(solver: InteriorDistance) -> dict[str, Any]:
    from idviewer.core import Mesh

    shape = solver.shape
    assert isinstance(shape, Mesh)
    return {"faces": len(shape.faces), "volume": shape.volume, **commands.distance_as_json(solver)}


def _table(columns: tuple[str, ...], rows: Sequence[Sequence[float]]) -> str:
    """CSV with whole numbers of components, and nothing where there is no value."""
    place = columns.index("component")
    lines = [",".join(columns)]
    for row in rows:
        cells = [
            "" if math.isnan(value) else str(int(value)) if at == place else repr(float(value))
            for at, value in enumerate(row)
        ]
        lines.append(",".join(cells))
    return "\n".join(lines)
