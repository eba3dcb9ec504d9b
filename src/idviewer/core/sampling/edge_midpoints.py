"""The midpoints of a slice mesh's edges: the embedding interpolated there, and how wrong it may be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.slices.triangulation import SliceMesh

BAND_ERROR_SHARE = 0.15
"""Error at the midpoint of an edge of the band, about, as a share of its ends' distance."""


@dataclass(frozen=True, eq=False)
class EdgeMidpoints:
    """Midpoints of edges.

    Attributes:
        ends: (e, 2) indices into the mesh's points.
        rows: (e, k) the basis, interpolated.
        expected: (e,) error expected there, as a weighted norm; 0 where the rows are exact.
    """

    ends: Ints
    rows: Floats
    expected: Floats

    def at(self, chosen: Ints) -> EdgeMidpoints:
        """Those of the edges chosen, by their numbers."""
        return EdgeMidpoints(self.ends[chosen], self.rows[chosen], self.expected[chosen])


def interpolated(
    mesh: SliceMesh, ends: Ints, rows: Floats, significant_columns: Floats, linear_outline: bool = True
) -> EdgeMidpoints:
    """Interpolate the basis at the midpoints of edges, from its values at the mesh's points.

    Between two nodes it is a quadratic or cubic polynomial along the lattice's line through them, as far as
    that is inside. In the band it is linear.

    Args:
        mesh: what the edges belong to.
        ends: (e, 2) indices into its points.
        rows: (p, k) the basis there.
        significant_columns: (p, c) values there that tell what an error in the rows counts.
        linear_outline: whether rows are linear along the outline, so that interpolating there costs nothing.
    """
    lattice = ends[:, 0] >= len(mesh.section.in_plane)
    points, bend = _bend(mesh, ends, lattice)
    middle, steep = 0.0 - bend, bend.copy()
    middle[:, :2] += 0.5
    steep[~lattice, :2] = BAND_ERROR_SHARE, -BAND_ERROR_SHARE
    expected = np.linalg.norm(combined(points, steep, significant_columns), axis=1)
    if linear_outline:
        expected[_on_outline(mesh, ends)] = 0.0
    expected[np.isnan(expected)] = 0.0  # beside a point without a value there is nothing to be improved
    return EdgeMidpoints(ends, combined(points, middle, rows), expected)


def combined(points: Ints, coefficients: Floats, rows: Floats) -> Floats:
    """Sums (e, k) of a few rows each, with coefficients.

    Args:
        points: (e, c) indices of rows.
        coefficients: (e, c) of these rows.
        rows: (p, k).

    >>> combined(np.array([[0, 1]]), np.array([[0.5, 0.5]]), np.array([[1.0], [3.0]])).tolist()
    [[2.0]]
    """
    starts = np.arange(0, points.size + 1, points.shape[1])
    matrix = csr_array((coefficients.ravel(), points.ravel(), starts), shape=(len(points), len(rows)))
    return matrix @ rows


def _bend(mesh: SliceMesh, ends: Ints, lattice: Bools) -> tuple[Ints, Floats]:
    """Distance of the mean of two nodes from the curve through them: an eighth of the second difference.

    Returns:
        (e, 4) an edge's two ends, and the nodes beyond them; (e, 4) their coefficients, 0 off the lattice.
    """
    first = len(mesh.section.in_plane)
    points = np.concatenate([ends, ends], axis=1)
    coefficients = np.zeros(points.shape)
    tails, heads = (mesh.nodes[ends[lattice, side] - first] for side in (0, 1))
    beyond = np.stack([_find(mesh.nodes, 2 * tails - heads), _find(mesh.nodes, 2 * heads - tails)], axis=1)
    known = beyond >= 0
    share = 1.0 / np.maximum(8.0 * known.sum(axis=1, keepdims=True), 1.0)
    points[lattice, 2:] = np.where(known, beyond + first, 0)
    coefficients[lattice, 2:] = share * known
    # Second differences at the ends: beyond - 2 end + other end.
    coefficients[lattice, :2] = share * (known[:, ::-1] - 2.0 * known)
    return points, coefficients


