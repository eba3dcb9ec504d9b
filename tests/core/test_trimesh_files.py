"""Files that trimesh writes."""

from __future__ import annotations

import warnings

import pytest
import trimesh
from tests.core import shapes

from idviewer.core.io.meshes import read_mesh
from idviewer.core.shapes.mesh import Mesh


@pytest.mark.parametrize(
    ("suffix", "how"),
    [
        ("off", {}),
        ("obj", {}),
        ("ply", {}),
        ("ply", {"encoding": "ascii"}),
        ("stl", {}),
        ("stl_ascii", {}),
        ("glb", {}),
    ],
)
def test_files_written_by_trimesh(tmp_path, suffix, how):
    vertices, faces = shapes.torus()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data = trimesh.Trimesh(vertices, faces, process=False).export(file_type=suffix, **how)
    path = tmp_path / f"ring.{suffix[:3]}"
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    mesh = read_mesh(path)
    assert mesh.volume == pytest.approx(Mesh(vertices, faces).volume, rel=1e-6)
    assert len(mesh.faces) == len(faces)
