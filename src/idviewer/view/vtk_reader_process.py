"""A program of its own that reads a VTK file from standard input and writes arrays to standard output.

VTK's readers end their process when a damaged array makes them ask for more memory than there is. So they
have one to themselves, which imports nothing but VTK and numpy. Its arguments are the bytes of memory and the
seconds of computing that reading may take. Exit status 1 comes with one line on standard error that says what
is wrong with the file.
"""

from __future__ import annotations

import io
import re
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPointSet, vtkPolyData
from vtkmodules.vtkIOLegacy import vtkPolyDataReader, vtkUnstructuredGridReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

Cells = tuple[NDArray[np.int64], NDArray[np.int64]]
"""Corners of all cells one after the other, and how many each cell has."""

XML_READERS: dict[str, type] = {
    "PolyData": vtkXMLPolyDataReader,
    "UnstructuredGrid": vtkXMLUnstructuredGridReader,
}
LEGACY_READERS: dict[str, type] = {
    "POLYDATA": vtkPolyDataReader,
    "UNSTRUCTURED_GRID": vtkUnstructuredGridReader,
}
LEGACY_HEADER = rb"# vtk DataFile Version[^\n]*\n[^\n]*\n\s*(?:ASCII|BINARY)\s+DATASET\s+(\w+)"

# VTK's numbers of cell types.
STRIP, POLYGON, POLYHEDRON = 6, 7, 42

VTKS_OWN_MEMORY = 256 << 20
"""Bytes that VTK takes for itself, beside those that a file may ask for."""

DUPLICATED_OR_HIDDEN = 1 | 32
"""Marks of cells that another piece has, or that are not shown."""


class DamagedError(ValueError):
    """A damaged file; the message tells its owner what is wrong with it."""


def read(data: bytes) -> dict[str, NDArray]:
    """Points and cells of a file.

    Returns:
        points (n, 3); corners, sizes and VTK's types of cells; corners and sizes of all polyhedra's faces.

    Raises:
        DamagedError: the file holds no surface, or its arrays do not fit each other. What else is wrong with
            it, VTK tells its output window.
    """
    made = _read_xml(data) if data.lstrip()[:1] == b"<" else _read_legacy(data)
    points = _points(made)
    faces: Cells = (np.empty(0, np.int64), np.empty(0, np.int64))
    if isinstance(made, vtkPolyData):
        polygons, strips = _cells(made.GetPolys()), _cells(made.GetStrips())
        cells = np.concatenate([polygons[0], strips[0]]), np.concatenate([polygons[1], strips[1]])
        types = np.repeat([POLYGON, STRIP], [len(polygons[1]), len(strips[1])])
    else:
        grid: Any = made
        cells, types = _cells_of_grid(grid)
        if np.any(types == POLYHEDRON):
            faces = _cells(grid.GetPolyhedronFaces())
    for corners, _ in (cells, faces):
        if np.any((corners < 0) | (corners >= len(points))):
            raise DamagedError("truncated or damaged (it has fewer points than its cells name)")
    return {
        "points": points,
        "corners": cells[0],
        "sizes": cells[1],
        "types": types,
        "face_corners": faces[0],
        "face_sizes": faces[1],
    }


def _read_xml(data: bytes) -> vtkPointSet:
    root = re.search(rb"<VTKFile\b[^>]*>", data)
    kind = re.search(rb"\btype\s*=\s*[\"'](\w+)", root.group()) if root else None
    if kind is None or not data.rstrip().endswith(b"</VTKFile>"):
        raise DamagedError("truncated, or no XML file of VTK")
    return _output(XML_READERS, kind.group(1).decode(), data)


def _read_legacy(data: bytes) -> vtkPointSet:
    header = re.match(LEGACY_HEADER, data)
    if header is None:
        raise DamagedError("truncated, or no file of VTK")
    return _output(LEGACY_READERS, header.group(1).decode(), data)


