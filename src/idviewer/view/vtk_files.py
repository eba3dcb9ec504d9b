"""Surfaces in VTK's own files: .vtp and .vtu (XML), and legacy .vtk. VTK reads them, in another process.

Nothing here imports VTK, so that registering the reader costs nothing.
"""

from __future__ import annotations

import io
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from idviewer.core.io import FileSource, UnreadableError, add_reader
from idviewer.core.validation import PolygonSoup, strips

VTK_SUFFIXES = (".vtp", ".vtu", ".vtk")
_PROGRAM = Path(__file__).with_name("vtk_reader_process.py")


@dataclass(frozen=True)
class ReadingLimits:
    """What reading a file may take before it is refused as damaged.

    Attributes:
        memory: bytes in any case, for VTK itself and its threads.
        memory_share: times the file's size beside; arrays may be compressed to a hundredth.
        seconds: of computing in any case.
        seconds_per_megabyte: beside.
    """

    memory: int = 500_000_000
    memory_share: int = 200
    seconds: int = 5
    seconds_per_megabyte: float = 2.0

    def of(self, size: int) -> tuple[int, int]:
        """Bytes and seconds for a file of so many bytes."""
        return self.memory + self.memory_share * size, self.seconds + int(
            self.seconds_per_megabyte * size / 1e6
        )


VTK_LIMITS = ReadingLimits()


def register_vtk_reader() -> None:
    """Have `read_mesh` and `read_shape` read VTK's files too."""
    add_reader(VTK_SUFFIXES, read_vtk)


def read_vtk(source: FileSource) -> PolygonSoup:
    """Polygons of a VTK file, of all its pieces together; points and lines are passed over.

    Args:
        source: the file; its bytes tell its format.

    Raises:
        UnreadableError: the file is damaged or truncated, or holds something else than a surface.
    """
    # -P: a folder of modules is no place to look for those of the standard library.
    command = [sys.executable, "-P", str(_PROGRAM), *map(str, VTK_LIMITS.of(len(source.data)))]
    done = subprocess.run(command, input=source.data, capture_output=True, check=False)
    if done.returncode == 1 and done.stderr.strip():
        raise UnreadableError(done.stderr.decode(errors="replace").strip().splitlines()[-1])
    if done.returncode:
        raise UnreadableError("truncated or damaged, so much that VTK gave up on it")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as stored:
        arrays = dict(stored)
    ends = np.cumsum(arrays["strip_sizes"])[:-1]
    triangles = [strips(strip) for strip in np.split(arrays["strip_corners"], ends)]
    turned = np.concatenate([np.empty((0, 3), np.int64), *triangles])
    return PolygonSoup(
        arrays["points"],
        np.concatenate([arrays["polygon_corners"], turned.ravel()]),
        np.concatenate([arrays["polygon_sizes"], np.full(len(turned), 3, np.int64)]),
    )
