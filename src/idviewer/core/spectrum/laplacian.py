"""The discrete Laplace-Beltrami operator of a boundary: stiffness and masses of meshes and of polygons.

`laplacian_of` and `masses_of` belong together: both are those of the mesh's triangles, or, where thin ones
would spoil them (`Mesh.triangle_quality`), both are those of an intrinsic Delaunay triangulation.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import MeshLike, PolygonLike, Shape, ShapeLike, as_mesh, as_polygon, as_shape
from idviewer.core.spectrum.intrinsic_laplacian import intrinsic_pair


def laplacian_of(shape: ShapeLike) -> sparse.csc_array:
    """The stiffness matrix L (n, n) of a shape's boundary.

    `cotangent_laplacian`, or that of `intrinsic_pair` where thin triangles spoil it, and what the bridges
    between shells conduct (see `Mesh`); or `polygon_laplacian`.

    >>> from idviewer.core import Polygon
    >>> laplacian_of(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])).diagonal().tolist()
    [2.0, 2.0, 2.0, 2.0]
    """
    shape = as_shape(shape)
    if isinstance(shape, Mesh):
        surface = (
            cotangent_laplacian(shape) if shape.triangle_quality.acceptable else intrinsic_pair(shape)[0]
        )
        if len(shape.shells) == 1:
            return surface
        return sparse.csc_array(surface + shape.shell_bridges.laplacian())
    return polygon_laplacian(_polygon(shape))


def masses_of(shape: ShapeLike) -> Floats:
    """The diagonal (n,) of a shape's mass matrix M, consistent with `laplacian_of`.

    `voronoi_areas`, or those of `intrinsic_pair` where thin triangles spoil the Laplacian, or
    `voronoi_lengths`.

    >>> from idviewer.core import Polygon
    >>> masses_of(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])).tolist()
    [1.0, 1.0, 1.0, 1.0]
    """
    shape = as_shape(shape)
    if isinstance(shape, Mesh):
        return voronoi_areas(shape) if shape.triangle_quality.acceptable else intrinsic_pair(shape)[1]
    return voronoi_lengths(_polygon(shape))


def _polygon(shape: Shape) -> Polygon:
    if not isinstance(shape, Polygon):
        raise TypeError(f"a Mesh or a Polygon has a Laplacian; this is a {type(shape).__name__}")
    return shape


def cotangents(mesh: Mesh) -> Floats:
    """Cotangents of the corner angles.

    Args:
        mesh: n vertices, m faces.

    Returns:
        (m, 3) cotangent of the angle at each corner of each face.
    """
    corners = mesh.vertices[mesh.faces]
    double_area = 2.0 * mesh.face_areas
    result = np.empty((len(corners), 3))
    for i in range(3):
        to_next = corners[:, (i + 1) % 3] - corners[:, i]
        to_last = corners[:, (i + 2) % 3] - corners[:, i]
        result[:, i] = np.einsum("ij,ij->i", to_next, to_last) / double_area
    return result


def cotangent_laplacian(mesh: MeshLike) -> sparse.csc_array:
    """The cotangent Laplacian L, positive semi-definite, with L 1 = 0.

    u^T L u is the Dirichlet energy of the piecewise linear function u, so L does not depend on the
    mesh's scale. Source: Pinkall and Polthier 1993; Rustamov et al. 2009, appendix.

    Args:
        mesh: n vertices.

    Returns:
        (n, n) sparse and symmetric; L_ij = -(cot a + cot b) / 2 for an edge with opposite angles a, b.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> bool(abs(cotangent_laplacian(tetrahedron).sum(axis=0)).max() < 1e-15)
    True
    """
    mesh = as_mesh(mesh)
    n = len(mesh.vertices)
    half = 0.5 * cotangents(mesh).ravel(order="F")
    i = np.concatenate([mesh.faces[:, 1], mesh.faces[:, 2], mesh.faces[:, 0]])
    j = np.concatenate([mesh.faces[:, 2], mesh.faces[:, 0], mesh.faces[:, 1]])
    rows, columns = np.concatenate([i, j]), np.concatenate([j, i])
    weights = sparse.csc_array((np.concatenate([half, half]), (rows, columns)), shape=(n, n))
    return sparse.csc_array(sparse.diags_array(weights.sum(axis=0)) - weights)


def voronoi_areas(mesh: MeshLike) -> Floats:
    """Mixed Voronoi area of each vertex; they are positive and add up to the surface's area.

    A corner of a non-obtuse triangle gets its Voronoi region; in an obtuse one the obtuse corner gets
    half of the triangle and each of the others a quarter. Source: Meyer et al. 2003, section 3.3.

    Args:
        mesh: n vertices.

    Returns:
        (n,) areas, in the mesh's unit squared.

    >>> from idviewer.core import Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> bool(abs(voronoi_areas(tetrahedron).sum() - tetrahedron.area) < 1e-15)
    True
    """
    mesh = as_mesh(mesh)
    cot = cotangents(mesh)
    corners = mesh.vertices[mesh.faces]
    squared = ((corners[:, [1, 2, 0]] - corners[:, [2, 0, 1]]) ** 2).sum(axis=2)
    opposite = squared * cot
    voronoi = (opposite.sum(axis=1)[:, None] - opposite) / 8.0
    obtuse = np.less(cot, 0.0)
    quarters = mesh.face_areas[:, None] * np.where(obtuse, 0.5, 0.25)
    share = np.where(np.any(obtuse, axis=1, keepdims=True), quarters, voronoi)
    areas = np.bincount(mesh.faces.ravel(), weights=share.ravel(), minlength=len(mesh.vertices))
    return np.asarray(areas, dtype=np.float64)


def polygon_laplacian(polygon: PolygonLike) -> sparse.csc_array:
    """The Laplacian L of a polygon's boundary, positive semi-definite, with L 1 = 0.

    Each edge and each bridge between loops (see `Polygon`) conducts one over its length: the stencil is
    [-1/d-, 1/d- + 1/d+, -1/d+]. Source: Rustamov et al. 2009, appendix; bridges are ours.

    Args:
        polygon: n vertices.

    Returns:
        (n, n) sparse and symmetric, in one over the polygon's unit.

    >>> from idviewer.core import Polygon
    >>> triangle = Polygon([[0, 0], [4, 0], [0, 2]])
    >>> polygon_laplacian(triangle).toarray()[0].tolist()
    [0.75, -0.25, -0.5]
    """
    polygon = as_polygon(polygon)
    n = len(polygon.vertices)
    i, j = np.concatenate([polygon.edges, polygon.bridges]).T
    conductances = 1.0 / np.concatenate([polygon.lengths, polygon.bridge_lengths])
    rows, columns = np.concatenate([i, j]), np.concatenate([j, i])
    weights = sparse.csc_array((np.tile(conductances, 2), (rows, columns)), shape=(n, n))
    return sparse.csc_array(sparse.diags_array(weights.sum(axis=0)) - weights)


def voronoi_lengths(polygon: PolygonLike) -> Floats:
    """Half the length of the two edges at each vertex, (d- + d+) / 2; they add up to the perimeter.

    Source: Rustamov et al. 2009, appendix.

    Args:
        polygon: n vertices.

    Returns:
        (n,) lengths, in the polygon's unit.

    >>> from idviewer.core import Polygon
    >>> voronoi_lengths(Polygon([[0, 0], [4, 0], [4, 2], [0, 2]])).tolist()
    [3.0, 3.0, 3.0, 3.0]
    """
    polygon = as_polygon(polygon)
    before = np.empty_like(polygon.lengths)
    before[polygon.edges[:, 1]] = polygon.lengths
    return 0.5 * (before + polygon.lengths)
