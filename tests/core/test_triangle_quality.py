"""Thin triangles: the cotangent Laplacian where it is right, another where it is not, and a note of it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu
from tests.core import shapes

from idviewer.core import Mesh, MeshError, diagnose, laplacian_of, masses_of
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.spectrum import intrinsic_laplacian as intrinsic
from idviewer.core.spectrum.laplacian import cotangent_laplacian, voronoi_areas


def lowest(laplacian: sparse.csc_array, masses: np.ndarray, count: int) -> np.ndarray:
    """The first eigenvalues but zero, by ARPACK: another route than ours."""
    roots, shift = 1.0 / np.sqrt(masses), 1.0 / masses.sum()
    scaled = sparse.diags_array(roots) @ laplacian @ sparse.diags_array(roots)
    factor = splu(sparse.csc_matrix(scaled + shift * sparse.eye_array(len(masses))))
    inverse = LinearOperator(scaled.shape, matvec=factor.solve, dtype=np.float64)
    start = np.random.default_rng(0).random(len(masses))
    return np.sort(1.0 / eigsh(inverse, count + 1, v0=start, return_eigenvectors=False) - shift)[1:]


def with_needles(share: float) -> shapes.Arrays:
    """A ball of which edges are split next to one of their ends: the two triangles there are needles."""
    vertices, faces = shapes.icosphere(3)
    across = {edge: face for face in faces.tolist() for edge in zip(face, face[1:] + face[:1], strict=True)}
    points, pieces, gone = [*vertices], [], []
    for a, b, c in faces[::25].tolist():
        first, second = across[a, b], across[b, a]
        if first in gone or second in gone:
            continue
        gone += [first, second]
        new, d = len(points), sum(second) - a - b
        points.append((1.0 - share) * vertices[a] + share * vertices[b])
        pieces += [[a, new, c], [new, b, c], [b, new, d], [new, a, d]]
    return np.array(points), np.array([*(face for face in faces.tolist() if face not in gone), *pieces])


def with_caps(height: float) -> shapes.Arrays:
    """A ball with new vertices close to the middles of edges: obtuse triangles of next to no height."""
    vertices, faces = shapes.icosphere(3)
    a, b, c = faces[::10].T
    points = 0.5 * (1.0 - height) * (vertices[a] + vertices[b]) + height * vertices[c]
    new = len(vertices) + np.arange(len(a))
    kept = np.delete(faces, np.arange(0, len(faces), 10), axis=0)
    pieces = [np.column_stack(piece) for piece in ([a, b, new], [b, c, new], [c, a, new])]
    return np.concatenate([vertices, points]), np.concatenate([kept, *pieces])


def spindle(length: float, columns: int = 24) -> shapes.Arrays:
    """A ball of revolution as long as asked for, of triangles with right angles and sides about equal."""
    fine = np.linspace(0.0, np.pi, 4001)
    profile = np.column_stack([np.sin(fine), length * np.cos(fine)])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    rows = round(arc[-1] / (2.0 * np.pi / columns))
    along = np.interp(np.linspace(0.0, arc[-1], rows + 1)[1:-1], arc, fine)
    around = 2.0 * np.pi * np.arange(columns) / columns
    ring = np.column_stack([np.cos(around), np.sin(around), np.ones(columns)])
    points = [ring * [np.sin(angle), np.sin(angle), length * np.cos(angle)] for angle in along]
    k, inner = np.arange(columns), shapes.grid_faces(rows - 1, columns)
    inner = inner[np.ptp(inner // columns, axis=1) == 1]  # the last row is not joined to the first
    ends, last = (rows - 1) * columns, (rows - 2) * columns
    caps = [np.column_stack([np.full(columns, ends), k, (k + 1) % columns])]
    caps += [np.column_stack([np.full(columns, ends + 1), last + (k + 1) % columns, last + k])]
    return np.concatenate([*points, [[0, 0, length], [0, 0, -length]]]), np.concatenate([inner, *caps])


@pytest.mark.parametrize(
    "arrays",
    [with_needles(1e-6), with_caps(1e-6), with_caps(1e-2), shapes.torus(), shapes.l_shape()],
    ids=["needles", "caps", "low caps", "torus", "L"],
)
def test_single_needles_and_caps_are_left_to_the_cotangents(arrays):
    mesh = Mesh(*arrays)
    assert mesh.triangle_quality.acceptable
    assert abs(laplacian_of(mesh) - cotangent_laplacian(mesh)).max() == 0.0
    assert diagnose(mesh).findings == ()


@pytest.mark.parametrize(
    ("arrays", "rtol"), [(with_needles(1e-6), 2e-4), (with_caps(1e-6), 3e-3)], ids=["needles", "caps"]
)
def test_needles_of_aspect_one_million_leave_the_spectrum_of_the_ball(arrays, rtol):
    """Cotangents of a million cost six of sixteen digits, and the lowest eigenvalues need few."""
    mesh, plain = Mesh(*arrays), Mesh(*shapes.icosphere(3))
    expected = lowest(cotangent_laplacian(plain), voronoi_areas(plain), 8)
    np.testing.assert_allclose(lowest(laplacian_of(mesh), masses_of(mesh), 8), expected, rtol=rtol)


def test_where_wide_angles_are_the_rule_another_laplacian_is_right_and_the_user_is_told():
    """A ball's triangles, stretched; the same body in good triangles says what is right."""
    vertices, faces = shapes.icosphere(3)
    mesh, good = repair_mesh(vertices * [1.0, 1.0, 10.0], faces), repair_mesh(*spindle(10.0))
    assert (mesh.triangle_quality.acceptable, good.triangle_quality.acceptable) == (False, True)
    assert "thin obtuse triangles" in mesh.notes[0]
    assert "intrinsic Delaunay" in mesh.notes[0]
    assert [finding.kind for finding in diagnose(mesh).findings] == ["uneven_triangles"]
    expected = lowest(laplacian_of(good), masses_of(good), 20)
    found = lowest(laplacian_of(mesh), masses_of(mesh), 20)
    spoiled = lowest(cotangent_laplacian(mesh), voronoi_areas(mesh), 20)
    assert abs(found / expected - 1.0).max() < 0.1
    assert abs(spoiled / expected - 1.0).max() > 0.3


