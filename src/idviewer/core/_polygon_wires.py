"""Distances along a polygon's boundary, whose loops are joined by wires."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

from idviewer.core.shape import Floats, Ints

Apart = Callable[[Floats, float], Floats]


def wires_between(vertices: Floats, loops: tuple[Ints, ...]) -> Ints:
    """The shortest wires that join all loops: a minimum spanning tree over the nearest vertex pairs (Prim).

    Returns:
        (h, 2) vertices of each wire, one wire fewer than loops; the first one belongs to a loop that the
        wires before reach from the outer loop.
    """
    outside = dict(enumerate(loops[1:], 1))
    # Of each loop outside: length, near and far end of the shortest wire to the loops reached so far.
    nearest = dict.fromkeys(outside, (np.inf, -1, -1))
    reached, wires = loops[0], []
    while outside:
        tree = cKDTree(vertices[reached])
        for number, loop in outside.items():
            lengths, places = tree.query(vertices[loop])
            best = int(np.argmin(lengths))
            wire = (float(lengths[best]), int(reached[places[best]]), int(loop[best]))
            nearest[number] = min(nearest[number], wire)
        chosen = min(outside, key=lambda number: nearest[number])
        wires.append(nearest[chosen][1:])
        reached = outside.pop(chosen)
    return np.array(wires, dtype=np.int64).reshape(-1, 2)


def all_pairs(loops: tuple[Ints, ...], lengths: Floats, wires: Ints, apart: Apart) -> Floats:
    """A distance between all vertices that adds up along wires, every one of which is a bridge.

    Args:
        loops: vertex numbers.
        lengths: (n,) of the edges, each from its vertex on.
        wires: (h, 3) ends and length; see `wires_between` for their order.
        apart: from lengths along a loop, and the loop's whole length, to distances on the loop.

    Returns:
        (n, n) symmetric.
    """
    result = np.zeros((len(lengths), len(lengths)))
    for loop in loops:
        places = np.concatenate([[0.0], np.cumsum(lengths[loop])])
        along = np.abs(places[:-1, None] - places[:-1])
        result[np.ix_(loop, loop)] = apart(along, float(places[-1]))
    reached = loops[0]
    number = np.empty(len(lengths), dtype=np.int64)
    for at, loop in enumerate(loops):
        number[loop] = at
    for near, far, length in wires.tolist():
        beyond = loops[number[int(far)]]
        between = result[reached, int(near), None] + length + result[int(far), beyond]
        result[np.ix_(reached, beyond)] = between
        result[np.ix_(beyond, reached)] = between.T
        reached = np.concatenate([reached, beyond])
    return result
