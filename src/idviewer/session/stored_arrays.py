"""Arrays in a file of their own, with checksums: plain numbers that are safe to read, whoever wrote them."""

from __future__ import annotations

import json
import math
import os
import tempfile
import zlib
from collections.abc import Generator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

Arrays = dict[str, NDArray[Any]]
Bytes = NDArray[np.uint8]

MAGIC = b"idviewer arrays 1\n"
PIECE = 2**22
"""Bytes between two checkpoints: a few milliseconds, unless the disk is slow."""

LONGEST_HEADER = 2**20
KINDS = {"<f8": np.float64, "<i8": np.int64, "<i4": np.int32}
UNFINISHED = ".part"
"""Suffix of files that are being written."""


class DamagedError(ValueError):
    """A file that is not what was written; the message ends the sentence "the file ..."."""


def write_steps(
    path: Path, about: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> Generator[None, None, None]:
    """Write arrays beside a path and rename, so that nobody ever finds half of them; yields every few ms.

    Nothing is left behind where it fails or is closed. There is no fsync: what a crash of the system makes of
    the file, its checksums tell.

    Args:
        path: of the file.
        about: what the reader gets to see before the arrays, as JSON.
        arrays: float64, int64 or int32, in rows or columns.

    Raises:
        OSError: it cannot be written.
    """
    entries, raw = [], []
    for name, array in arrays.items():
        order = "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"
        kind = next(key for key, dtype in KINDS.items() if array.dtype == dtype)
        data = np.ascontiguousarray(array.T if order == "F" else array, dtype=kind)
        raw.append(data.reshape(-1).view(np.uint8))
        checksum = yield from checksum_steps(raw[-1])
        entries.append(
            {"name": name, "kind": kind, "shape": array.shape, "order": order, "checksum": checksum}
        )
    head = json.dumps({"about": about, "arrays": entries}).encode()
    numbers = np.array([len(head), zlib.crc32(head)], dtype="<u4").tobytes()
    number, beside = tempfile.mkstemp(UNFINISHED, path.stem, path.parent)
    try:
        with open(number, "wb", buffering=0) as file:
            yield from _put_steps(file, np.frombuffer(MAGIC + numbers + head, dtype=np.uint8))
            for data in raw:
                yield from _put_steps(file, data)
        os.replace(beside, path)
    except BaseException:
        with suppress(OSError):
            os.unlink(beside)
        raise


def _put_steps(file: BinaryIO, data: Bytes) -> Generator[None, None, None]:
    left = data.data
    while left:
        left = left[file.write(left[:PIECE]) :]
        yield


def read_about(file: BinaryIO) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """What a file says of itself and of its arrays.

    Raises:
        DamagedError: it is no such file, not whole, or its header has changed.
        OSError: it cannot be read.
    """
    start = file.read(len(MAGIC) + 8)
    if not start.startswith(MAGIC):
        raise DamagedError("was of another kind")
    length, checksum = np.frombuffer(start[len(MAGIC) :].ljust(8, b"\0"), dtype="<u4").tolist()
    head = file.read(min(length, LONGEST_HEADER))
    if len(head) < length or zlib.crc32(head) != checksum:
        raise DamagedError("was damaged")
    known = json.loads(head)
    size = len(start) + length + sum(_bytes_of(one) for one in known["arrays"])
    if os.fstat(file.fileno()).st_size != size:
        raise DamagedError("was damaged")
    return known["about"], known["arrays"]


def read_steps(file: BinaryIO, entries: list[dict[str, Any]]) -> Generator[float, None, Arrays]:
    """The arrays behind a header; yields the share read every few milliseconds.

    Raises:
        DamagedError: a checksum is another.
        OSError: they cannot be read.
    """
    arrays: Arrays = {}
    total, done = sum(_bytes_of(entry) for entry in entries) or 1, 0
    for entry in entries:
        data, checksum = np.empty(_bytes_of(entry), dtype=np.uint8), 0
        left = data.data
        while left:
            piece = left[:PIECE]
            if _fill(file, piece) < len(piece):
                raise DamagedError("was damaged")
            checksum = zlib.crc32(piece, checksum)
            left, done = left[len(piece) :], done + len(piece)
            yield done / total
        if checksum != entry["checksum"]:
            raise DamagedError("was damaged")
        arrays[entry["name"]] = data.view(entry["kind"]).reshape(entry["shape"], order=entry["order"])
    return arrays


def _fill(file: BinaryIO, piece: memoryview) -> int:
    """Read until a piece is full or the file ends; the number of bytes."""
    done = 0
    while done < len(piece):
        count = file.readinto(piece[done:])  # type: ignore[attr-defined]
        if not count:
            break
        done += count
    return done


def checksum_steps(data: Bytes) -> Generator[Any, None, int]:
    """The checksum of bytes, as it is in the file; yields every few milliseconds."""
    checksum = 0
    for start in range(0, len(data), PIECE):
        checksum = zlib.crc32(data[start : start + PIECE].data, checksum)
        yield
    return checksum


def _bytes_of(entry: dict[str, Any]) -> int:
    return math.prod(entry["shape"]) * np.dtype(KINDS[entry["kind"]]).itemsize
