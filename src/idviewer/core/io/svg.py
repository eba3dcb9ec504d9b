"""SVG drawings: one shape's outline, its curves flattened.

svgelements (MIT) reads paths, other shapes, transforms and units.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
import svgelements

from idviewer.core.arrays import Floats
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.outlines import Outline, chosen_outline
from idviewer.core.io.svg_tree import drawn_tree, parsed_tree
from idviewer.core.io.svg_viewports import user_unit
from idviewer.core.io.text import UnreadableError
from idviewer.core.validation.polygon_checks import signed_area


@dataclass(frozen=True)
class CurveFlattening:
    """Settings by which curves become chords.

    Attributes:
        tolerance: chords stay nearer to their curve than this share of the outline's diagonal.
        most_chords: of one curve.
    """

    tolerance: float = 1e-4
    most_chords: int = 10_000


FLATTENING = CurveFlattening()
INKSCAPE_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
OF_THE_PAGE = frozenset({"width", "height", "viewBox", "x", "y"})
"""Attributes of the outermost element that say where the drawing lies on a page."""


def read_svg(source: FileSource) -> Contents[list[Floats]]:
    """Read the one shape that is drawn, or the chosen one, y pointing up.

    Coordinates are the drawing's own, times what one of them is in the unit of its width; pixels where that
    has none. What is not seen, and what has no area, does not count.

    Args:
        source: the file, with the id of the shape to take, or its number among those drawn.

    Returns:
        (k, 2) points of each loop.

    Raises:
        UnreadableError: it is no drawing, has no such shape, or its outline is empty or not finite.

    >>> from pathlib import Path
    >>> data = b'<svg width="2mm" viewBox="0 0 1 1"><path d="M0 0H1V1z"/></svg>'
    >>> read = read_svg(FileSource(data, Path("a.svg")))
    >>> [loop.tolist() for loop in read.geometry], read.unit
    ([[[0.0, -0.0], [2.0, -0.0], [2.0, -2.0]]], 'mm')
    """
    root = parsed_tree(source.data)
    scale, unit, viewport = user_unit(root.attrib)
    shapes, notes = _shapes(drawn_tree(root, viewport))
    if not shapes:
        raise UnreadableError("it holds no path, polygon, polyline, rect, circle or ellipse")
    outlines, problems = _outlines(shapes, np.array(scale))
    if not outlines:
        raise problems[0]
    notes += [f"A shape was passed over: {problem}." for problem in problems]
    outline = chosen_outline(source, outlines, "shapes", unit)
    return Contents(list(outline.loops), (*notes, *outline.notes), unit)


def _shapes(root: ElementTree.Element) -> tuple[list[svgelements.Shape], list[str]]:
    """The shapes that are drawn, in their order, and what is to be told of the others."""
    root.attrib = {key: value for key, value in root.attrib.items() if key not in OF_THE_PAGE}
    drawing = svgelements.SVG.parse(io.BytesIO(ElementTree.tostring(root)), reify=True, ppi=96.0)
    everything = list(drawing.elements())
    shapes = [item for item in everything if isinstance(item, svgelements.Shape)]
    notes = []
    for kind, name in ((svgelements.Text, "text"), (svgelements.Image, "image")):
        if count := sum(isinstance(item, kind) for item in everything):
            notes.append(
                f"{count:,} {name}{'' if count == 1 else 's'} in the drawing {_was(count)} passed over."
            )
    seen = [shape for shape in shapes if _is_seen(shape)]
    if shapes and seen and len(seen) < len(shapes):
        count = len(shapes) - len(seen)
        notes.append(
            f"{count:,} shape{'' if count == 1 else 's'} that cannot be seen {_was(count)} passed over."
        )
    return seen or shapes, notes


def _was(count: int) -> str:
    return "was" if count == 1 else "were"


def _is_seen(shape: svgelements.Shape) -> bool:
    told = {key: str(value).strip().lower() for key, value in shape.values.items() if isinstance(value, str)}
    if told.get("visibility") in ("hidden", "collapse") or told.get("opacity") in ("0", "0%", "0.0"):
        return False
    return not all(told.get(key) in ("none", "transparent") for key in ("fill", "stroke"))


def _outlines(shapes: list[svgelements.Shape], scale: Floats) -> tuple[list[Outline], list[UnreadableError]]:
    """The shapes with an area, or else all that can be read; and what is wrong with the others."""
    outlines, problems = [], []
    for shape in shapes:
        try:
            loops = tuple(loop * scale for loop in _loops(shape))
        except UnreadableError as error:
            problems.append(error)
            continue
        applied = [key for key in ("clip-path", "mask") if str(shape.values.get(key, "none")) != "none"]
        notes = (f"Its {' and '.join(applied)}, which cuts it, was not looked at.",) if applied else ()
        label = shape.values.get(INKSCAPE_LABEL)
        names = [str(name) for name in (shape.id, label) if name]
        outlines.append(Outline(loops, names[0] if names else "", tuple(names), notes))
    wide = [one for one in outlines if _has_area(one)]
    if not wide:
        return outlines, problems
    return wide, problems


def _has_area(outline: Outline) -> bool:
    size = math.prod(outline.extent)
    areas = [abs(signed_area(loop)) for loop in outline.loops if len(loop) > 2]
    return size > 0.0 and max(areas, default=0.0) > 1e-9 * size


def _loops(shape: svgelements.Shape) -> list[Floats]:
    """Points (k, 2) of each loop of a shape, y pointing up."""
    path = _outline(shape)
    if len(path) == 0:
        return []
    box = path.bbox()
    if box is None or not np.isfinite(box).all():
        raise UnreadableError("its outline is empty or not finite")
    tolerance = FLATTENING.tolerance * math.hypot(box[2] - box[0], box[3] - box[1])
    loops: list[list[Floats]] = []
    closed = True
    for segment in path:
        moves = isinstance(segment, svgelements.Move)
        if closed or moves:
            start = segment.end if moves else segment.start
            loops.append([np.array([[start.x, start.y]])])
        if not moves:
            loops[-1].append(_flattened(segment, tolerance))
        closed = isinstance(segment, svgelements.Close)
    merged = [_merged(np.concatenate(loop), tolerance) for loop in loops]
    return [loop * [1.0, -1.0] for loop in merged if len(loop) > 1]


def _outline(shape: svgelements.Shape) -> svgelements.Path:
    """The shape as a path. Its data are read anew, as a drawing's parser passes over what it cannot read."""
    name = f"the {'path' if isinstance(shape, svgelements.Path) else type(shape).__name__.lower()}"
    name += f" {shape.id!a}" if shape.id else ""
    path_data = shape.values.get("d") if isinstance(shape, svgelements.Path) else None
    try:
        if path_data is not None:
            svgelements.Path(path_data)
        path = abs(svgelements.Path(shape))
    except (ValueError, IndexError, TypeError, AttributeError):
        raise UnreadableError(f"{name} has data that cannot be read: {str(path_data)[:40]!a}") from None
    return path


