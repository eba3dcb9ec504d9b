"""Surfaces and volumes in VTK's own files: .vtp and .vtu (XML), and legacy .vtk. VTK reads them, in another
process.

Nothing here imports VTK, so that registering the reader costs nothing.
"""

from __future__ import annotations

import io
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from idviewer.core.io import MEMORY_BOUND, Contents, FileSource, UnreadableError, add_reader
from idviewer.core.validation import Cells, PolygonSoup, strips, surface_of_cells

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

VTK_SUFFIXES = (".vtp", ".vtu", ".vtk")
_STRIP, _PIXEL, _POLYHEDRON = 6, 8, 42
_LINES = (0, 1, 2, 3, 4, 21, 35, 68, 75)
_FLAT = {
    **{5: "triangle", 6: "strip", 7: "polygon", 8: "pixel", 9: "quad"},
    **{22: "triangle6", 23: "quad8", 28: "quad9", 34: "triangle7"},
}
_CURVED = ("triangle6", "quad8", "quad9", "triangle7")
_VOLUMES = {
    **{10: "tetra", 11: "voxel", 12: "hexahedron", 13: "wedge", 14: "pyramid"},
    **{24: "tetra10", 25: "hexahedron20", 26: "wedge15", 27: "pyramid13"},
    **{29: "hexahedron27", 32: "wedge18", 33: "hexahedron24"},
}
"""VTK's numbers of cell types."""

_NAMES = {"voxel": "hexahedron"}
_REORDERED = {"voxel": [0, 1, 3, 2, 4, 5, 7, 6]}
_PROGRAM = Path(__file__).with_name("vtk_reader_process.py")


@dataclass(frozen=True)
class ReadingTime:
    """Time that VTK may compute on a file before it is refused as damaged.

    Attributes:
        seconds: in any case.
        seconds_per_megabyte: beside.
    """

    seconds: int = 5
    seconds_per_megabyte: float = 2.0

    def of(self, size: int) -> int:
        """Seconds for a file of so many bytes."""
        return self.seconds + int(self.seconds_per_megabyte * size / 1e6)


VTK_TIME = ReadingTime()


def register_vtk_reader() -> None:
    """Have `read_mesh` and `read_shape` read VTK's files too."""
    add_reader(VTK_SUFFIXES, read_vtk)


def read_vtk(source: FileSource) -> Contents[PolygonSoup]:
    """Polygons of a VTK file, of all its pieces together; of volumes the outer surface.

    Points and lines are passed over, and flat cells beside volumes.

    Args:
        source: the file; its bytes tell its format.

    Raises:
        UnreadableError: the file is damaged or truncated, or holds cells that are not known.
    """
    arrays = _arrays_by_vtk(source.data)
    pieces = source.data.partition(b"<AppendedData")[0].count(b"<Piece")
    return surface_of(arrays, welded=pieces > 1)


def _arrays_by_vtk(data: bytes) -> dict[str, NDArray]:
    """What the other process answers."""
    most = str(MEMORY_BOUND.of(len(data)))
    # -P: a folder of modules is no place to look for those of the standard library.
    seconds = VTK_TIME.of(len(data))
    command = [sys.executable, "-P", str(_PROGRAM), most, str(seconds)]
    done = subprocess.run(command, input=data, capture_output=True, check=False)
    if done.returncode == 1 and done.stderr.strip():
        raise UnreadableError(done.stderr.decode(errors="replace").strip().splitlines()[-1])
    if done.returncode:
        raise UnreadableError("truncated or damaged, so much that VTK gave up on it")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as stored:
        return dict(stored)


