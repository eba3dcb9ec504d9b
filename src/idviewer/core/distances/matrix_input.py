"""Arrays that a user gives, in Python or as files, with one row for each vertex of a shape's file."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, Ints
from idviewer.core.errors import DistanceError
from idviewer.core.io.array_files import ARRAY_SUFFIXES, read_array
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.shape import Shape

ROUNDING_OF_EQUAL_ROWS = 1e-6
"""Rows of merged vertices may differ by this share of the largest entry: single precision's rounding."""

GAPS_OF_EQUAL_ROWS = 10.0
"""And, where vertices were merged across a gap, by so many times the gap's share of the diagonal."""


@dataclass(frozen=True, eq=False)
class ArrayInput:
    """An array that compares by identity, so that what holds it can be compared and hashed."""

    array: Floats

    def __repr__(self) -> str:
        return f"<array {self.array.shape}>"


def as_array_input(value: str | PathLike[str] | ArrayLike | ArrayInput) -> str | ArrayInput:
    """A path as text, or a read-only copy of an array; it is looked at only when it is needed.

    >>> as_array_input(Path("d.npy")), as_array_input([[0.0, 1.0], [1.0, 0.0]])
    ('d.npy', <array (2, 2)>)
    """
    if isinstance(value, ArrayInput):
        return value
    if isinstance(value, str | PathLike):
        return str(value)
    array = np.array(value)
    array.setflags(write=False)
    return ArrayInput(array)


@dataclass(frozen=True)
class RowsOfVertices:
    """What an array with a row for each vertex is for, and how its rows count.

    Attributes:
        what: it holds, for errors, such as "distances".
        counting: "file" if its rows are the file's vertices, "shape" if they are those of the shape.
        both: whether its columns count as its rows do.

    >>> from idviewer.core import Polygon
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> RowsOfVertices("embedding").of([[1], [2], [3], [4]], square).tolist()
    [[1.0], [2.0], [3.0], [4.0]]
    """

    what: str
    counting: str = "file"
    both: bool = False

    def of(self, value: str | PathLike[str] | ArrayLike | ArrayInput | None, shape: Shape) -> Floats:
        """A real matrix with one row for each vertex of a shape.

        Rows count as the shape's file does: they are carried through whatever merged, dropped and reordered
        its vertices. Rows of vertices that were merged are to agree, to six digits.

        Args:
            value: the path of a file, or an array.
            shape: n vertices.

        Raises:
            DistanceError: no file is named, it cannot be understood, or it holds no finite matrix with a row
                for each vertex of the file.
            OSError: the file cannot be read.

        Returns:
            (n, k) float64, a copy.
        """
        if value is None:
            raise DistanceError(
                f"no file with the {self.what} is named; it holds one row for each vertex "
                f"({', '.join(ARRAY_SUFFIXES)})"
            )
        source = as_array_input(value)
        where = Path(source).name if isinstance(source, str) else f"the {self.what}"
        check = _RowCount(shape, self.counting, where)
        if isinstance(source, str):
            try:
                array = read_array(source, check, check.fits)
            except UnreadableError as error:
                raise DistanceError(f"{where}: {error}") from error
        else:
            array = source.array
        if array.dtype.kind not in "fiu":
            raise DistanceError(f"{where}: its entries are {array.dtype}, not real numbers")
        check(array.shape)
        array = array.astype(np.float64)
        if self.both and array.shape[1] != len(array):
            raise DistanceError(
                f"{where}: its shape is {array.shape}; distances between all pairs of vertices are n x n"
            )
        if check.by_file:
            return _carried(array, check, self.both)
        _refuse_infinite(array, np.arange(len(array)), np.arange(array.shape[1]), where)
        return array


