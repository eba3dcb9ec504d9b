"""The bridges that join a polygon's loops, and resistances along both."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from idviewer.core.arrays import Floats, Ints


def bridges_between(vertices: Floats, loops: tuple[Ints, ...]) -> Ints:
    """The shortest bridges that join all loops: a minimum spanning tree over the nearest vertex pairs (Prim).

    Returns:
        (h, 2) vertices of each bridge, one bridge fewer than loops; the first one belongs to a loop that the
        bridges before reach from the outer loop.

    >>> square = np.array([[0.0, 0], [3, 0], [3, 3], [0, 3]])
    >>> hole = np.array([[0.5, 1], [1, 1], [1, 2]])
    >>> bridges_between(np.concatenate([square, hole]), (np.arange(4), np.arange(4, 7))).tolist()
    [[0, 4]]
    """
    outside = dict(enumerate(loops[1:], 1))
    # Of each loop outside: length, near and far end of the shortest bridge to the loops reached so far.
    nearest = dict.fromkeys(outside, (np.inf, -1, -1))
    reached, bridges = loops[0], []
    while outside:
        tree = cKDTree(vertices[reached])
        for number, loop in outside.items():
            lengths, places = tree.query(vertices[loop])
            best = int(np.argmin(lengths))
            bridge = (float(lengths[best]), int(reached[places[best]]), int(loop[best]))
            nearest[number] = min(nearest[number], bridge)
        chosen = min(outside, key=lambda number: nearest[number])
        bridges.append(nearest[chosen][1:])
        reached = outside.pop(chosen)
    return np.array(bridges, dtype=np.int64).reshape(-1, 2)


def resistances_between(loops: tuple[Ints, ...], lengths: Floats, bridges: Floats) -> Floats:
    """Effective resistances between all vertices. They add up along bridges.

    Args:
        loops: vertex numbers.
        lengths: (n,) of the edges, each from its vertex on.
        bridges: (h, 3) ends and length; see `bridges_between` for their order.

    Returns:
        (n, n) symmetric.
    """
    result = np.zeros((len(lengths), len(lengths)))
    for loop in loops:
        places = np.concatenate([[0.0], np.cumsum(lengths[loop])])
        along = np.abs(places[:-1, None] - places[:-1])
        result[np.ix_(loop, loop)] = along * (1.0 - along / places[-1])  # two ways round, side by side
    reached = loops[0]
    number = np.empty(len(lengths), dtype=np.int64)
    for at, loop in enumerate(loops):
        number[loop] = at
    for near, far, length in bridges.tolist():
        beyond = loops[number[int(far)]]
        between = result[reached, int(near), None] + length + result[int(far), beyond]
        result[np.ix_(reached, beyond)] = between
        result[np.ix_(beyond, reached)] = between.T
        reached = np.concatenate([reached, beyond])
    return result