def surface_of(arrays: dict[str, NDArray], welded: bool = False) -> Contents[PolygonSoup]:
    """The polygons among a file's cells, or the outer surface of its volumes.

    Args:
        arrays: what `vtk_reader_process.read` gives.
        welded: whether volumes are neighbours, too, where they share places, and not points alone.

    Raises:
        UnreadableError: there are cells that are not known, or they contradict each other.
    """
    cells = _CellArrays(**arrays)
    volumes = [cells.of(kind) for number, kind in _VOLUMES.items() if number in cells.types]
    if not volumes and not len(cells.face_sizes):
        return Contents(PolygonSoup(cells.points, *cells.flat()))
    flat = int(np.isin(cells.types, list(_FLAT)).sum())
    if welded:
        volumes, faces = cells.welded(volumes)
    else:
        faces = cells.face_corners
    polyhedra = (faces, cells.face_sizes) if len(faces) else None
    polygons, notes = surface_of_cells(cells.points, volumes, polyhedra)
    if flat:
        notes += (f"{flat:,} flat cells beside the volumes were passed over.",)
    return Contents(PolygonSoup(cells.points, *polygons), notes)


@dataclass
class _CellArrays:
    """What the other process answers."""

    points: Floats
    corners: Ints
    sizes: Ints
    types: Ints
    face_corners: Ints
    face_sizes: Ints

    def __post_init__(self) -> None:
        known = [*_LINES, *_FLAT, *_VOLUMES, _POLYHEDRON]
        unknown = self.types[~np.isin(self.types, known)]
        if len(unknown):
            raise UnreadableError(
                f"it holds cells of VTK's type {unknown[0]}; extract the surface and save that"
            )
        self.starts = np.cumsum(self.sizes) - self.sizes

    def of(self, kind: str) -> Cells:
        """Cells of one kind of volume or flat cell with a fixed number of points."""
        number = next(number for number, name in {**_VOLUMES, **_FLAT}.items() if name == kind)
        chosen = self.types == number
        size = int(self.sizes[chosen][0])
        if np.any(self.sizes[chosen] != size):
            raise UnreadableError("truncated or damaged (its cells do not fit their types)")
        points = self.corners[self.starts[chosen, None] + np.arange(size)]
        try:
            return Cells(
                _NAMES.get(kind, kind), points[:, _REORDERED[kind]] if kind in _REORDERED else points
            )
        except (ValueError, IndexError) as error:
            raise UnreadableError(f"truncated or damaged ({error})") from error

    def flat(self) -> tuple[Ints, Ints]:
        """Corners and sizes of the flat cells, in their order as far as they are polygons, and of strips."""
        curved = [surface_of_cells(self.points, [self.of(kind)])[0] for kind in _CURVED if self.has(kind)]
        pixels = np.flatnonzero((self.types == _PIXEL) & (self.sizes == 4))
        third = self.starts[pixels] + 2
        self.corners[np.stack([third, third + 1])] = self.corners[np.stack([third + 1, third])]
        straight = np.isin(
            self.types, [number for number, kind in _FLAT.items() if kind not in (*_CURVED, "strip")]
        )
        turned = [
            strips(self.corners[start : start + size])
            for start, size in zip(
                self.starts[self.types == _STRIP], self.sizes[self.types == _STRIP], strict=True
            )
        ]
        triangles = np.concatenate([np.empty((0, 3), np.int64), *turned])
        return (
            np.concatenate(
                [
                    self.corners[np.repeat(straight, self.sizes)],
                    *(one for one, _ in curved),
                    triangles.ravel(),
                ]
            ),
            np.concatenate([self.sizes[straight], *(one for _, one in curved), np.full(len(triangles), 3)]),
        )

    def has(self, kind: str) -> bool:
        return bool(np.any(self.types == next(number for number, name in _FLAT.items() if name == kind)))

    def welded(self, volumes: list[Cells]) -> tuple[list[Cells], Ints]:
        """Cells and polyhedra on the first of all points that are alike, as pieces have their own."""
        _, first, alike = np.unique(self.points, axis=0, return_index=True, return_inverse=True)
        onto = first[alike.reshape(-1)]
        return [Cells(one.kind, onto[one.points]) for one in volumes], onto[self.face_corners]
