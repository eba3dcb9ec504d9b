"""Checks that make points a polygon: what is wrong, where, and what to do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, Ints
from idviewer.core.errors import ShapeError
from idviewer.core.validation.polygon_crossings import crossing, folded_vertex, is_simple
from idviewer.core.validation.tolerances import TOLERANCES


class PolygonError(ShapeError):
    """A polygon that cannot be read or used; one line says what is wrong, where, and what to do."""


def points_of(vertices: ArrayLike) -> Floats:
    """Copy vertices to a new (n, 2) array.

    Raises:
        PolygonError: they are not (n, 2) numbers, or not finite.

    >>> points_of([[0, 0], [1, 0]]).tolist()
    [[0.0, 0.0], [1.0, 0.0]]
    """
    try:
        points = np.array(vertices, dtype=np.float64)
    except (TypeError, ValueError):
        raise PolygonError("vertices must be numbers in the shape (n, 2)") from None
    if points.ndim != 2 or points.shape[1] != 2:
        raise PolygonError(f"vertices must have the shape (n, 2), not {points.shape}")
    if not np.isfinite(points).all():
        first = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise PolygonError(f"{described(points, first)} is not finite; give it two ordinary numbers")
    return np.ascontiguousarray(points)


def loops_of(loops: Sequence[ArrayLike] | None, count: int) -> tuple[Ints, ...]:
    """Copy loops to arrays; by default there is one, through all vertices in order.

    Args:
        loops: indices of vertices, or None.
        count: of the vertices.

    Raises:
        PolygonError: a loop has fewer than three vertices, or a vertex is not in exactly one.

    >>> [loop.tolist() for loop in loops_of(None, 3)]
    [[0, 1, 2]]
    """
    if loops is None or len(loops) == 0:
        loops = [np.arange(count)]
    try:
        made = tuple(np.array(loop) for loop in loops)
    except (TypeError, ValueError):
        made = ()
    if not made or any(loop.ndim != 1 or (loop.size and loop.dtype.kind not in "iu") for loop in made):
        raise PolygonError("loops must be lists of vertex numbers")
    for number, loop in enumerate(made):
        if len(loop) < 3:
            which = f"loop {number}" if len(made) > 1 else "a polygon"
            raise PolygonError(
                f"{which} needs three vertices or more, and there {_are(len(loop))}; add vertices"
            )
    members = np.concatenate(made).astype(np.int64)
    if members.min() < 0 or members.max() >= count:
        worst = int(members.max() if members.max() >= count else members.min())
        raise PolygonError(f"a loop names vertex {worst}, and the vertices are 0 to {count - 1}")
    uses = np.bincount(members, minlength=count)
    if (uses != 1).any():
        vertex = int(np.flatnonzero(uses != 1)[0])
        wrong = "no loop" if uses[vertex] == 0 else f"{uses[vertex]} places of the loops"
        raise PolygonError(f"vertex {vertex} is in {wrong}; every vertex must be in one")
    return tuple(np.ascontiguousarray(loop, dtype=np.int64) for loop in made)


def _scaled(vertices: Floats) -> Floats:
    """The vertices times a power of two, so that their products neither underflow nor overflow; exact."""
    return np.ldexp(vertices, -int(np.frexp(np.abs(vertices).max())[1]))


def checked_loops(vertices: Floats, loops: tuple[Ints, ...]) -> tuple[Ints, ...]:
    """The outer loop first and counter-clockwise, then the holes, clockwise; each keeps its first vertex.

    Args:
        vertices: (n, 2).
        loops: vertex numbers of each loop, in any order and sense.

    Raises:
        PolygonError: vertices are repeated, edges fold, cross or touch, a loop has no area, or a hole lies in
            the wrong place.

    >>> square = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])
    >>> [loop.tolist() for loop in checked_loops(square, (np.arange(4),))]
    [[0, 3, 2, 1]]
    """
    successors = successors_of(loops)
    _refuse_repeated(vertices, successors)
    areas = np.array([signed_area(vertices[loop]) for loop in loops])
    outer = int(np.argmax(np.abs(areas)))
    order = [outer, *(number for number in range(len(loops)) if number != outer)]
    simple = is_simple(_scaled(vertices), tuple(loops[number] for number in order))
    if not simple:
        _refuse_crossing(vertices, successors)
    _refuse_empty(vertices, loops, areas)
    oriented = tuple(loops[n] if (areas[n] > 0.0) == (n == outer) else _reversed(loops[n]) for n in order)
    if not simple:
        _refuse_nesting(vertices, oriented)
        raise PolygonError("the outline crosses or touches itself; move its vertices apart")
    return oriented


def _refuse_empty(vertices: Floats, loops: tuple[Ints, ...], areas: Floats) -> None:
    """Raise PolygonError if a loop encloses no area."""
    span = float(np.ptp(vertices, axis=0).max())
    for loop, area in zip(loops, areas.tolist(), strict=True):
        if abs(area) <= TOLERANCES.area_of_loop * span**2 * len(loop):
            raise PolygonError(
                f"the loop from {described(vertices, int(loop[0]))} on encloses no area; "
                "move its vertices apart"
            )


def signed_area(points: Floats) -> float:
    """Area enclosed by a loop (p, 2), positive if it runs counter-clockwise.

    >>> signed_area(np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]))
    -1.0
    """
    x, y = (points - points[0]).T
    return 0.5 * float(x[:-1] @ y[1:] - y[:-1] @ x[1:])


def successors_of(loops: tuple[Ints, ...]) -> Ints:
    """The vertex that follows each vertex, (n,).

    >>> successors_of((np.array([0, 2, 1]),)).tolist()
    [2, 0, 1]
    """
    following = np.empty(sum(map(len, loops)), dtype=np.int64)
    for loop in loops:
        following[loop[:-1]], following[loop[-1]] = loop[1:], loop[0]
    return following


def _refuse_repeated(vertices: Floats, successors: Ints) -> None:
    """Raise PolygonError if two vertices are one: neighbours nearer than rounding, or any in one place."""
    sides = vertices[successors] - vertices
    smallest = TOLERANCES.side_of_outline * float(np.linalg.norm(np.ptp(vertices, axis=0)))
    short = np.flatnonzero(np.hypot(sides[:, 0], sides[:, 1]) <= smallest)
    if len(short):
        i = int(short[0])
        raise PolygonError(
            f"{described(vertices, i)} is repeated as vertex {int(successors[i])}; remove one of them"
        )
    order = np.lexsort(vertices.T)
    same = np.flatnonzero((vertices[order[1:]] == vertices[order[:-1]]).all(axis=1))
    if len(same):
        first, second = sorted((int(order[same[0]]), int(order[same[0] + 1])))
        raise PolygonError(
            f"{described(vertices, first)} is repeated as vertex {second}, so the outline touches itself; "
            "move one of them away"
        )


def _refuse_crossing(vertices: Floats, successors: Ints) -> None:
    """Raise PolygonError if the outline turns back on itself, or edges cross or touch."""
    exact = _scaled(vertices)
    folded = folded_vertex(exact, successors)
    if folded is not None:
        raise PolygonError(f"the outline turns back on itself at {described(vertices, folded)}; move it")
    found = crossing(exact, successors)
    if found is not None:
        one, other = (_edge(vertices, i, int(successors[i])) for i in found)
        raise PolygonError(f"{one} crosses or touches {other}; move one of their vertices away")


def _refuse_nesting(vertices: Floats, loops: tuple[Ints, ...]) -> None:
    """Raise PolygonError unless each hole lies in the outer loop and in no other; no edges may cross."""
    outlines = [shapely.polygons(vertices[loop]) for loop in loops]
    for number, loop in enumerate(loops[1:], 1):
        x, y = vertices[loop[0]]
        where = described(vertices, int(loop[0]))
        if not shapely.contains_xy(outlines[0], x, y):
            raise PolygonError(
                f"the hole from {where} on lies outside the outer loop, "
                f"that from {described(vertices, int(loops[0][0]))} on; leave out one of the two"
            )
        for other, around in enumerate(loops[1:], 1):
            if other != number and shapely.contains_xy(outlines[other], x, y):
                raise PolygonError(
                    f"the hole from {where} on lies inside another, "
                    f"that from {described(vertices, int(around[0]))} on; leave out one of the two"
                )


def described(vertices: Floats, vertex: int) -> str:
    """A vertex in words.

    Args:
        vertices: (n, 2).
        vertex: its number.

    >>> described(np.array([[0.5, 2.0]]), 0)
    'vertex 0 (0.5, 2)'
    """
    x, y = vertices[vertex]
    return f"vertex {vertex} ({x:.6g}, {y:.6g})"


def _edge(vertices: Floats, start: int, end: int) -> str:
    (ax, ay), (bx, by) = vertices[start], vertices[end]
    return f"edge {start}-{end} from ({ax:.6g}, {ay:.6g}) to ({bx:.6g}, {by:.6g})"


def _are(count: int) -> str:
    return {0: "are none", 1: "is one"}.get(count, f"are {count}")


def _reversed(loop: Ints) -> Ints:
    return np.concatenate([loop[:1], loop[:0:-1]])