def _output(readers: dict[str, type], kind: str, data: bytes) -> vtkPointSet:
    if kind not in readers:
        raise DamagedError(f"it holds {kind[:40]}, not {' or '.join(readers)}")
    reader = readers[kind]()
    reader.ReadFromInputStringOn()
    if readers is XML_READERS:
        reader.SetInputString(data, len(data))
    else:
        # Where the file ends too early, VTK goes on reading and finds no point's number.
        data += 64 * b"\n"
        reader.SetBinaryInputString(data, len(data))
    reader.Update()
    made = reader.GetOutputDataObject(0)
    if made is None:
        raise DamagedError("truncated or damaged")
    return made


def _refuse_errors(told: str | bytes) -> None:
    """Raise VTK's first error; what it only warns of is none of a surface's points and cells."""
    output = told if isinstance(told, str) else told.decode(errors="replace")  # VTK quotes what it finds
    error = re.search(r"ERROR: In .*, line \d+\n(?:\w+ \(0x\w+\): )?(.*)", output)
    if error:
        raise DamagedError(f"truncated or damaged ({error.group(1)[:80].rstrip(' .')})")


def _cells_of_grid(grid: Any) -> tuple[Cells, NDArray[np.int64]]:
    """The cells of a grid and their types, without those that belong to another piece."""
    corners, sizes = _cells(grid.GetCells())
    types = np.empty(0, np.int64)
    if len(sizes):
        types = vtk_to_numpy(grid.GetCellTypes()).astype(np.int64)
    if len(types) != len(sizes):
        raise DamagedError("truncated or damaged (its cells do not fit their types)")
    ghosts = grid.GetCellGhostArray()
    if ghosts is not None and len(sizes):
        own = (vtk_to_numpy(ghosts) & DUPLICATED_OR_HIDDEN) == 0
        if np.any(types[~own] == POLYHEDRON):
            raise DamagedError(
                "it has polyhedra that belong to other pieces; extract the surface and save that"
            )
        corners, sizes, types = corners[np.repeat(own, sizes)], sizes[own], types[own]
    return (corners, sizes), types


def _points(data: vtkPointSet) -> NDArray[np.float64]:
    points = data.GetPoints()
    if points is None or points.GetNumberOfPoints() == 0:
        return np.empty((0, 3))
    return np.array(vtk_to_numpy(points.GetData()), dtype=np.float64).reshape(-1, 3)


def _cells(cells: vtkCellArray | None) -> Cells:
    if cells is None or cells.GetNumberOfCells() == 0:
        return np.empty(0, np.int64), np.empty(0, np.int64)
    cells.ConvertTo64BitStorage()
    ends = vtk_to_numpy(cells.GetOffsetsArray()).astype(np.int64)
    corners = vtk_to_numpy(cells.GetConnectivityArray()).astype(np.int64)
    sizes = np.diff(ends)
    if ends[0] != 0 or np.any(sizes < 0) or ends[-1] != len(corners):
        raise DamagedError("truncated or damaged (its cells do not fit their offsets)")
    return corners, sizes


def _limit(memory: int, seconds: int) -> None:
    """Have the system end this process where reading takes more: counts in a damaged file are any number."""
    with suppress(ImportError, OSError):  # there is none on Windows, nor core dumps
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time()) + seconds,) * 2)
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + memory + VTKS_OWN_MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def main() -> int:
    """Answer one file and return the exit status."""
    _limit(*map(int, sys.argv[1:3]))
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    window = vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    try:
        arrays = read(sys.stdin.buffer.read())
        _refuse_errors(window.GetOutput())
    except MemoryError:
        print("it asks for more memory than a file of its size can need", file=sys.stderr)
        return 1
    except DamagedError as error:
        print(error, file=sys.stderr)
        return 1
    answer = io.BytesIO()
    np.savez(answer, allow_pickle=False, **arrays)
    sys.stdout.buffer.write(answer.getbuffer())
    return 0


if __name__ == "__main__":
    sys.exit(main())
