"""SVG drawings: one element's outline, its curves flattened.

svgelements (MIT) reads paths, other shapes, transforms and units.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from xml.etree.ElementTree import ParseError

import numpy as np
import svgelements

from idviewer.core.arrays import Floats
from idviewer.core.io.text import UnreadableError


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


def read_svg(data: bytes, element: str | None = None) -> list[Floats]:
    """Read the loops of the first path (or else the first other shape) of a drawing, y pointing up.

    Args:
        data: of the file.
        element: id of the element to take instead.

    Returns:
        (k, 2) points of each loop.

    Raises:
        UnreadableError: it is no drawing, has no such element, or its outline is empty or not finite.

    >>> [loop.tolist() for loop in read_svg(b'<svg><path d="M0 0H1V1z"/></svg>')]
    [[[0.0, -0.0], [1.0, -0.0], [1.0, -1.0]]]
    """
    path = _outline(_chosen(_shapes(data), element))
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


def _shapes(data: bytes) -> list[svgelements.Shape]:
    """The shapes of a drawing in their order; what only `defs` hold is not drawn."""
    try:
        drawing = svgelements.SVG.parse(io.BytesIO(data), reify=True)
        everything = list(drawing.elements())
    except ParseError as error:
        raise UnreadableError(f"line {error.position[0]}: {error.msg.partition(':')[0]}") from error
    return [item for item in everything if isinstance(item, svgelements.Shape)]


def _chosen(shapes: list[svgelements.Shape], element: str | None) -> svgelements.Shape:
    if element is not None:
        for shape in shapes:
            if shape.id == element:
                return shape
        known = ", ".join(str(shape.id) for shape in shapes if shape.id)[:100]
        raise UnreadableError(f"no shape in it has the id {element!a}; there are: {known or 'none'}")
    paths = [shape for shape in shapes if isinstance(shape, svgelements.Path)]
    if not shapes:
        raise UnreadableError("it holds no path, polygon, polyline, rect, circle or ellipse")
    return (paths or shapes)[0]


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
    if len(path) == 0:
        raise UnreadableError(f"{name} is empty")
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
