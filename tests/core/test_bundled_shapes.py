"""The bundled shapes are what the rest of the program may rely on: closed, oriented, in one piece, small."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

from idviewer.core import read_polygon, read_shape
from idviewer.core.io.bundled_shapes import DEFAULT_SAMPLE, Sample, all_samples, sample_names, sample_path

POSES = ("human", "human_walking", "human_sitting")


def load(name: str) -> trimesh.Trimesh:
    return trimesh.load(sample_path(name), process=False)


@pytest.fixture(params=sample_names(3))
def mesh(request: pytest.FixtureRequest) -> trimesh.Trimesh:
    return load(request.param)


@pytest.mark.one_is_quick
def test_each_is_a_closed_oriented_manifold_in_one_piece(mesh: trimesh.Trimesh) -> None:
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    assert mesh.body_count == 1
    assert triangle_fans(mesh.faces) == len(mesh.vertices)


def triangle_fans(faces: np.ndarray) -> int:
    """Number of triangle fans around vertices: as many as vertices, if no vertex is pinched or unused."""
    corners = faces.ravel()
    following, preceding = np.roll(faces, -1, axis=1).ravel(), np.roll(faces, 1, axis=1).ravel()
    start = {
        edge: corner for corner, edge in enumerate(zip(corners.tolist(), following.tolist(), strict=True))
    }
    # turning about a corner's vertex: the triangle across the edge from the preceding vertex
    turn = [start[edge] for edge in zip(corners.tolist(), preceding.tolist(), strict=True)]
    seen, fans = np.zeros(len(corners), dtype=bool), 0
    for corner in range(len(corners)):
        fans += not seen[corner]
        while not seen[corner]:
            seen[corner] = True
            corner = turn[corner]
    return fans


@pytest.mark.parametrize("name", sample_names(3))
def test_genus(name: str) -> None:
    mesh = load(name)
    assert mesh.euler_number == (-4 if name.startswith("couple") else 2)


def test_no_vertex_twice_and_none_unused(mesh: trimesh.Trimesh) -> None:
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    assert len(np.unique(mesh.faces)) == len(mesh.vertices)


def test_triangles_are_no_needles(mesh: trimesh.Trimesh) -> None:
    assert mesh.face_angles.min() > np.radians(10)
    assert np.median(mesh.face_angles.min(axis=1)) > np.radians(44)


def test_sizes(mesh: trimesh.Trimesh) -> None:
    assert 2400 <= len(mesh.vertices) <= 27500
    assert 0.1 < mesh.extents.max() < 2.0  # metres
    assert mesh.bounds[0, 2] == 0.0  # standing on the ground


@pytest.mark.parametrize("ending", ["", "_2k"])
def test_the_human_has_the_same_triangles_in_every_pose(ending: str) -> None:
    standing, *others = (load(pose + ending) for pose in POSES)
    for other in others:
        np.testing.assert_array_equal(other.faces, standing.faces)
        assert other.volume == pytest.approx(standing.volume, rel=0.02)
        assert other.area == pytest.approx(standing.area, rel=0.03)
        assert np.abs(other.vertices - standing.vertices).max() > 0.2


@pytest.mark.slow
def test_no_two_triangles_cross(mesh: trimesh.Trimesh) -> None:
    assert crossings(mesh.vertices, mesh.faces) == 0


def crossings(vertices: np.ndarray, faces: np.ndarray) -> int:
    """Number of pairs of an edge and a triangle apart from it that cross (Moeller and Trumbore 1997)."""
    corners = vertices[faces]
    centres = corners.mean(axis=1)
    radii = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    first, second = cKDTree(centres).query_pairs(2 * np.percentile(radii, 99), output_type="ndarray").T
    near = np.linalg.norm(centres[first] - centres[second], axis=1) < radii[first] + radii[second]
    near &= ~(faces[first][:, :, None] == faces[second][:, None, :]).any(axis=(1, 2))
    pairs = np.vstack([np.stack([first[near], second[near]], 1), np.stack([second[near], first[near]], 1)])
    return sum(int(hits(vertices[faces[pairs[:, 0]]], corners[pairs[:, 1]], edge).sum()) for edge in range(3))


def hits(first: np.ndarray, second: np.ndarray, edge: int) -> np.ndarray:
    """Whether the edge of each first triangle passes through the second one."""
    start, along = first[:, edge], first[:, (edge + 1) % 3] - first[:, edge]
    origin, u, v = second[:, 0], second[:, 1] - second[:, 0], second[:, 2] - second[:, 0]
    across = np.cross(along, v)
    scale = (u * across).sum(axis=1)
    scale = np.where(np.abs(scale) < 1e-30, 1e-30, scale)
    s = ((start - origin) * across).sum(axis=1) / scale
    turned = np.cross(start - origin, u)
    t, where = (along * turned).sum(axis=1) / scale, (v * turned).sum(axis=1) / scale
    return (s >= 0) & (t >= 0) & (s + t <= 1) & (where >= 0) & (where <= 1)


def test_they_are_all_there_and_small_enough_to_bundle() -> None:
    folder = sample_path(DEFAULT_SAMPLE).parent
    assert {path.stem for path in folder.glob("*.ply")} == set(sample_names(3))
    assert {path.stem for path in folder.glob("*.csv")} == set(sample_names(2))
    sizes = [sample.path.stat().st_size for sample in all_samples()]
    assert sum(sizes) < 4_000_000
    assert max(sizes) < 2_000_000


@pytest.mark.slow
def test_descriptions_tell_the_number_of_vertices() -> None:
    for sample in all_samples():
        assert isinstance(sample, Sample)
        count = len(read_shape(sample.path).vertices)
        assert sample.description.endswith((f", {count:,} vertices", f", {count} vertices, 2D"))


@pytest.mark.parametrize("name", sample_names(2))
def test_polygons_are_evenly_sampled_and_of_one_size(name: str) -> None:
    polygon = read_polygon(sample_path(name))
    assert 150 <= len(polygon.vertices) <= 400
    assert polygon.lengths.max() < 2.0 * polygon.lengths.min()
    assert 0.8 < np.ptp(polygon.vertices, axis=0).max() < 1.4
    assert len(polygon.loops) == {"ring": 2, "plate": 4}.get(name, 1)


def test_the_bays_are_one_square_cut_ever_deeper() -> None:
    areas = [read_polygon(sample_path(f"bay_{i}")).area for i in (1, 2, 3)]
    np.testing.assert_allclose(areas, [1 - 0.16 * 0.15, 1 - 0.16 * 0.5, 1 - 0.16 * 0.85], rtol=1e-4)


def test_the_default_is_the_hand_of_usual_size() -> None:
    assert sample_path() == sample_path(DEFAULT_SAMPLE) == sample_path("hand")


def test_an_unknown_name_lists_the_known_ones() -> None:
    with pytest.raises(
        ValueError,
        match=r"^no bundled shape is called 'teapot'; there are hand, hand_2k, .*couple_2k, blob, .*plate$",
    ):
        sample_path("teapot")


def test_an_installed_package_has_them_inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "assets").mkdir()
    monkeypatch.setattr("idviewer.core.io.bundled_shapes.files", lambda package: tmp_path)
    assert sample_path("cat") == tmp_path / "assets" / "cat.ply"
