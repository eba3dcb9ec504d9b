"""Atomic writes: files that are there as a whole or not at all."""

from __future__ import annotations

import errno
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from uuid import uuid4

PART_SUFFIX = ".part"
"""Of files that are being written."""

ABANDONED_PART_SECONDS = 86400.0
"""After which nobody goes on writing a file: a long table may grow for hours between two writes."""

_PART = re.compile(r"\..+\.[0-9a-f]{32}" + re.escape(PART_SUFFIX))


@contextmanager
def atomic_path(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a path to write to, beside a path, and rename what is there when the block ends.

    Where the block fails, nothing is left behind, and what was at the path stays. There is no fsync.
    What a process that was killed left in the folder a day ago is removed, once in each process.

    Args:
        path: of the file to be; its folder must exist.

    Raises:
        OSError: it cannot be renamed, or no file can have such a name.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as name:
    ...     with atomic_path(Path(name) / "result.csv") as part:
    ...         _ = part.write_text("x,y")
    ...     [one.name for one in Path(name).iterdir()]
    ['result.csv']
    """
    path = Path(path)
    if "\0" in str(path):
        raise OSError(errno.EINVAL, "no file can have this name", str(path).replace("\0", "?"))
    _remove_abandoned(path.parent.absolute())
    part = path.with_name(f".{path.name}.{uuid4().hex}{PART_SUFFIX}")
    try:
        yield part
        os.replace(part, path)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


@lru_cache
def _remove_abandoned(folder: Path) -> None:
    """Remove parts of files that nobody goes on writing."""
    now = time.time()
    with suppress(OSError), os.scandir(folder) as found:
        for one in found:
            if _PART.fullmatch(one.name):
                with suppress(OSError):
                    if now - one.stat(follow_symlinks=False).st_mtime > ABANDONED_PART_SECONDS:
                        os.unlink(one.path)
