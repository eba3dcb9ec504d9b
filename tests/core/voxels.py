"""Surfaces of voxels, as volume software writes them: two triangles between each full and empty one."""

from __future__ import annotations

import numpy as np
from tests.core.shapes import Arrays


def voxel_surface(full: np.ndarray) -> Arrays:
    """The boundary of all voxels that are True, with shared vertices, wound outward."""
    padded = np.pad(full, 1)
    quads = []
    for axis, (b, c) in enumerate(((1, 2), (2, 0), (0, 1))):
        step = np.eye(3, dtype=int)
        for sense in (1, -1):
            empty = padded & ~np.roll(padded, -sense, axis)
            for place in np.argwhere(empty) - 1:
                corner = place + step[axis] * (sense == 1)
                around = [corner, corner + step[b], corner + step[b] + step[c], corner + step[c]]
                quads.append(around if sense == 1 else around[::-1])
    points, index = np.unique(np.array(quads).reshape(-1, 3), axis=0, return_inverse=True)
    index = index.reshape(-1, 4)
    return points.astype(float), index[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def box(*size: int) -> np.ndarray:
    """A grid of full voxels."""
    return np.ones(size, bool)


def emptied(full: np.ndarray, *places: tuple[int, int, int]) -> np.ndarray:
    """The same without some voxels."""
    result = full.copy()
    for place in places:
        result[place] = False
    return result
