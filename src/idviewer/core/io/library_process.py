"""A program of its own in which libraries decode what may be damaged: bytes in, arrays out.

Compiled decoders can end their process, and many readers allocate what a file announces. So they have one to
themselves, whose memory is bounded. It imports nothing of this project. Exit status 1 comes with one line on
standard error that says what is wrong with the file.
"""

from __future__ import annotations

import io
import json
import sys
import warnings
from collections.abc import Callable
from contextlib import redirect_stdout, suppress
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


LIBRARIES_OWN_MEMORY = 64 << 20
"""Bytes that libraries take for themselves."""

TASKS: dict[str, Callable[[list[bytes], dict[str, Any]], Arrays]] = {"draco": _draco}
"""What it is told to do."""


def bound_memory(more: int) -> None:
    """Let this process have so many bytes more than it has now, where the system can hold it to that."""
    with suppress(ImportError, OSError, ValueError):  # there is no such limit on Windows
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + more,) * 2)


def main(task: str) -> int:
    """Answer one request and return the exit status."""
    warnings.simplefilter("ignore")
    head = json.loads(sys.stdin.buffer.readline())
    blobs = [sys.stdin.buffer.read(size) for size in head["sizes"]]
    for name in head["imports"]:
        __import__(name)
    bound_memory(head["memory"] + LIBRARIES_OWN_MEMORY)
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
