"""Arrays with a header in one file, NumPy's .npz: plain numbers that are safe to read, whoever wrote them."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO
from zipfile import ZipFile

import numpy as np
from numpy.lib.format import read_array
from numpy.typing import NDArray

from idviewer.core.io import atomic_path
from idviewer.core.steps import beside, map_steps

Arrays = dict[str, NDArray[Any]]
Header = dict[str, Any]

HEADER = "header"
"""Name of the array that holds it, and the names of the others, as JSON."""

ZIP_MAGIC = b"PK"


class DamagedError(ValueError):
    """A file that is not what was written; the message ends the sentence "the file ..."."""


def write_steps(
    path: Path, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> Generator[None, None, None]:
    """Write arrays so that nobody ever finds half of them; yields every few milliseconds.

    Nothing is left behind where it fails or is closed. There is no fsync: what a crash of the system makes of
    the file, its checksums tell.

    Args:
        path: of the file.
        header: what the reader gets to see before the arrays; JSON can hold it.
        arrays: of numbers, by name.

    Raises:
        OSError: it cannot be written.
    """
    content = {HEADER: np.array(json.dumps([header, list(arrays)])), **arrays}
    with atomic_path(path) as part, open(part, "xb") as file:
        yield from beside(partial(_save, file, content))


def _save(file: BinaryIO, content: Arrays) -> None:
    np.savez(file, allow_pickle=False, **content)


def read_steps(
    path: Path, expected: Callable[[Header], bool]
) -> Generator[float, None, tuple[Header, Arrays | None]]:
    """Read the header and, if they are what is expected, the arrays; yields the share read.

    Args:
        path: of the file.
        expected: whether a header is that of the arrays looked for; the others are not read.

    Raises:
        DamagedError: it is no such file, or not as it was written (each array has a checksum).
        OSError: it cannot be read.
    """
    with open(path, "rb", buffering=0) as file:
        try:
            if file.read(len(ZIP_MAGIC)) != ZIP_MAGIC:
                raise DamagedError("was of another kind")
            with ZipFile(file) as archive:
                header, names = json.loads(str(_array(archive, HEADER)))
                if not expected(header):
                    return header, None
                size, arrays = path.stat().st_size, {}
                for name in names:
                    reading = beside(partial(_array, archive, name))
                    arrays[name] = yield from map_steps(lambda _: file.tell() / size, reading)
                    yield file.tell() / size
                return header, arrays
        except (OSError, DamagedError):
            raise
        except Exception as error:  # NumPy, zipfile and json have many for bytes that make no sense
            raise DamagedError("was damaged") from error


def _array(archive: ZipFile, name: str) -> NDArray[Any]:
    """An array with its checksum verified, which `np.load` does only where the array's header is sound."""
    with archive.open(f"{name}.npy") as member:
        array = read_array(member, allow_pickle=False)
        if member.read(1):
            raise DamagedError("was damaged")
        return array
