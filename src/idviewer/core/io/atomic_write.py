"""Atomic writes: files that are there as a whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

PART_SUFFIX = ".part"
"""Of files that are being written."""


@contextmanager
def atomic_path(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a path to write to, beside a path, and rename what is there when the block ends.

    Where the block fails, nothing is left behind, and what was at the path stays. There is no fsync.

    Args:
        path: of the file to be; its folder must exist.

    Raises:
        OSError: it cannot be renamed.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as name:
    ...     with atomic_path(Path(name) / "result.csv") as part:
    ...         _ = part.write_text("x,y")
    ...     [one.name for one in Path(name).iterdir()]
    ['result.csv']
    """
    path = Path(path)
    part = path.with_name(f".{path.name}.{uuid4().hex}{PART_SUFFIX}")
    try:
        yield part
        os.replace(part, path)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise
