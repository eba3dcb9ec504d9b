"""Mesh files that libraries read: Gmsh (meshio), GIFTI and FreeSurfer's surfaces (nibabel).

The libraries come with the extra `formats`, and run in a process of their own; see `libraries`.
"""

from __future__ import annotations

import re

import numpy as np

from idviewer.core.errors import Part
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.libraries import arrays_by
from idviewer.core.io.text import UnreadableError
from idviewer.core.validation.cell_surfaces import CELL_KINDS, Cells, surface_of_cells
from idviewer.core.validation.polygon_soup import PolygonSoup

_VERTICES_AND_LINES = re.compile(r"vertex|line\d*")
_SPACES = {
    "0": "an unknown space",
    "1": "the scanner's space",
    "2": "the space of another scan",
    "3": "Talairach's space",
    "4": "MNI's space 152",
}
"""Coordinate systems of NIfTI, by their codes."""


def read_gmsh(source: FileSource) -> Contents[PolygonSoup]:
    """Read the outer surface of the volumes in a Gmsh file, or else its surface elements.

    Args:
        source: the file, of version 2 or 4, text or binary.

    Raises:
        MissingLibraryError: meshio is not installed.
        UnreadableError: it is damaged, or holds elements that are not known.
    """
    if not source.data.lstrip().startswith((b"$MeshFormat", b"$Comments")):
        raise UnreadableError("it is no file of Gmsh in version 2 or 4; save it in one of these")
    ends = re.findall(rb"\$EndElements\b", source.data)
    if not ends:
        raise UnreadableError("truncated: its elements do not end")
    made = arrays_by("meshio", "gmsh", [source.data], reason="files of Gmsh are read by meshio")
    points = made.pop("points")
    blocks, lines = [], 0
    for name, cells in made.items():
        kind = name.split("_", 1)[1]
        if kind in CELL_KINDS:
            blocks.append(Cells(kind, cells.astype(np.int64)))
        elif _VERTICES_AND_LINES.fullmatch(kind):
            lines += len(cells)
        else:
            raise UnreadableError(f"it holds elements of the kind {kind}, which are not known")
    polygons, notes = surface_of_cells(points, blocks)
    return Contents(PolygonSoup(points, *polygons), notes)


def read_gifti(source: FileSource) -> Contents[PolygonSoup]:
    """Read the surface in a GIFTI file; its coordinates are millimetres.

    Args:
        source: the file; its part may be one of several surfaces.

    Raises:
        MissingLibraryError: nibabel is not installed.
        UnreadableError: it is damaged, or holds values on a surface and no surface.
        PartError: it holds several surfaces and none is chosen, or not that one.
    """
    if b"<GIFTI" not in source.data:
        raise UnreadableError("it is no GIFTI file")
    if b"<!ENTITY" in source.data:
        raise UnreadableError("it declares entities, which GIFTI does not need")
    if b"ExternalFileBinary" in source.data:
        raise UnreadableError("it keeps its data in another file; save it with the data inside")
    made = arrays_by("nibabel", "gifti", [source.data], reason="GIFTI files are read by nibabel")
    count = len(made["spaces"])
    if f"points_{count - 1}" not in made or f"faces_{count - 1}" not in made:
        raise UnreadableError(
            "it holds values on a surface, and no surface; open the surface that they belong to"
        )
    parts = [Part(f"surface {number + 1}") for number in range(count)]
    chosen = source.chosen(parts, "surfaces") or 0
    points, faces = made[f"points_{chosen}"], made[f"faces_{chosen}"]
    if points.ndim != 2 or points.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3:
        raise UnreadableError("its points or triangles do not come in threes")
    space = _SPACES.get(str(made["spaces"][chosen]), "a space of its own")
    soup = PolygonSoup(points.astype(np.float64), faces.astype(np.int64).ravel(), np.full(len(faces), 3))
    return Contents(soup, (f"Its coordinates are in {space}.",), "mm")


def read_freesurfer(source: FileSource) -> Contents[PolygonSoup]:
    """Read a surface of FreeSurfer; its coordinates are millimetres about the volume's centre.

    Args:
        source: the file.

    Raises:
        MissingLibraryError: nibabel is not installed.
        UnreadableError: it is damaged, or no surface.
    """
    if source.data[:3] not in (b"\xff\xff\xfe", b"\xff\xff\xff", b"\xff\xff\xfd"):
        raise UnreadableError("it does not begin as a surface of FreeSurfer does")
    reason = "surfaces of FreeSurfer are read by nibabel"
    made = arrays_by("nibabel", "freesurfer", [source.data], reason=reason)
    centre = made["centre"].tolist()
    where = (
        f"; the scanner's are these plus ({', '.join(f'{one:g}' for one in centre)})" if any(centre) else ""
    )
    faces = made["faces"].astype(np.int64)
    soup = PolygonSoup(made["points"].astype(np.float64), faces.ravel(), np.full(len(faces), 3))
    return Contents(soup, (f"Its coordinates are FreeSurfer's own{where}.",), "mm")
