"""Mean value weights the slow way: the pseudo-code of Ju, Schaefer and Warren 2005, in extended precision.

Written apart from the library on purpose: angles by arcsine, dihedral cosines, one point and face at a time.
It knows nothing of points on the surface; in a face's plane outside of the face it is 0 / 0.
"""

from __future__ import annotations

import numpy as np

Wide = np.longdouble


def shares(vertices: np.ndarray, faces: np.ndarray, point: np.ndarray) -> np.ndarray:
    """(m, 3) shares of the faces' corners in the weights of one point, off the planes of the faces."""
    offsets = vertices.astype(Wide) - point.astype(Wide)
    distance = np.sqrt((offsets**2).sum(axis=1))
    unit = offsets / distance[:, None]
    result = np.empty((len(faces), 3), dtype=Wide)
    for number, face in enumerate(faces):
        u, d = unit[face], distance[face]
        chord = np.sqrt(((np.roll(u, -1, axis=0) - np.roll(u, 1, axis=0)) ** 2).sum(axis=1))
        theta = 2 * np.arcsin(np.minimum(chord / 2, Wide(1)))  # opposite corner i
        half = theta.sum() / 2
        cosine = (
            2 * np.sin(half) * np.sin(half - theta) / (np.sin(np.roll(theta, -1)) * np.sin(np.roll(theta, 1)))
            - 1
        )
        sine = np.sign(np.linalg.det(u.astype(np.float64))) * np.sqrt(np.maximum(1 - cosine**2, Wide(0)))
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            share = theta[i] - cosine[j] * theta[k] - cosine[k] * theta[j]
            result[number, i] = share / (d[i] * np.sin(theta[j]) * sine[k])
    return result


def weights(vertices: np.ndarray, faces: np.ndarray, point: np.ndarray) -> np.ndarray:
    """(n,) normalised weights of one point off the surface and off the planes of the faces."""
    total = np.zeros(len(vertices), dtype=Wide)
    np.add.at(total, faces, shares(vertices, faces, point))
    return (total / total.sum()).astype(np.float64)
