"""Bytes of text files to text: UTF-8, and UTF-16 as spreadsheets write it."""

from __future__ import annotations

import codecs

from idviewer.core.io.text import UnreadableError

_TEXT_MARKS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}


def decoded(data: bytes) -> str:
    r"""Decode text by its mark; without one it is UTF-8, or UTF-16 where every other byte is zero.

    Args:
        data: of the file.

    Raises:
        UnreadableError: the data are binary, or neither.

    >>> decoded(b"\xff\xfe0\x00,\x001\x00"), decoded("0,1".encode())
    ('0,1', '0,1')
    """
    encoding = next((name for mark, name in _TEXT_MARKS.items() if data.startswith(mark)), None)
    if encoding is None:
        encoding = _unmarked(data)
    if encoding == "utf-8" and b"\0" in data:
        raise UnreadableError("it holds binary data, not text")
    try:
        text = data.decode(encoding).removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        if encoding != "utf-8":
            raise UnreadableError("not whole UTF-16 text") from None
        raise UnreadableError(f"line {data[: error.start].count(10) + 1}: not UTF-8 text") from None
    if "\0" in text:
        raise UnreadableError("it holds binary data, not text")
    return text


def _unmarked(data: bytes) -> str:
    start = data[:200]
    for first, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        if len(start) > 3 and not any(start[first::2]) and all(start[1 - first :: 2]):
            return encoding
    return "utf-8"
