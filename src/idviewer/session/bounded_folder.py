"""A folder of files that may go at any time; those used longest ago give way to new ones."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from idviewer.core.io import PART_SUFFIX

LARGEST_FILE = 0.5
"""Of the limit: a larger file would drive out too many others."""

ABANDONED_SECONDS = 3600.0
"""After which nobody goes on writing a file."""


class _Entry(NamedTuple):
    used: float
    size: int
    path: Path


class BoundedFolder:
    """Files with one suffix in a folder, no more bytes in all than a limit; several programs may share it.

    Args:
        path: of the folder; it is made when it is needed.
        suffix: of the files, with its dot; others are left alone, but for those that were never finished.
        limit: in bytes.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as name:
    ...     folder = BoundedFolder(Path(name), ".kept", 1000)
    ...     for stem in "abc":
    ...         folder.evict(400)
    ...         _ = folder.file(stem).write_bytes(bytes(400))
    ...         os.utime(folder.file(stem), (ord(stem), ord(stem)))
    ...     [path.name for path in sorted(folder.path.iterdir())], folder.size
    (['b.kept', 'c.kept'], 800)
    """

    def __init__(self, path: Path, suffix: str, limit: int) -> None:
        self.path, self._suffix, self.limit = path, suffix, limit

    def file(self, stem: str) -> Path:
        """The path where the file of that name is, or would be."""
        return self.path / f"{stem}{self._suffix}"

    def used(self, stem: str) -> None:
        """Note that a file was of use."""
        with suppress(OSError):
            os.utime(self.file(stem))

    def takes(self, size: int) -> bool:
        """Whether a file of so many bytes may be put here."""
        return size <= LARGEST_FILE * self.limit

    def evict(self, size: int) -> None:
        """Make the folder, and delete what was used longest ago until so many bytes may be added.

        Raises:
            OSError: the folder cannot be made.
        """
        self.path.mkdir(parents=True, exist_ok=True)
        entries = sorted(self._entries())
        total = sum(entry.size for entry in entries) + size
        for entry in entries:
            forgotten = entry.path.suffix == PART_SUFFIX and entry.used < time.time() - ABANDONED_SECONDS
            if (total > self.limit and entry.path.suffix != PART_SUFFIX) or forgotten:
                total -= _delete(entry)

    def clear(self) -> int:
        """Delete all files but those that are being written; the number of bytes that this freed."""
        stale = time.time() - ABANDONED_SECONDS
        return sum(
            _delete(entry)
            for entry in self._entries()
            if entry.path.suffix != PART_SUFFIX or entry.used < stale
        )

    @property
    def size(self) -> int:
        """Bytes of all files."""
        return sum(entry.size for entry in self._entries())

    def _entries(self) -> list[_Entry]:
        entries = []
        try:
            with os.scandir(self.path) as found:
                for one in found:
                    # Another program may delete it meanwhile.
                    with suppress(OSError):
                        if Path(one.name).suffix in (self._suffix, PART_SUFFIX) and one.is_file():
                            status = one.stat()
                            entries.append(_Entry(status.st_mtime, status.st_size, Path(one.path)))
        except OSError:  # there is no folder yet, or none that may be looked into
            return []
        return entries


def _delete(entry: _Entry) -> int:
    """The number of bytes freed."""
    try:
        entry.path.unlink()
    except OSError:
        return 0
    return entry.size
