"""Meshes written and read again, by ourselves and by another library."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from tests.core import shapes

from idviewer.core import Mesh, MeshError, read_mesh, write_mesh
from idviewer.core.io import writable_suffixes

EXACT = [suffix for suffix in writable_suffixes() if suffix != ".stl"]


@pytest.fixture
def bumpy(rng: np.random.Generator) -> Mesh:
    """A sphere whose coordinates have all their digits, some of them tiny."""
    vertices, faces = shapes.icosphere(1)
    return Mesh(vertices * rng.uniform(0.9, 1.1, (len(vertices), 1)) * [1, 1e-2, 1e3], faces)


@pytest.mark.parametrize("suffix", EXACT)
def test_every_digit_and_the_order_come_back(bumpy: Mesh, suffix: str, tmp_path: Path) -> None:
    assert write_mesh(bumpy, tmp_path / f"bumpy{suffix}") == ()
    again = read_mesh(tmp_path / f"bumpy{suffix}")
    np.testing.assert_array_equal(again.vertices, bumpy.vertices)
    np.testing.assert_array_equal(again.faces, bumpy.faces)


@pytest.mark.parametrize("suffix", writable_suffixes())
def test_another_library_reads_the_same_body(suffix: str, tmp_path: Path) -> None:
    mesh = Mesh(*shapes.torus())
    write_mesh(mesh, tmp_path / f"torus{suffix.upper()}")
    theirs = trimesh.load_mesh(tmp_path / f"torus{suffix.upper()}")
    assert theirs.is_watertight
    assert theirs.volume == pytest.approx(mesh.volume, rel=1e-6)
    assert theirs.area == pytest.approx(mesh.area, rel=1e-6)


def test_stl_says_what_it_rounds_off(tmp_path: Path) -> None:
    mesh = Mesh(*shapes.icosphere(1))
    (note,) = write_mesh(mesh, tmp_path / "ball.stl")
    stated = float(re.search(r"up to (\S+)\.$", note).group(1))
    again = read_mesh(tmp_path / "ball.stl")
    nearest = np.linalg.norm(again.vertices[:, None] - mesh.vertices, axis=2).min(axis=0)
    assert 0.0 < nearest.max() <= np.sqrt(3) * stated * 1.05
    assert write_mesh(shapes.cube(), tmp_path / "cube.stl") == ()


@pytest.mark.parametrize("scale_and_shift", [(1e39, 0.0), (1e-3, 1e6)])
def test_stl_is_refused_where_single_precision_merges_vertices(
    scale_and_shift: tuple[float, float], tmp_path: Path
) -> None:
    scale, shift = scale_and_shift
    vertices, faces = shapes.octahedron()
    with pytest.raises(MeshError, match=r"write it as \.ply"):
        write_mesh((vertices * scale + shift, faces), tmp_path / "far.stl")
    assert list(tmp_path.iterdir()) == []
    assert write_mesh((vertices * scale + shift, faces), tmp_path / "far.ply") == ()


def test_another_suffix_is_refused_and_what_was_there_stays(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"ball\.glb: .*\.ply, \.off, \.obj, \.stl"):
        write_mesh(shapes.cube(), tmp_path / "ball.glb")
    assert list(tmp_path.iterdir()) == []
