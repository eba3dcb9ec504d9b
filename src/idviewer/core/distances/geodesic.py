"""Geodesic distance: lengths of shortest paths along the boundary."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from idviewer.core.distances.classical_mds import EIGENVALUE_ROUNDING, landmark_mds_steps
from idviewer.core.distances.geodesic_solvers import EXACT_GEODESICS, Geodesics, landmark_steps
from idviewer.core.distances.parameters import Choice, Integer
from idviewer.core.distances.registry import Basis, Distance, Steps, register_distance
from idviewer.core.distances.spectral import percentage
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum
from idviewer.core.steps import map_steps


@dataclass(frozen=True)
class LandmarkSettings:
    """Default numbers of landmarks, and the part of their embedding that is kept.

    Attributes:
        all_pairs_up_to: vertices of the shapes of which all pairs are taken.
        landmarks_beyond: number of landmarks of larger shapes.
        negligible_eigenvalue: with landmarks, directions of smaller eigenvalues, as a share of the largest,
            are left out: their factor 1 / sqrt(lambda) would magnify what of the other vertices' distances
            does not embed; see docs/distances.md.
    """

    all_pairs_up_to: int = 1000
    landmarks_beyond: int = 300
    negligible_eigenvalue: float = 1e-3


LANDMARK_SETTINGS = LandmarkSettings()

LANDMARKS = Integer("Landmarks", "vertices whose distances to all others are computed", 4, 2000)
METHODS = (("heat", "Heat method"), ("exact", "Exact (slow)"))
METHOD = Choice(
    "Method", "how geodesics are computed on meshes", METHODS, extras=(("exact", EXACT_GEODESICS),)
)


@register_distance
@dataclass(frozen=True)
class Geodesic(Distance):
    """Geodesic distance along the boundary, embedded as well as it can be (class 3).

    It has no exact embedding: the positive part of the Gram matrix is taken, and the description says how
    much that leaves out, so the interior distance approximates the geodesic one. Small shapes take all
    pairs of vertices; others landmarks, which the rest is placed by. Source: Rustamov et al. 2009, section
    4; de Silva and Tenenbaum 2004.

    Attributes:
        landmarks: how many; None stands for all vertices of small shapes (`LandmarkSettings`). As many as
            vertices, or more, is all pairs.
        method: "heat" or "exact", see `Geodesics` in `geodesic_solvers.py`; on meshes "exact" needs the extra
            `exact-geodesics`.

    >>> Geodesic(landmarks=2)
    Traceback (most recent call last):
    ValueError: the geodesic landmarks must be a whole number from 4 to 2000, not 2
    """

    name: ClassVar[str] = "geodesic"
    title: ClassVar[str] = "Geodesic distance"
    menu_order: ClassVar[int] = 50
    is_length: ClassVar[bool] = True
    needs_resolution: ClassVar[bool] = True

    landmarks: int | None = field(default=None, metadata={"parameter": LANDMARKS})
    method: str = field(default="heat", metadata={"parameter": METHOD})

    def basis_steps(self, shape: Shape, spectrum: Spectrum | None) -> Steps:
        """Landmarks, the distances to them, and their embedding by landmark MDS, as a generator.

        Args:
            shape: n vertices.
            spectrum: not used.

        Returns:
            A basis (n, k), and a remark on how many landmarks there are and how much is left out.

        Raises:
            DistanceError: the method's package is not installed, or the method fails on this shape.
        """
        count, settings = len(shape.vertices), LANDMARK_SETTINGS
        wanted = self.landmarks or (count if count <= settings.all_pairs_up_to else settings.landmarks_beyond)
        yield 0.0
        sampling = landmark_steps(shape, Geodesics(shape, self.method), wanted)
        chosen, distances = yield from map_steps(lambda share: 0.9 * share, sampling)
        between_landmarks = distances[chosen]
        # The heat method is not quite symmetric.
        distances[chosen] = 0.5 * (between_landmarks + between_landmarks.T)
        negligible = EIGENVALUE_ROUNDING if len(chosen) == count else settings.negligible_eigenvalue
        scaled = yield from landmark_mds_steps(np.square(distances), chosen, negligible)
        taken = "all pairs" if len(chosen) == count else f"{len(chosen)} landmarks"
        return Basis(scaled.embedding, f"{taken}, {percentage(scaled.discarded)} of the Gram matrix left out")
