"""Files of numbers: NumPy's .npy and .npz, MatrixMarket and text. Nothing in them is ever run."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import numpy as np
import scipy.io
from numpy.typing import NDArray

from idviewer.core.arrays import Floats
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.text_tables import COMMA_NUMBER, TextTable, table_of, text_of

ARRAY_SUFFIXES = (".npy", ".npz", ".csv", ".txt", ".mtx")
"""Suffixes of such files, for dialogs; what a file holds is told by its content."""

PICKLES = (".pkl", ".pickle", ".joblib", ".pt", ".pth")
PICKLE_BEGINNING = re.compile(rb"\x80[\x02-\x05]|c[a-z_.]+\n|\([dl]p")

NAMED_ARRAYS = 8
"""So many arrays of an archive are named in a message."""

SAMPLE_LINES = 40
"""Lines of a text that tell how its columns are separated."""

Check = Callable[[tuple[int, ...]], None]
"""Refuses an array of a wrong shape by an exception, before its values are read."""


def split_name(source: str) -> tuple[str, str | None]:
    """The path of a file, and the name of an array in it where one is given behind a colon.

    Args:
        source: such as "d.npz:distances".

    >>> split_name("d.npz:distances"), split_name("d.npy")
    (('d.npz', 'distances'), ('d.npy', None))
    """
    path, colon, name = source.rpartition(":")
    if colon and name and not Path(source).exists() and Path(path).suffix:
        return path, name
    return source, None


def read_array(source: str, check: Check, heading_fits: Callable[[int], bool]) -> NDArray[Any]:
    """Read the array in a file; its content tells the kind.

    Args:
        source: path of the file, in an archive with the array's name behind a colon.
        check: is called with the array's shape before its values are read, where that can be known.
        heading_fits: whether an array has so many rows; then one row more is one with the columns' numbers.

    Raises:
        UnreadableError: it holds no array of numbers, or several of which none is named.
        OSError: it cannot be read.

    Returns:
        Its entries, of any type of numbers; unchecked but for `check`.
    """
    path, name = split_name(source)
    with open(path, "rb") as file:
        beginning = file.read(512)
        file.seek(0)
        if Path(path).suffix.lower() in PICKLES or PICKLE_BEGINNING.match(beginning):
            raise UnreadableError(
                "a pickle, which can run any program and is not opened; "
                "save the numbers alone, with numpy.save"
            )
        if beginning.startswith(b"PK\x03\x04"):
            return _from_archive(file, name, check)
        if name is not None:
            raise UnreadableError(f"it is no archive of arrays, and has none named {name!a}")
        if beginning.startswith(b"\x93NUMPY"):
            return _npy(file, check)
        if beginning.startswith(b"%%MatrixMarket"):
            return _matrix_market(path, check)
        if Path(path).suffix.lower() in (".npy", ".npz"):
            raise UnreadableError(f"not a whole {Path(path).suffix.lower()} file; save it again")
        if beginning.startswith((b"\x1f\x8b", b"BZh", b"\xfd7zXZ", b"\x89HDF", b"MATLAB")):
            raise UnreadableError(f"not one of {', '.join(ARRAY_SUFFIXES)}; save it as one of these")
        return _text(file.read(), heading_fits)


def _npy(file: IO[bytes], check: Check) -> NDArray[Any]:
    """The array in a stream of .npy data."""
    try:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version[0] == 1 else np.lib.format.read_array_header_2_0
        shape, _, kind = read(file)
        if kind.hasobject:
            raise UnreadableError(
                "it holds pickled Python objects, which can run any program and are not opened; "
                "save it as an array of numbers"
            )
        check(shape)
        file.seek(0)
        return np.lib.format.read_array(file, allow_pickle=False)
    except UnreadableError:
        raise
    except (ValueError, EOFError, TypeError, MemoryError, zipfile.BadZipFile) as error:
        raise UnreadableError(f"not a whole .npy file ({_first_line(error)})") from error


def _from_archive(file: IO[bytes], name: str | None, check: Check) -> NDArray[Any]:
    """The one array of an archive, or the one of that name."""
    try:
        archive = zipfile.ZipFile(file)
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        raise UnreadableError(f"not a whole .npz file ({_first_line(error)})") from error
    with archive:
        members = archive.namelist()
        arrays = [member.removesuffix(".npy") for member in members if member.endswith(".npy")]
        if any(member.endswith(".pkl") for member in members):
            raise UnreadableError(
                "it holds a pickle, which can run any program and is not opened; "
                "save the numbers alone, with numpy.save"
            )
        if name is None and len(arrays) > 1:
            raise UnreadableError(
                f"it holds {len(arrays)} arrays: {_named(arrays)}; "
                f"name one behind a colon, as {Path(str(file.name)).name}:{arrays[0]}"
            )
        if not arrays:
            raise UnreadableError("it holds no array")
        if name is not None and name not in arrays:
            raise UnreadableError(f"it holds no array named {name!a}; there are: {_named(arrays)}")
        try:
            with archive.open(f"{arrays[0] if name is None else name}.npy") as member:
                array = _npy(member, check)
                if member.read(1):  # at the end its checksum is compared
                    raise UnreadableError("not a whole .npz file (more follows than its header announces)")
                return array
        except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError) as error:
            raise UnreadableError(f"not a whole .npz file ({_first_line(error)})") from error


def _named(names: list[str]) -> str:
    return ", ".join(ascii(name)[1:-1] for name in names[:NAMED_ARRAYS]) + (
        ", ..." if len(names) > NAMED_ARRAYS else ""
    )


def _matrix_market(path: str, check: Check) -> NDArray[Any]:
    try:
        rows, columns, _, form, field, _ = scipy.io.mminfo(path)
        if field == "pattern":
            raise UnreadableError("it tells which entries there are, and not their values")
        check((rows, columns))
        found = scipy.io.mmread(path)
    except UnreadableError:
        raise
    except (ValueError, OverflowError, MemoryError, StopIteration) as error:
        raise UnreadableError(f"not a whole MatrixMarket file ({_first_line(error)})") from error
    if form == "array":
        return np.asarray(found)
    between = int(np.count_nonzero(found.row != found.col))
    if rows == columns and between < rows * (rows - 1):
        raise UnreadableError(
            f"it lists {between:,} of the {rows * (rows - 1):,} entries off the diagonal, "
            "and the others would count as 0; write all of them"
        )
    return np.asarray(found.toarray())


def _text(data: bytes, heading_fits: Callable[[int], bool]) -> Floats:
    """The matrix in a text; headings and a column that numbers the rows are passed over."""
    text = text_of(data)
    if not text.strip():
        raise UnreadableError("the file is empty")
    sample = table_of("\n".join(text.splitlines()[:SAMPLE_LINES]))
    if sample.width > 1 and sample.heading == [] and '"' not in text and "%" not in text and "//" not in text:
        quick = _quick(text, sample)
        if quick is not None:
            return _without_numbering(quick, heading_fits)
    return _without_numbering(_slow(table_of(text)), heading_fits)


def _quick(text: str, sample: TextTable) -> Floats | None:
    """The same by NumPy's reader, which is faster by far; None where it finds something amiss."""
    if sample.decimal_comma:
        text = text.replace(",", ".")
    try:
        mark = None if sample.separator == " " else sample.separator
        return np.loadtxt(io.StringIO(text), delimiter=mark, comments="#", ndmin=2)
    except ValueError:
        return None


