"""A program of its own in which libraries decode what may be damaged: bytes in, arrays out.

Compiled decoders can end their process, and many readers allocate what a file announces. So they have one to
themselves, whose memory is bounded. It imports nothing of this project. Exit status 1 comes with one line on
standard error that says what is wrong with the file.
"""

from __future__ import annotations

import io
import json
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray]


def _draco(blobs: list[bytes], how: dict[str, Any]) -> Arrays:
    """Faces and attributes of Draco meshes: `faces_0`, and `0_3` for attribute 3 of the first."""
    import DracoPy

    made: Arrays = {}
    for number, (blob, wanted) in enumerate(zip(blobs, how["attributes"], strict=True)):
        mesh = DracoPy.decode(blob)
        if not hasattr(mesh, "faces"):
            raise ValueError("it holds points without faces")
        made[f"faces_{number}"] = np.asarray(mesh.faces, dtype=np.uint32).reshape(-1, 3)
        for one in wanted:
            found = mesh.get_attribute_by_unique_id(one)
            if found is None:
                raise ValueError(f"its compressed data have no attribute {one}")
            made[f"{number}_{one}"] = np.asarray(found["data"])
    return made


def _gmsh(blobs: list[bytes], how: dict[str, Any]) -> Arrays:
    """Points, and the cells of each block: `0_tetra`."""
    import meshio

    with _file_of(blobs[0]) as path:
        mesh = meshio.read(path, file_format="gmsh")
    points = np.asarray(mesh.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError("its points do not have three coordinates")
    made: Arrays = {"points": points}
    for number, block in enumerate(mesh.cells):
        cells = np.asarray(block.data)
        if cells.size and (cells.min() < 0 or cells.max() >= len(points)):
            raise ValueError("it has fewer points than its elements name")
        made[f"{number}_{block.type}"] = cells
    return made


def _gifti(blobs: list[bytes], how: dict[str, Any]) -> Arrays:
    """Points and faces of each surface: `points_0` and `faces_0`, and the codes of their spaces."""
    from nibabel.gifti import GiftiImage

    image = GiftiImage.from_bytes(blobs[0])
    points = image.get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    faces = image.get_arrays_from_intent("NIFTI_INTENT_TRIANGLE")
    made: Arrays = {}
    for number, (one, other) in enumerate(zip(points, faces, strict=False)):
        made[f"points_{number}"], made[f"faces_{number}"] = np.asarray(one.data), np.asarray(other.data)
    spaces = [0 if one.coordsys is None else int(one.coordsys.dataspace) for one in points]
    made["spaces"] = np.array(spaces, dtype=np.int64)
    return made


def _freesurfer(blobs: list[bytes], how: dict[str, Any]) -> Arrays:
    """Points and faces, and the place of the volume's centre in the scanner's coordinates."""
    from nibabel.freesurfer import read_geometry

    with _file_of(blobs[0]) as path:
        points, faces, *more = read_geometry(path, read_metadata=blobs[0][:3] == b"\xff\xff\xfe")
    centre = more[0].get("cras", np.zeros(3)) if more else np.zeros(3)
    return {"points": points, "faces": np.asarray(faces), "centre": np.asarray(centre, dtype=np.float64)}


@contextmanager
def _file_of(data: bytes) -> Iterator[str]:
    """A file that holds some bytes, for libraries that read nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "given"
        path.write_bytes(data)
        yield str(path)


LIBRARIES_OWN_MEMORY = 64 << 20
"""Bytes that libraries take for themselves."""

TASKS: dict[str, Callable[[list[bytes], dict[str, Any]], Arrays]] = {
    **{"draco": _draco, "gmsh": _gmsh},
    **{"gifti": _gifti, "freesurfer": _freesurfer},
}
"""What it is told to do."""


def _limit(memory: int, seconds: int) -> None:
    """Let this process have so many bytes and seconds more, where the system can hold it to that."""
    with suppress(ImportError, OSError, ValueError):  # there is no such limit on Windows
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (int(time.process_time()) + seconds,) * 2)
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + memory,) * 2)


def main(task: str) -> int:
    """Answer one request and return the exit status."""
    warnings.simplefilter("ignore")
    head = json.loads(sys.stdin.buffer.readline())
    blobs = [sys.stdin.buffer.read(size) for size in head["sizes"]]
    for name in head["imports"]:
        __import__(name)
    _limit(head["memory"] + LIBRARIES_OWN_MEMORY, head["seconds"])
    answer = io.BytesIO()
    try:
        with redirect_stdout(sys.stderr):
            arrays = TASKS[task](blobs, head["how"])
        np.savez(answer, allow_pickle=False, **arrays)
    except MemoryError:
        print("it asks for more memory than a file of its size can need", file=sys.stderr)
        return 1
    except (Exception, SystemExit) as error:  # rubbish can make a reader raise anything, and meshio exits
        cause = " ".join(str(error).split()) or type(error).__name__
        print(f"truncated or damaged ({cause[:100]})", file=sys.stderr)
        return 1
    sys.stdout.buffer.write(answer.getbuffer())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
