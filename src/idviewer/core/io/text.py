"""Readers of mesh files: bytes in, polygons out. They check the file, not the mesh.

trimesh's readers are not used: they take truncated STL files for empty ones, glTF buffers that are too short
for whole ones, fans and sparse or normalised values for what they are not. A guard against that has to decode
what the reader decodes. A reader raises ValueError (in its own words where it can) on anything but a whole,
consistent file.
"""

from __future__ import annotations

import codecs
from collections.abc import Sequence

import numpy as np

from idviewer.core.arrays import Floats, Ints

Tokens = Sequence[bytes]

_MARKS = (  # that of UTF-32 begins with that of UTF-16
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


class UnreadableError(ValueError):
    """A file that cannot be read; the message tells its owner what is wrong with it."""


def floats(tokens: Tokens) -> Floats:
    """Convert tokens to float64.

    Raises:
        UnreadableError: a token is no number; the message names the first.

    >>> floats([b"1", b"2.5"]).tolist()
    [1.0, 2.5]
    """
    try:
        return np.array(list(map(float, tokens)), dtype=np.float64)
    except ValueError:
        raise UnreadableError(f"{_shown(tokens, float)} stands where a number belongs") from None


def integers(tokens: Tokens) -> Ints:
    """Convert tokens to int64.

    Raises:
        UnreadableError: a token is no whole number; the message names the first.

    >>> integers([b"1", b"2"]).tolist()
    [1, 2]
    """
    try:
        return np.array(list(map(int, tokens)), dtype=np.int64)
    except (ValueError, OverflowError):
        raise UnreadableError(f"{_shown(tokens, int)} stands where a vertex number belongs") from None


def _shown(tokens: Tokens, kind: type[int] | type[float]) -> str:
    for token in tokens:
        try:
            np.array(kind(token), dtype=np.int64 if kind is int else np.float64)
        except (ValueError, OverflowError):
            return ascii(token[:20].decode("latin-1")) + ("..." if len(token) > 20 else "")
    return "something else"


def as_text(data: bytes) -> bytes:
    r"""The text of a file in UTF-8 and without a mark of byte order; UTF-16 and UTF-32 are turned into it.

    Args:
        data: of the file. Without a mark, every other byte of UTF-16 must be 0, as in plain English.

    Raises:
        UnreadableError: it is cut in the middle of a letter, or holds binary data.

    >>> as_text("\ufeffOFF".encode("utf-16-be")), as_text(b"OFF\xe9")
    (b'OFF', b'OFF\xe9')
    """
    coding = next((coding for mark, coding in _MARKS if data.startswith(mark)), "")
    if not coding and b"\0" in data[:64]:
        coding = _unmarked(data)
    if coding:
        try:
            data = data.decode(coding).encode()
        except UnicodeDecodeError as error:
            raise UnreadableError(f"truncated or damaged: it is no whole {coding.upper()}") from error
    data = data.removeprefix(codecs.BOM_UTF8)
    if b"\0" in data:
        raise UnreadableError("it holds binary data, not text")
    return data


def _unmarked(data: bytes) -> str:
    """UTF-16 without a mark, by where the first bytes are 0; else nothing."""
    low, high = data[:64:2], data[1:64:2]
    if high and 0 not in low and not any(high):
        return "utf-16-le"
    return "utf-16-be" if high and 0 not in high and not any(low) else ""


def text_lines(data: bytes) -> list[bytes]:
    r"""Split a text file into lines, without comments (#) and blank ones; see `as_text`.

    Raises:
        UnreadableError: the data is binary.

    >>> text_lines(b"OFF # a remark\n\n3 1 0\n")
    [b'OFF ', b'3 1 0']
    """
    data = as_text(data)
    lines = data.splitlines()
    if b"#" in data:
        lines = [line.partition(b"#")[0] for line in lines]
    return [line for line in lines if line and not line.isspace()]


def missing(what: str, promised: int, found: int) -> UnreadableError:
    """The error for a file that does not hold what its header promises.

    Args:
        what: is missing, in the plural.
        promised: number of them in the header.
        found: number of them in the file; where it is no smaller, the file holds more.

    >>> str(missing("faces", 4, 3))
    'truncated: it announces 4 faces and holds 3'
    """
    if found < promised:
        return UnreadableError(f"truncated: it announces {promised:,} {what} and holds {found:,}")
    return UnreadableError(f"wrong counts: it announces {promised:,} {what} and holds more")
