"""Arrays that a user gives: handed over in Python, or as .npy files."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import Floats
from idviewer.core.errors import DistanceError


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


def matrix_of(value: str | PathLike[str] | ArrayLike | ArrayInput | None, rows: int, what: str) -> Floats:
    """A real matrix with one row a vertex.

    Args:
        value: the path of a .npy file, or an array.
        rows: number of vertices.
        what: for the error, such as "distances".

    Raises:
        DistanceError: no file is named, or it holds no finite matrix with so many rows.
        OSError: the file cannot be read.

    Returns:
        (rows, k) float64, a copy.

    >>> matrix_of([[1, 2], [3, 4]], 2, "embedding").tolist()
    [[1.0, 2.0], [3.0, 4.0]]
    """
    if value is None:
        raise DistanceError(
            f"no file with the {what} is named; it is a .npy file with one row for each vertex"
        )
    source = as_array_input(value)
    where = Path(source).name if isinstance(source, str) else f"the {what}"
    array = _read(source) if isinstance(source, str) else source.array
    if array.dtype.kind not in "fiu":
        raise DistanceError(f"{where}: its entries are {array.dtype}, not real numbers")
    if array.ndim != 2 or len(array) != rows or array.shape[1] == 0:
        raise DistanceError(
            f"{where}: its shape is {array.shape}; the shape has {rows} vertices and needs one row for each"
        )
    array = array.astype(np.float64)
    wrong = np.argwhere(~np.isfinite(array))
    if len(wrong):
        row, column = wrong[0]
        raise DistanceError(
            f"{where}: {len(wrong)} entries are NaN or infinite, the first in row {row}, column {column}"
        )
    return array


def _read(path: str) -> NDArray[Any]:
    try:
        return np.load(path, allow_pickle=False)
    except (ValueError, EOFError, TypeError) as error:
        raise DistanceError(f"{path}: not a .npy file with a matrix ({error})") from error
