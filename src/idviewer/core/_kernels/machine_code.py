"""Machine code of the kernels, kept on disk by the content of all their sources.

numba looks at the source of a kernel alone: after a change of what it calls in another file it would go on
with the machine code of before, and fail on what it kept of a module that has another name now.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import platformdirs
from numba import config


def cache_folder() -> Path:
    """The folder of these sources' machine code, in the user's cache folder or in NUMBA_CACHE_DIR."""
    sources = sorted(Path(__file__).parent.rglob("*.py"))
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]
    given = os.environ.get("NUMBA_CACHE_DIR")
    return (Path(given) if given else platformdirs.user_cache_path("idviewer", False) / "kernels") / digest


@contextmanager
def kept_by_sources() -> Iterator[None]:
    """Have kernels that are defined within keep their machine code there, and nobody else's."""
    before = config.CACHE_DIR  # type: ignore[attr-defined]
    config.CACHE_DIR = str(cache_folder())  # type: ignore[attr-defined]
    try:
        yield
    finally:
        config.CACHE_DIR = before  # type: ignore[attr-defined]
