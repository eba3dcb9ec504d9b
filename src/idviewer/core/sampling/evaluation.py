"""Interior distances on a slice, in one call."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import as_points, in_space
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.sampling import settings as defaults
from idviewer.core.sampling.basis_samples import BasisSamples
from idviewer.core.sampling.sampled_slice import POLYGON_PLANE, SampledSlice, SliceValues
from idviewer.core.shapes.plane import Plane
from idviewer.core.steps import finish


def slice_values(
    solver: InteriorDistance,
    plane: Plane | None = None,
    source: ArrayLike | None = None,
    rtol: float | None = None,
    nodes: int | None = None,
) -> SliceValues:
    """Sample a slice: interior distances from a source at the points of a triangulated section.

    The triangles end exactly at the outline. Inside, their points are those of a square lattice, and some
    midpoints of edges where distances change fast.

    Args:
        solver: of a mesh or a polygon.
        plane: where to cut a mesh, in its unit; a polygon is one slice, in z = 0, and needs none.
        source: (dimension,) where distances are measured from; the barycentroid by default.
        rtol: largest error of a value, as a share of the largest distance on the boundary; 0 is exact; the
            solver's own by default.
        nodes: about how many points of the lattice lie inside; by default as many as the viewer shows, which
            takes seconds.

    Returns:
        p points, t triangles between them, the outline, and p distances.

    Raises:
        SourceError: the source lies outside the shape, or has no weights.
        ValueError: a mesh without a plane, rtol outside [0, 1), or nodes below 1.

    >>> from idviewer.core import Euclidean, Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> solver = InteriorDistance(tetrahedron, Euclidean())
    >>> found = slice_values(solver, Plane((0, 0, 0.5), (0, 0, 1)), source=[0.1, 0.1, 0.5], nodes=100)
    >>> found.points.shape[1], found.triangles.shape[1], len(found.outline), len(found.outline[0])
    (3, 3, 1, 3)
    >>> float(found.values.max().round(6))  # to the corners (0.5, 0, 0.5) and (0, 0.5, 0.5)
    0.412311
    """
    samples, plane, sampled = _sampled(solver, plane, rtol, nodes)
    if source is None:
        source = solver.barycentroid().point
    x, y, z = in_space(as_points(np.atleast_2d(source), solver.shape.dimension))[0].tolist()
    origin = finish(samples.row_steps((x, y, z))) * solver.boundary.scale
    return sampled.values(plane, solver.boundary.scale, origin)


def sample_slice(
    solver: InteriorDistance, plane: Plane | None = None, rtol: float | None = None, nodes: int | None = None
) -> SampledSlice:
    """Sample the embedding at the points of a triangulated section; `rows * solver.boundary.scale` is p*.

    Args:
        solver, plane, rtol, nodes: as for `slice_values`.

    Returns:
        p points, t triangles, the outline, and (p, k) rows.

    Raises:
        ValueError: a mesh without a plane, rtol outside [0, 1), or nodes below 1.

    >>> from idviewer.core import GPS, Polygon
    >>> solver = InteriorDistance(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]), GPS())
    >>> found = sample_slice(solver, nodes=50)
    >>> found.rows.shape == (len(found.points), len(solver.spectrum.values))
    True
    """
    return _sampled(solver, plane, rtol, nodes)[2]


def _sampled(
    solver: InteriorDistance, plane: Plane | None, rtol: float | None, nodes: int | None
) -> tuple[BasisSamples, Plane, SampledSlice]:
    rtol = solver.interpolation.rtol if rtol is None else rtol
    if not 0.0 <= rtol < 1.0:
        raise ValueError(f"rtol must lie in [0, 1), not {rtol}")
    if nodes is not None and nodes < 1:
        raise ValueError(f"a slice has at least one node, not {nodes}")
    if solver.shape.dimension == 2:
        plane = POLYGON_PLANE
    elif plane is None:
        raise ValueError(
            "a mesh is sliced by a plane; give one, for example Plane.along('y', 0.5, mesh.bounds)"
        )
    settings = replace(defaults.SAMPLING, final_rtol=rtol)
    if nodes is not None:
        settings = replace(settings, coarsest_nodes=nodes, lattices=1)
    samples = BasisSamples(solver, nodes, settings)
    on_plane = samples.on(plane)
    return samples, plane, finish(on_plane.level_steps(on_plane.levels - 1))