def _find(nodes: Ints, wanted: Ints) -> Ints:
    """Places of lattice coordinates among ascending ones (q, 2), or -1."""
    if len(nodes) == 0:
        return np.full(len(wanted), -1)
    low, stride = nodes.min(axis=0) - 1, int(np.ptp(nodes[:, 1])) + 3
    keys, sought = ((part - low) @ np.array([stride, 1]) for part in (nodes, wanted))
    place = np.minimum(np.searchsorted(keys, sought), len(keys) - 1)
    return np.where(keys[place] == sought, place, -1)


def _on_outline(mesh: SliceMesh, ends: Ints) -> Bools:
    """Tell which edges (smaller end first) are sides of the outline."""
    starts, stops = mesh.section.segments
    follower = np.full(len(mesh.section.in_plane), -1)
    follower[starts] = stops
    result = np.zeros(len(ends), dtype=np.bool_)
    both = np.flatnonzero(ends[:, 1] < len(follower))
    one, other = ends[both].T
    result[both] = (follower[one] == other) | (follower[other] == one)
    return result


def midpoints_of(mesh: SliceMesh, ends: Ints) -> Floats:
    """Midpoints of edges in the plane's basis, (e, 2).

    Args:
        mesh: n points.
        ends: (e, 2) indices into them.

    >>> from idviewer.core.shapes.polygon import Polygon
    >>> from idviewer.core.slices.polygon_sections import polygon_section
    >>> from idviewer.core.slices.triangulation import slice_mesh
    >>> mesh = slice_mesh(polygon_section(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])), 8.0)
    >>> mesh.section.lift(midpoints_of(mesh, np.array([[0, 1]]))).tolist()
    [[2.0, 0.0, 0.0]]
    """
    return 0.5 * (mesh.in_plane[ends[:, 0]] + mesh.in_plane[ends[:, 1]])


def lengths(mesh: SliceMesh, ends: Ints) -> Floats:
    """Lengths of edges in lattice constants, (e,), the longest cut to 2.

    Args:
        mesh: n points.
        ends: (e, 2) indices into them.

    >>> from idviewer.core.shapes.polygon import Polygon
    >>> from idviewer.core.slices.polygon_sections import polygon_section
    >>> from idviewer.core.slices.triangulation import slice_mesh
    >>> mesh = slice_mesh(polygon_section(Polygon([[0, 0], [3, 0], [3, 4], [0, 4]])), 10.0)
    >>> lengths(mesh, np.array([[0, 2], [1, 2]])).tolist()
    [0.5, 0.4]
    """
    spans = mesh.in_plane[ends[:, 1]] - mesh.in_plane[ends[:, 0]]
    return np.minimum(np.linalg.norm(spans, axis=1) / mesh.spacing, 2.0)


def around(expected: Floats, sides: Ints, weight: float) -> Floats:
    """Errors expected at edges (e,), a share of the largest among each edge's neighbours added.

    Args:
        expected: (e,) errors.
        sides: (t, 3) the edges of each triangle.
        weight: of the neighbours.

    >>> around(np.array([1.0, 4.0, 0.0]), np.array([[0, 1, 2]]), 0.5).tolist()
    [3.0, 6.0, 0.0]
    """
    largest = expected[sides].max(axis=1)
    nearby = np.zeros(len(expected))
    for side in sides.T:
        np.maximum.at(nearby, side, largest)
    return np.where(expected > 0.0, expected + weight * nearby, 0.0)


def worst_and_some(expected: Floats, count: int, others: int) -> Ints:
    """Numbers of the largest errors expected, in descending order, and of some of the others.

    Args:
        expected: (e,) errors.
        count: how many to choose.
        others: of these, how many among the smaller ones.

    >>> worst_and_some(np.array([1.0, 5.0, 2.0, 0.0, 4.0]), 3, 1).tolist()
    [1, 4, 2]
    """
    inexact = int((expected > 0.0).sum())
    order = np.argsort(-expected, kind="stable")[:inexact]
    worst, rest = order[: count - others], order[count - others :]
    return np.concatenate([worst, rest[:: max(1, -(-len(rest) // others))]])
