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


Given = str | ArrayInput | None


def given(value: str | PathLike[str] | ArrayLike | ArrayInput | None) -> Given:
    """A path as text, or an array held; it is looked at only when it is needed."""
    if value is None or isinstance(value, ArrayInput):
        return value
    if isinstance(value, str | PathLike):
        return str(value)
    array = np.array(value)
    array.setflags(write=False)
    return ArrayInput(array)


def matrix_of(value: Given, rows: int, what: str) -> Floats:
    """A real matrix with one row a vertex.

    Args:
        value: as `given` returns it.
        rows: number of vertices.
        what: for the error, such as "distances".

    Raises:
        DistanceError: no file is named, or it holds no finite matrix with so many rows.
        OSError: the file cannot be read.
    """
    if value is None:
        raise DistanceError(
            f"no file with the {what} is named; it is a .npy file with one row for each vertex"
        )
    where = Path(value).name if isinstance(value, str) else f"the {what}"
    array = _read(value) if isinstance(value, str) else value.array
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
