"""Writers of meshes: PLY, OFF, OBJ and STL, whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.atomic_write import atomic_path
from idviewer.core.io.formats import one_line
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.shape import MeshLike, as_mesh
from idviewer.core.validation.soup_repairs import first_coincident, side_vectors

STL_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])


def write_mesh(mesh: MeshLike, path: str | os.PathLike[str]) -> tuple[str, ...]:
    """Write a mesh as PLY, OFF, OBJ or STL, by the suffix.

    All but STL keep every digit and the order of vertices and faces; STL holds single precision and no
    vertices of its own. The file is written beside its place and then renamed, so that it is there as a
    whole or not at all.

    Args:
        mesh: n vertices and m faces.
        path: of the file, which is replaced where there is one.

    Raises:
        MeshError: another suffix, or coordinates that single precision cannot tell apart or hold.
        OSError: the file cannot be written.

    Returns:
        What the format lost, one sentence each.

    >>> import tempfile
    >>> from idviewer.core import read_mesh
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1 / 3]]
    >>> with tempfile.TemporaryDirectory() as name:
    ...     path = Path(name) / "corner.off"
    ...     _ = write_mesh((corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), path)
    ...     bool((read_mesh(path).vertices == corners).all())
    True
    """
    mesh, path = as_mesh(mesh), Path(path)
    check_mesh_path(path)
    data, notes = _WRITERS[path.suffix.lower()](mesh)
    with atomic_path(path) as part:
        part.write_bytes(data)
    return notes


def check_mesh_path(path: str | os.PathLike[str]) -> None:
    """Refuse a file whose suffix names no format that meshes are written in.

    Args:
        path: of the file.

    Raises:
        MeshError: it is such.

    >>> check_mesh_path("bunny.ply")
    """
    path = Path(path)
    if path.suffix.lower() not in _WRITERS:
        suffixes = ", ".join(_WRITERS)
        raise MeshError(f"{one_line(path)}: meshes are written as one of {suffixes}; choose one of these")


def writable_suffixes() -> tuple[str, ...]:
    """Suffixes of the formats that meshes are written in, in lower case and with their dot.

    >>> writable_suffixes()
    ('.ply', '.off', '.obj', '.stl')
    """
    return tuple(_WRITERS)


def _as_ply(mesh: Mesh) -> tuple[bytes, tuple[str, ...]]:
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(mesh.faces), np.dtype([("size", "u1"), ("corners", "<i4", 3)]))
    rows["size"], rows["corners"] = 3, mesh.faces
    return header.encode() + mesh.vertices.astype("<f8").tobytes() + rows.tobytes(), ()


def _as_off(mesh: Mesh) -> tuple[bytes, tuple[str, ...]]:
    faces = "".join(f"3 {a} {b} {c}\n" for a, b, c in mesh.faces.tolist())
    return f"OFF\n{len(mesh.vertices)} {len(mesh.faces)} 0\n{_points(mesh, '')}{faces}".encode(), ()


def _as_obj(mesh: Mesh) -> tuple[bytes, tuple[str, ...]]:
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in (mesh.faces + 1).tolist())
    return f"{_points(mesh, 'v ')}{faces}".encode(), ()


def _points(mesh: Mesh, before: str) -> str:
    return "".join(f"{before}{x!r} {y!r} {z!r}\n" for x, y, z in mesh.vertices.tolist())


def _as_stl(mesh: Mesh) -> tuple[bytes, tuple[str, ...]]:
    with np.errstate(over="ignore", under="ignore"):
        single = mesh.vertices.astype(np.float32)
    rounded = single.astype(np.float64)
    if not np.isfinite(single).all() or _different(rounded) < _different(mesh.vertices):
        raise MeshError(
            "STL holds single precision, which cannot tell all vertices of this mesh apart; write it as .ply"
        )
    facets = np.zeros(len(mesh.faces), STL_FACET)
    facets["corners"] = single[mesh.faces]
    _, b, c = side_vectors(rounded, mesh.faces)
    normals = np.cross(b, c)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facets["normal"] = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    data = b"written by idviewer".ljust(80) + np.uint32(len(facets)).astype("<u4").tobytes()
    moved = float(np.abs(rounded - mesh.vertices).max())
    lost = f"STL holds single precision: coordinates were rounded, by up to {moved:.2g}." if moved else ""
    return data + facets.tobytes(), (lost,) if lost else ()


def _different(points: Floats) -> int:
    """How many different points there are."""
    first = first_coincident(points)
    return int(np.count_nonzero(first == np.arange(len(first))))


_WRITERS: dict[str, Callable[[Mesh], tuple[bytes, tuple[str, ...]]]] = {
    ".ply": _as_ply,
    ".off": _as_off,
    ".obj": _as_obj,
    ".stl": _as_stl,
}
