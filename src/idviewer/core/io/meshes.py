"""The one door for mesh files: what comes out is a Mesh, or a MeshError of one line."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from idviewer.core.io.files import bytes_of, told
from idviewer.core.io.gltf import read_glb, read_gltf
from idviewer.core.io.obj import read_obj
from idviewer.core.io.off import read_off
from idviewer.core.io.ply import read_ply
from idviewer.core.io.stl import read_stl
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.vtp import read_vtp
from idviewer.core.shapes.diagnosis import Diagnosis, diagnosis_of
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.repair import mended
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup

_READERS: dict[str, Callable[[bytes], PolygonSoup]] = {
    ".off": read_off,
    ".obj": read_obj,
    ".ply": read_ply,
    ".stl": read_stl,
    ".glb": read_glb,
    ".gltf": read_gltf,
    ".vtp": read_vtp,
}

READABLE_SUFFIXES = tuple(_READERS)
"""Suffixes of the files that can be read, in lower case and with their dot."""


def read_mesh(path: str | os.PathLike[str], component: int | None = None) -> Mesh:
    """The mesh in a file: OFF, OBJ, PLY, STL, GLB, glTF or VTP, told by its suffix.

    What can be mended is (see `idviewer.core.repair_mesh`), and every repair is a sentence in the mesh's
    notes. All objects of the file are read as one mesh; materials and textures are not looked at.

    Args:
        path: of the file.
        component: which of several components to take, 1 for the largest.

    Raises:
        MeshError: there is no such file, it cannot be read, it is damaged, or what it holds is no closed
            surface. The message is one line that names the file.
    """
    path = Path(path)
    return mended(_polygons(path), path.stem, told(path), component)


def inspect_file(path: str | os.PathLike[str]) -> Diagnosis:
    """Sizes of the mesh in a file and everything that is wrong with it, however unusable it is as a Mesh.

    Raises:
        MeshError: there is no such file, or it cannot be read, or it is damaged.
    """
    return diagnosis_of(validate(_polygons(Path(path))))


def _polygons(path: Path) -> PolygonSoup:
    """What the file holds, unchecked."""
    try:
        data = bytes_of(path, "mesh", "cannot be read", READABLE_SUFFIXES)
    except UnreadableError as error:
        raise MeshError(f"{told(path)}: {error}") from error
    return _parsed(path, path.suffix.lower(), data)


def _parsed(path: Path, suffix: str, data: bytes) -> PolygonSoup:
    kind = {".gltf": "glTF"}.get(suffix, suffix[1:].upper())
    try:
        return read_gltf(data, path.parent) if suffix == ".gltf" else _READERS[suffix](data)
    except UnreadableError as error:
        raise MeshError(f"{told(path)}: not a whole {kind} file: {told(error)}; export it again") from error
    except Exception as error:  # rubbish can make a parser raise anything; out of this door comes one line
        cause = told(f"{type(error).__name__}: {error}")[:100]
        raise MeshError(f"{told(path)}: not a readable {kind} file ({cause}); export it again") from error
