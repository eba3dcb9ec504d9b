"""Libraries that read further formats: extras, whose absence is told with the command that adds them."""

from __future__ import annotations

import importlib
import importlib.util
import io
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from idviewer.core.io.memory_bound import MEMORY_BOUND
from idviewer.core.io.text import UnreadableError

FORMATS_EXTRA = "pip install 'idviewer[formats]'"
_LIBRARY_PROGRAM = Path(__file__).with_name("library_process.py")


class MissingLibraryError(UnreadableError):
    """A file that can be read when a package is there."""


def library(name: str, reason: str) -> Any:
    """Import the package of an extra.

    Args:
        name: of the package.
        reason: why it is needed, to begin the message with.

    Raises:
        MissingLibraryError: it is not installed; the message names the command that installs it.

    >>> library("math", "it holds numbers").pi > 3
    True
    """
    _require(name, reason)
    return importlib.import_module(name)


def arrays_by(name: str, task: str, blobs: Sequence[bytes], **how: Any) -> dict[str, NDArray]:
    """Have a package decode what may be damaged, in a process of its own, with bounded memory.

    Args:
        name: of the package.
        task: which of the tasks in `library_process`.
        blobs: what it is given to decode.
        how: further arguments, as JSON knows them; "reason" is told where the package is missing.

    Raises:
        MissingLibraryError: it is not installed.
        UnreadableError: what is given is damaged, or asks for too much memory.
    """
    _require(name, how.pop("reason", f"it is read by {name}"))
    sizes = [len(blob) for blob in blobs]
    total = sum(sizes)
    bounds = {"memory": MEMORY_BOUND.of(total), "seconds": MEMORY_BOUND.seconds_for(total)}
    head = {"sizes": sizes, "imports": [name], **bounds, "how": how}
    given = json.dumps(head).encode() + b"\n" + b"".join(blobs)
    # -P: a folder of modules is no place to look for those of the standard library.
    done = subprocess.run(
        [sys.executable, "-P", str(_LIBRARY_PROGRAM), task], input=given, capture_output=True, check=False
    )
    if done.returncode == 1 and done.stderr.strip():
        raise UnreadableError(done.stderr.decode(errors="replace").strip().splitlines()[-1])
    if done.returncode:
        raise UnreadableError(f"truncated or damaged, so much that {name} gave up on it")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as stored:
        return dict(stored)


def _require(name: str, reason: str) -> None:
    if importlib.util.find_spec(name) is None:
        raise MissingLibraryError(f"{reason}, and the package {name} is missing; {FORMATS_EXTRA} adds it")
