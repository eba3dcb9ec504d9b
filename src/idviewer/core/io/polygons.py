"""The door for polygon files, and the one for files of either kind of shape."""

from __future__ import annotations

import json
import os
from pathlib import Path

from idviewer.core.arrays import Floats
from idviewer.core.errors import ShapeError
from idviewer.core.io.atomic_write import atomic_path
from idviewer.core.io.contents import Contents, FileSource, PartError
from idviewer.core.io.files import bytes_of
from idviewer.core.io.formats import format_of, one_line, readable_suffixes, why_unreadable
from idviewer.core.io.listed_points import without_repeated_points
from idviewer.core.io.meshes import read_mesh
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.repairs import NO_REPAIRS, Repairs
from idviewer.core.shapes.shape import PolygonLike, as_polygon
from idviewer.core.validation.repair_choices import ComponentChoice


def read_polygon(
    path: str | os.PathLike[str], samples: int | None = None, part: str | None = None
) -> Polygon:
    """Read the polygon in a file: CSV, SVG, JSON, GeoJSON or WKT, by its suffix.

    CSV holds x,y in each line, a header perhaps, and a blank line or nan,nan between loops. JSON holds a list
    of [x, y], or {"outer": [...], "holes": [[...], ...]}, or GeoJSON, or what labelme, COCO and VIA write.
    WKT holds polygons. Of an SVG drawing a shape is taken; its curves become chords within 1e-4 of the
    diagonal, and y points up. Degrees of longitude and latitude are projected to metres.

    Args:
        path: of the file.
        samples: how many points to take along the boundary (see `Polygon.resampled`); the file's own vertices
            by default.
        part: which of several shapes in the file to take, by its name: the id of an SVG element, the name or
            id of a GeoJSON feature, a label; or by its number.

    Raises:
        PolygonError: there is no such file, it cannot be read, it is damaged, or what it holds is no simple
            polygon. The message is one line that names the file.
    """
    path = Path(path)
    try:
        contents = _contents(path, part)
        listed = without_repeated_points(contents.geometry)
        polygon = Polygon.of_loops(listed.loops).with_numbering(listed.numbering)
        polygon = polygon if samples is None else polygon.resampled(samples)
    except PolygonError as error:
        raise PolygonError(f"{one_line(path)}: {error}").with_parts(error.parts) from error
    return polygon.with_labels(path.stem, (*contents.notes, *listed.notes), contents.unit)


def read_shape(
    path: str | os.PathLike[str],
    component: ComponentChoice | None = None,
    samples: int | None = None,
    part: str | None = None,
    repairs: Repairs = NO_REPAIRS,
) -> Mesh | Polygon:
    """Read the mesh or the polygon in a file, by its suffix; see `read_mesh` and `read_polygon`.

    Args:
        path: of the file.
        component: which of a mesh's components to take, 1 or "largest" for that of the largest volume.
        samples: how many points to take along a polygon's boundary.
        part: which of several shapes in the file to take, by its name.
        repairs: of a mesh: those that change the shape, to be made first; none by default.

    Raises:
        ShapeError: a MeshError or a PolygonError.

    >>> from idviewer.core import sample_path
    >>> read_shape(sample_path("star")).dimension, read_shape(sample_path("cat_2k")).dimension
    (2, 3)
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in readable_suffixes(2):
        if component is not None:
            raise PolygonError(f"{one_line(path)}: a polygon has no components; leave the component out")
        if repairs:
            raise PolygonError(
                f"{one_line(path)}: only meshes are repaired by name; leave {repairs.options} out"
            )
        return read_polygon(path, samples, part)
    if samples is not None:
        raise ShapeError(
            f"{one_line(path)}: only polygons are sampled along their boundary; leave the samples out"
        )
    if path.is_file() and (problem := why_unreadable(path)):
        raise ShapeError(f"{one_line(path)}: {problem}")
    return read_mesh(path, component, part, repairs)


def write_polygon(polygon: PolygonLike, path: str | os.PathLike[str]) -> None:
    """Write a polygon as CSV or JSON, by the suffix, with every digit.

    It is written beside the file and then renamed, so that the file is there as a whole or not at all.

    Args:
        polygon: n vertices.
        path: of the file, which is replaced where there is one.

    Raises:
        PolygonError: another suffix.
        OSError: the file cannot be written.
    """
    polygon, path = as_polygon(polygon), Path(path)
    if path.suffix.lower() not in (".csv", ".json"):
        raise PolygonError(f"{one_line(path)}: polygons are written as .csv or .json; choose one of these")
    loops = [polygon.vertices[loop].tolist() for loop in polygon.loops]
    if path.suffix.lower() == ".json":
        text = json.dumps({"outer": loops[0], "holes": loops[1:]}) + "\n"
    else:
        text = "x,y\n" + "\n".join("".join(f"{x!r},{y!r}\n" for x, y in loop) for loop in loops)
    with atomic_path(path) as part:
        part.write_text(text, encoding="utf-8")


def _contents(path: Path, part: str | None) -> Contents[list[Floats]]:
    """Read the loops in a file, unchecked."""
    try:
        data = bytes_of(path, 2)
    except UnreadableError as error:
        raise PolygonError(str(error)) from error
    known = format_of(path)
    assert known is not None
    try:
        contents = known.contents(FileSource(data, path, part))
        if not contents.geometry:
            raise UnreadableError("it holds no points")
        return contents
    except PartError as error:
        raise PolygonError(one_line(error)).with_parts(error.parts) from error
    except UnreadableError as error:
        raise PolygonError(f"not a polygon as {known.title}: {one_line(error)}; correct the file") from error
    except Exception as error:  # rubbish can make a parser raise anything; out of this door comes one line
        cause = one_line(f"{type(error).__name__}: {error}")[:100]
        raise PolygonError(f"not a readable {known.title} file ({cause}); export it again") from error
