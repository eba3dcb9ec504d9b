"""Positions for the unknowns of a sparse matrix that come without: hops from landmarks of its graph."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from idviewer.core.arrays import Floats, Ints

LANDMARKS_PER_COMPONENT = 3
"""Of each component; their hop distances are the coordinates."""


def graph_positions(matrix: sparse.csc_array) -> Floats:
    """Places (n, LANDMARKS_PER_COMPONENT) in which neighbours lie next to each other, for `dissect`.

    The coordinates are numbers of edges to landmarks, each as far as can be from those before; components
    lie side by side.

    Args:
        matrix: (n, n) symmetric; its entries off the diagonal are the edges.

    >>> path = sparse.diags_array([np.ones(3), np.ones(3)], offsets=[-1, 1], format="csc")
    >>> graph_positions(path)[:, 0].tolist()
    [3.0, 2.0, 1.0, 0.0]
    """
    graph = sparse.csr_array((np.ones(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
    count, component = csgraph.connected_components(graph, directed=False)
    _, first = np.unique(component, return_index=True)
    farthest = _hops(graph, first)
    total = np.zeros(graph.shape[0])
    positions = np.empty((graph.shape[0], LANDMARKS_PER_COMPONENT))
    for axis in range(LANDMARKS_PER_COMPONENT):
        positions[:, axis] = _hops(graph, _last_of_each(farthest, component))
        total = positions[:, axis] if axis == 0 else np.minimum(total, positions[:, axis])
        farthest = total
    widths = np.zeros(count)
    np.maximum.at(widths, component, positions[:, 0])
    positions[:, 0] += (np.cumsum(widths + 1.0) - widths - 1.0)[component]
    return positions


def _hops(graph: sparse.csr_array, sources: Ints) -> Floats:
    """Number of edges (n,) to the nearest of the sources, one of which is in each component."""
    return csgraph.dijkstra(graph, directed=False, indices=sources, unweighted=True, min_only=True)


def _last_of_each(values: Floats, component: Ints) -> Ints:
    """The vertex with the largest value, of each component."""
    order = np.lexsort((values, component))
    return order[np.flatnonzero(np.diff(np.append(component[order], -1)))]