class _RowCount:
    """Tells whether an array has the right number of rows, and which row is whose."""

    def __init__(self, shape: Shape, counting: str, where: str) -> None:
        self.shape, self.where = shape, where
        self.numbering = shape.numbering
        self.by_file = counting == "file" and not self.numbering.trivial

    @property
    def _counts(self) -> tuple[int, ...]:
        numbering = self.numbering
        if not self.by_file:
            return (len(numbering.origins),)
        # A polygon's points may be counted without those that only close its loops.
        return len(numbering.became), len(numbering.became) - len(numbering.closing)

    def fits(self, rows: int) -> bool:
        """Whether an array may have so many rows."""
        return rows in self._counts

    def __call__(self, size: tuple[int, ...]) -> None:
        """Refuse an array that has not a row for each vertex; it may be far too large to be read."""
        if len(size) == 2 and self.fits(size[0]) and size[1] > 0:
            return
        count, shape_count = self._counts[0], len(self.numbering.origins)
        if not self.by_file:
            raise DistanceError(
                f"{self.where}: its shape is {_text(size)}; the shape has {count} vertices and needs one row "
                "for each"
            )
        became = f"of which {_fate(self.numbering.merged, self.numbering.dropped)}"
        if size and size[0] == shape_count:
            raise DistanceError(
                f"{self.where}: its {size[0]} rows are as many as the shape's vertices by now, but its file "
                f"has {count}, {became}; give one row for each of the {count}, or say counting=shape"
            )
        raise DistanceError(
            f"{self.where}: its shape is {_text(size)}; the shape's file has {count} vertices ({became}) and "
            "needs one row for each"
        )

    def places(self, rows: int) -> tuple[Ints, Ints]:
        """The vertex (rows,) of each row, -1 for none, and the row (n,) of each vertex."""
        numbering = self.numbering
        if rows != len(numbering.became):
            numbering = numbering.without_closing()
        return numbering.became, numbering.origins


def _fate(merged: int, dropped: int) -> str:
    """Such as "3 were merged with others and 1 was dropped"."""
    parts = [
        f"{count:,} {'was' if count == 1 else 'were'} {fate}"
        for count, fate in ((merged, "merged with others"), (dropped, "dropped"))
        if count
    ]
    return " and ".join(parts) or "the order was changed"


def _text(size: tuple[int, ...]) -> str:
    return str(tuple(int(length) for length in size))


def _refuse_infinite(array: Floats, rows: Ints, columns: Ints, where: str) -> None:
    """Refuse an array with NaN or infinite entries in some rows and columns."""
    wrong = np.argwhere(~np.isfinite(array[np.ix_(rows, columns)]))
    if len(wrong):
        row, column = rows[wrong[0][0]], columns[wrong[0][1]]
        raise DistanceError(
            f"{where}: {len(wrong)} entries are NaN or infinite, the first in row {row}, column {column}"
        )


def _carried(array: Floats, count: _RowCount, both: bool) -> Floats:
    """The rows (and columns) of an array in the order of the shape's vertices."""
    became, origins = count.places(len(array))
    made = int(np.count_nonzero(origins < 0))
    if made:
        raise DistanceError(
            f"{count.where}: {made:,} of the shape's vertices were made by a repair or a refinement, and "
            "have no rows; write that shape to a file, and give one row for each vertex of it"
        )
    # Rows of vertices that are not in the shape may hold anything: their distances are often infinite.
    kept = np.flatnonzero(became >= 0)
    columns = kept if both else np.arange(array.shape[1])
    _refuse_infinite(array, kept, columns, count.where)
    _refuse_disagreement(array, (kept, columns), origins[became[kept]], count)
    return array[np.ix_(origins, origins)] if both else array[origins]


def _refuse_disagreement(array: Floats, used: tuple[Ints, Ints], firsts: Ints, count: _RowCount) -> None:
    """Refuse rows of merged vertices that differ by more than rounding, and than the gap between them.

    Args:
        array: as given.
        used: the rows and columns that count.
        firsts: for each of these rows, the first that was merged into the same vertex.
        count: of the shape.
    """
    rows, columns = used
    largest = float(np.abs(array[np.ix_(rows, columns)]).max(initial=0.0))
    gap = GAPS_OF_EQUAL_ROWS * count.numbering.gap / count.shape.diagonal
    for row, first in zip(rows.tolist(), firsts.tolist(), strict=True):
        if row == first:
            continue
        off = np.abs(array[row, columns] - array[first, columns])
        if off.max() > (ROUNDING_OF_EQUAL_ROWS + gap) * largest:
            column = int(columns[off.argmax()])
            raise DistanceError(
                f"{count.where}: rows {first} and {row} belong to vertices that were merged into one, but "
                f"differ in column {column}: {array[first, column]:.6g} and {array[row, column]:.6g}"
            )