def _slow(table: TextTable) -> Floats:
    if not table.rows:
        raise UnreadableError("it holds no numbers")
    rows, lines = table.rows, table.lines
    blank_corner = rows[0][0] == "" and len(rows) > 1  # a heading of numbers above a column of numbers
    if blank_corner:
        rows, lines = rows[1:], lines[1:]
    first = 1 if blank_corner or _names_rows(table) else 0
    numbers = [[table.number(cell) for cell in row[first:]] for row in rows]
    for row, cells, line in zip(numbers, rows, lines, strict=True):
        if None in row:
            cell = cells[first + row.index(None)]
            remark = "; decimal commas need another mark between columns" if COMMA_NUMBER.match(cell) else ""
            raise UnreadableError(f"line {line}: {cell[:20]!a} is not a number{remark}")
    return np.array(numbers, dtype=np.float64).reshape(len(rows), -1)


def _names_rows(table: TextTable) -> bool:
    """Whether the first column holds the rows' names or, by its own name, their numbers."""
    if table.width < 2:
        return False
    called = table.heading[0].strip().lower() if len(table.heading) == table.width else None
    return called in ("", "id", "index", "vertex", "vertex_id", "no", "nr", "name") or all(
        table.number(row[0]) is None and row[0] for row in table.rows
    )


def _without_numbering(array: Floats, heading_fits: Callable[[int], bool]) -> Floats:
    """Without a first row that only counts the columns, as pandas writes it, and a column that counts rows.

    Raises:
        UnreadableError: the first column may be such a count, or may not.
    """
    rows, columns = array.shape
    if heading_fits(rows - 1) and not heading_fits(rows) and np.array_equal(array[0], np.arange(columns)):
        array, rows = array[1:], rows - 1
    counts = columns > 1 and rows > 2 and np.array_equal(np.diff(array[:, 0]), np.ones(rows - 1))
    if counts and array[0, 0] in (0.0, 1.0):
        if columns == rows + 1:
            return array[:, 1:]
        if columns != rows:
            raise UnreadableError(
                "its first column counts the rows; leave it out, or give it the name id in a first line"
            )
    return array


def _first_line(error: BaseException) -> str:
    words = (str(error) or type(error).__name__).splitlines()[0]
    return "".join(letter if letter.isprintable() else "?" for letter in words)[:100]
