"""Arrays kept from one run of the program to the next, and never trusted blindly."""

from __future__ import annotations

from collections.abc import Callable, Generator
from pathlib import Path
from typing import NamedTuple

from idviewer.session.array_files import Arrays, DamagedError, Header, read_steps, write_steps
from idviewer.session.bounded_folder import BoundedFolder

SUFFIX = ".kept"


class Found(NamedTuple):
    """Result of looking for arrays.

    Attributes:
        header: of the file; empty if there is none.
        arrays: None if they are not there, or not those expected.
        complaint: what was wrong with the file that should hold them, to end the sentence "the file ...";
            empty if nothing was.
    """

    header: Header
    arrays: Arrays | None
    complaint: str = ""


class ArrayCache:
    """Files of arrays in a folder of bounded size; several programs may use one at a time.

    No file takes more than half of the limit; those used longest ago give way.

    Args:
        folder: where the files are; it is made when something is stored.
        limit: bytes that all of them may take.
    """

    def __init__(self, folder: Path, limit: int) -> None:
        self._files = BoundedFolder(folder, SUFFIX, limit)

    @property
    def folder(self) -> Path:
        """The folder of the files."""
        return self._files.path

    @property
    def size(self) -> int:
        """Bytes of all files."""
        return self._files.size

    def clear(self) -> int:
        """Delete everything; the number of bytes that this freed. Any thread may call it at any time."""
        return self._files.clear()

    def load_steps(self, stem: str, expected: Callable[[Header], bool]) -> Generator[float, None, Found]:
        """Look for arrays; yields the share read every few milliseconds.

        Args:
            stem: of the file's name.
            expected: whether a header is that of the arrays looked for. It raises a `DamagedError` about one
                that should not be there.
        """
        try:
            header, arrays = yield from read_steps(self._files.file(stem), expected)
        except (FileNotFoundError, NotADirectoryError, PermissionError):
            return Found({}, None)
        except OSError as error:
            return Found({}, None, f"could not be read: {error.strerror}")
        except DamagedError as error:
            return Found({}, None, str(error))
        if arrays is not None:
            self._files.used(stem)
        return Found(header, arrays)

    def store_steps(self, stem: str, header: Header, arrays: Arrays) -> Generator[None, None, None]:
        """Keep arrays; those of that name are replaced. Too many are not kept.

        Raises:
            OSError: they cannot be written.
        """
        size = sum(array.nbytes for array in arrays.values())
        if self._files.takes(size):
            self._files.evict(size)
            yield from write_steps(self._files.file(stem), header, arrays)