@pytest.mark.parametrize(("scale", "shift"), [(1e-9, 0.0), (1.0, 1e6), (1e9, 0.0)])
def test_the_choice_and_the_pair_scale_with_the_mesh(scale, shift):
    vertices, faces = shapes.icosphere(2)
    vertices = vertices * [1.0, 1.0, 30.0]
    plain, moved = Mesh(vertices, faces), Mesh((vertices + shift) * scale, faces)
    assert (plain.triangle_quality.acceptable, moved.triangle_quality.acceptable) == (False, False)
    rtol = 1e-9 if shift == 0.0 else 1e-5
    assert moved.triangle_quality.stiffness == pytest.approx(plain.triangle_quality.stiffness, rel=rtol)
    np.testing.assert_allclose(masses_of(moved), masses_of(plain) * scale**2, rtol=rtol)
    difference = abs(laplacian_of(moved) - laplacian_of(plain)).max()
    assert difference < rtol * abs(laplacian_of(plain)).max()


def test_the_intrinsic_pair_is_a_laplacian():
    """Symmetric, L 1 = 0, no negative weight, masses that add up to the area, made once."""
    vertices, faces = shapes.icosphere(2)
    mesh = Mesh(vertices * [1.0, 1.0, 30.0], faces)
    laplacian, masses = laplacian_of(mesh), masses_of(mesh)
    top = laplacian.diagonal().max()
    assert abs(laplacian - laplacian.T).max() < 1e-12 * top
    assert abs(laplacian.sum(axis=0)).max() < 1e-12 * top
    assert (laplacian - sparse.diags_array(laplacian.diagonal())).max() < 1e-9 * top
    assert masses.sum() == pytest.approx(mesh.area, rel=1e-6)
    assert masses is intrinsic.intrinsic_pair(mesh)[1]


def test_needles_that_leave_no_digits_are_bridged():
    mesh = repair_mesh(*with_needles(1.5e-12))
    assert mesh.triangle_quality.rounding > 1e-3
    assert "needles" in mesh.notes[0]
    found = lowest(laplacian_of(mesh), masses_of(mesh), 3)
    np.testing.assert_allclose(found, 2.0, rtol=2e-2)


def test_what_no_triangulation_is_found_for_is_refused_in_one_line(monkeypatch):
    def fail(*_: object) -> None:
        raise RuntimeError("GC_SAFETY_ASSERT FAILURE from surface.cpp:1\n - something")

    monkeypatch.setattr(intrinsic.robust_laplacian, "mesh_laplacian", fail)
    vertices, faces = shapes.icosphere(2)
    with pytest.raises(MeshError, match=r"rod: the triangles are too thin .* remesh") as caught:
        laplacian_of(Mesh(vertices * [1.0, 1.0, 30.0], faces, "rod"))
    assert "\n" not in str(caught.value)
