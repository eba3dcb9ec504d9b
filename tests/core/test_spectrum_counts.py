"""No mode is missed or doubled: Sylvester's inertia, spaces of equal values, dense pairs; bad input."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import scipy.linalg
from scipy import sparse
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree
from tests.core import shapes

import idviewer.core.spectrum.eigen_solver as spectrum_module
from idviewer.core import Mesh, MeshError, Spectrum, eigenpairs, laplacian_of, masses_of
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.spectrum.eigen_solver import EigenSolverSettings
from idviewer.core.spectrum.krylov_eigenpairs import KRYLOV


def cube(level: int) -> shapes.Arrays:
    """A cube with all its symmetries: each side has a middle, and is cut from there."""
    vertices, quads = shapes.cube_quads()
    vertices = np.concatenate([vertices, vertices[quads].mean(axis=1)]) - 0.5
    middle = np.arange(8, 14)
    faces = [np.column_stack([quads[:, k], quads[:, (k + 1) % 4], middle]) for k in range(4)]
    arrays = vertices, np.concatenate(faces)
    for _ in range(level):
        arrays = shapes.subdivided(*arrays)
    return arrays


BODIES = {
    "ball": lambda: shapes.icosphere(3),
    "cube": lambda: cube(3),
    "torus": lambda: shapes.torus(40, 24),
    "spindle": lambda: (shapes.icosphere(3)[0] * [1.0, 1.0, 10.0], shapes.icosphere(3)[1]),
}


@cache
def pairs_of(name: str) -> tuple[Mesh, Spectrum]:
    """By Krylov spaces, whatever the size."""
    mesh = Mesh(*BODIES[name]())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(spectrum_module, "EIGEN_SOLVER", EigenSolverSettings(dense_vertices=0))
        return mesh, eigenpairs(mesh, cutoff=lambda lambda_2: 14.0 * lambda_2)


def inertia(mesh: Mesh, bound: float) -> int:
    """How many eigenvalues lie below a bound: negative pivots of L - bound M (Sylvester)."""
    shifted = sparse.csc_matrix(laplacian_of(mesh) - bound * sparse.diags_array(masses_of(mesh)))
    options = {"SymmetricMode": True}
    factor = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    assert np.array_equal(factor.perm_r, factor.perm_c), "else the pivots' signs are not the inertia"
    return int(np.count_nonzero(factor.U.diagonal() < 0.0))


def clusters(values: np.ndarray) -> list[slice]:
    """Groups of equal eigenvalues."""
    ends = [0, *(np.flatnonzero(np.diff(values) > 1e-7 * values[1:]) + 1), len(values)]
    return [slice(a, b) for a, b in pairwise(ends)]


@pytest.mark.parametrize("name", BODIES)
def test_as_many_values_lie_below_any_bound_as_the_inertia_says(name):
    mesh, spectrum = pairs_of(name)
    middles = 0.5 * (spectrum.values[1:] + spectrum.values[:-1])
    clear = middles[np.diff(spectrum.values) > 1e-3 * middles]
    for bound in [*clear[:: max(1, len(clear) // 4)], spectrum.bound]:
        # The inertia counts the constant mode too.
        assert inertia(mesh, bound) == np.count_nonzero(spectrum.values < bound) + 1


@pytest.mark.parametrize("name", BODIES)
def test_residuals_are_small_and_vectors_orthonormal(name):
    mesh, spectrum = pairs_of(name)
    masses = spectrum.masses[:, None]
    np.testing.assert_allclose(
        spectrum.vectors.T @ (masses * spectrum.vectors), np.eye(len(spectrum.values)), atol=1e-11
    )
    laplacian = laplacian_of(mesh)
    rest = laplacian @ spectrum.vectors - masses * spectrum.vectors * spectrum.values
    # In the norm of functionals on functions of finite energy, where residuals of eigenfunctions belong.
    energy = sparse.csc_array(laplacian + sparse.diags_array(spectrum.masses * spectrum.values[0]))
    norms = np.sqrt(np.einsum("nk,nk->k", rest, splu(energy).solve(rest)) / spectrum.values)
    assert (norms < 3 * KRYLOV.residual).all()
    assert spectrum.residual < KRYLOV.residual
    assert spectrum.masses.sum() == pytest.approx(mesh.area, rel=1e-9)


@pytest.mark.parametrize(("name", "dimensions"), [("ball", {1, 3, 4, 5}), ("cube", {1, 2, 3})])
def test_equal_eigenvalues_are_whole_spaces(name, dimensions):
    """A symmetry maps each space onto itself, and its dimension is that of an irreducible representation."""
    mesh, spectrum = pairs_of(name)
    distance, moved = cKDTree(mesh.vertices).query(mesh.vertices[:, [2, 0, 1]])
    assert distance.max() < 1e-12
    groups = clusters(spectrum.values)
    assert {group.stop - group.start for group in groups} <= dimensions
    assert max(group.stop - group.start for group in groups) > 2
    for group in groups:
        space = spectrum.vectors[:, group] * np.sqrt(spectrum.masses)[:, None]
        cosines = np.linalg.svd(space.T @ space[moved], compute_uv=False)
        np.testing.assert_allclose(cosines, 1.0, atol=1e-8)


def test_all_modes_of_a_degree_are_there():
    """l(l + 1) comes 2 l + 1 times on a ball."""
    values = pairs_of("ball")[1].values
    degrees = np.round((np.sqrt(1.0 + 4.0 * values) - 1.0) / 2.0).astype(int)
    np.testing.assert_array_equal(np.bincount(degrees), [0, 3, 5, 7, 9])


@pytest.mark.parametrize("dense", [0, 10**6], ids=["Krylov", "dense"])
def test_pairs_are_those_of_a_dense_solver(monkeypatch, dense):
    """On 500 vertices: eigenvalues to 1e-10, spaces of equal ones by their principal angles."""
    mesh = Mesh(*shapes.torus(25, 20))
    monkeypatch.setattr(spectrum_module, "EIGEN_SOLVER", EigenSolverSettings(dense_vertices=dense))
    found = eigenpairs(mesh, cutoff=lambda lambda_2: 20.0 * lambda_2)
    masses = np.diag(masses_of(mesh))
    values, vectors = scipy.linalg.eigh(laplacian_of(mesh).toarray(), masses)
    count = len(found.values)
    assert count == np.count_nonzero(values < found.bound) - 1
    np.testing.assert_allclose(found.values, values[1 : count + 1], rtol=1e-10)
    for group in clusters(found.values):
        expected = vectors[:, 1 + group.start : 1 + group.stop]
        cosines = np.linalg.svd(expected.T @ masses @ found.vectors[:, group], compute_uv=False)
        np.testing.assert_allclose(cosines, 1.0, atol=1e-9)


# Bad input


def test_several_components_are_named_and_one_is_offered():
    with pytest.raises(
        MeshError, match=r"2 components with 80, 12 faces; choose one .* component=1"
    ) as caught:
        repair_mesh(*shapes.joined(shapes.cube(), shapes.moved(shapes.icosphere(1), 5, 0, 0)))
    assert [one.faces for one in caught.value.components] == [80, 12]
    assert len(eigenpairs(repair_mesh(*shapes.two_components(), component=1)).values) == 5


def test_faces_without_area_are_mended_before_they_are_divided_by():
    """A vertex in the middle of an edge belongs to one side alone: the other has a triangle without area."""
    vertices, faces = shapes.icosphere(2)
    a, b, c = faces[0]
    flat = np.array([[a, len(vertices), c], [len(vertices), b, c], [a, b, len(vertices)]])
    points = np.concatenate([vertices, [0.5 * (vertices[a] + vertices[b])]])
    mesh = repair_mesh(points, np.concatenate([faces[1:], flat]))
    assert mesh.notes[0].startswith("1 face without area was removed")
    values = eigenpairs(mesh, cutoff=lambda lambda_2: 2.0 * lambda_2).values
    np.testing.assert_allclose(values, 2.0, rtol=2e-2)


def test_two_vertices_at_one_point():
    """Of a seam they are merged; where the surface only touches itself they stay; what no face uses goes."""
    vertices, faces = shapes.icosphere(2)
    plain = eigenpairs(Mesh(vertices, faces), cutoff=lambda lambda_2: 4.0 * lambda_2).values
    seam = shapes.soup((vertices, faces))
    unused = np.concatenate([vertices, vertices[:3]]), faces
    for arrays in (seam, unused):
        mesh = repair_mesh(*arrays)
        assert len(mesh.vertices) == len(vertices)
        found = eigenpairs(mesh, cutoff=lambda lambda_2: 4.0 * lambda_2).values
        np.testing.assert_allclose(found, plain, rtol=1e-10)


def test_a_pinch_joins_two_bodies():
    """Two cubes that share a vertex are one piece: there is one constant mode, and no value is zero."""
    values = eigenpairs(Mesh(*shapes.pinched_cubes())).values
    assert len(values) == 14
    assert values[0] > 1e-3 * values[1]