def _flattened(segment: svgelements.PathSegment, tolerance: float) -> Floats:
    """Points along a segment, without its first."""
    if isinstance(segment, (svgelements.Line, svgelements.Close)):
        end = segment.end
        return np.array([[end.x, end.y]]) if end is not None else np.empty((0, 2))
    share = np.linspace(0.0, 1.0, _chords(segment, tolerance) + 1)[1:]
    points = np.array([[point.x, point.y] for point in map(segment.point, share.tolist())])
    points[-1] = segment.end.x, segment.end.y
    return points


def _chords(segment: svgelements.PathSegment, tolerance: float) -> int:
    """Count the chords that keep within a tolerance of a curve."""
    if tolerance == 0.0:
        return 1
    if isinstance(segment, svgelements.Arc):
        # A chord over an angle a is r (1 - cos(a / 2)) < r a^2 / 8 away.
        number = abs(segment.sweep) * math.sqrt(max(segment.rx, segment.ry) / (8.0 * tolerance))
    else:
        # A Bezier curve's second derivative: at most d (d - 1) times the second differences of its points.
        control = np.array([[point.x, point.y] for point in segment if point is not None])
        degree = len(control) - 1
        bend = np.linalg.norm(np.diff(control, 2, axis=0), axis=1).max(initial=0.0)
        number = math.sqrt(degree * (degree - 1) * bend / (8.0 * tolerance))
    return int(min(max(math.ceil(number), 1), FLATTENING.most_chords))


def _merged(points: Floats, tolerance: float) -> Floats:
    """A closed loop without points that repeat the one before, which drawings are full of."""
    near = 1e-6 * tolerance
    following = np.roll(points, -1, axis=0)
    return points[np.linalg.norm(following - points, axis=1) > near]
