"""Geodesic distance: lengths of shortest paths along the boundary."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from idviewer.core.distances.classical_mds import ROUNDING, landmark_mds_steps
from idviewer.core.distances.geodesics import Geodesics, landmark_steps
from idviewer.core.distances.parameters import Choice, Integer
from idviewer.core.distances.registry import Basis, Distance, Steps, register_distance
from idviewer.core.distances.spectral import percentage
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum
from idviewer.core.steps import map_steps

ALL_PAIRS, USUAL = 1000, 300
"""Vertices up to which all pairs are taken, and the number of landmarks beyond."""

NOISE = 1e-3
"""With landmarks, directions of smaller eigenvalues (as a share of the largest) are left out: their factor
1 / sqrt(lambda) would magnify what of the other vertices' distances does not embed; see docs/distances.md."""

LANDMARKS = Integer("Landmarks", "vertices whose distances to all others are computed", 4, 2000)
METHODS = (("heat", "Heat method"), ("exact", "Exact (slow)"))
METHOD = Choice("Method", "how geodesics are computed on meshes", METHODS)


@register_distance
@dataclass(frozen=True)
class Geodesic(Distance):
    """Geodesic distance along the boundary, embedded as well as it can be (class 3).

    It has no exact embedding: the positive part of the Gram matrix is taken, and the description says how
    much that leaves out, so the interior distance approximates the geodesic one. Small shapes take all
    pairs of vertices; others landmarks, which the rest is placed by. Source: Rustamov et al. 2009, section
    4; de Silva and Tenenbaum 2004.

    Attributes:
        landmarks: how many; None stands for all vertices of shapes of up to 1,000, and 300 of others. As
            many as vertices, or more, is all pairs.
        method: "heat" or "exact", see `idviewer.core.distances.geodesics.Geodesics`.

    >>> Geodesic(landmarks=2)
    Traceback (most recent call last):
    ValueError: landmarks: it lies between 4 and 2000, not 2
    """

    name: ClassVar[str] = "geodesic"
    title: ClassVar[str] = "Geodesic distance"
    menu_order: ClassVar[int] = 50

    landmarks: int | None = field(default=None, metadata={"parameter": LANDMARKS})
    method: str = field(default="heat", metadata={"parameter": METHOD})

    def __post_init__(self) -> None:
        for name, parameter in (("landmarks", LANDMARKS), ("method", METHOD)):
            value = getattr(self, name)
            try:
                _ = value if value is None else parameter.parse(str(value))
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from None

    def basis_steps(self, shape: Shape, spectrum: Spectrum | None) -> Steps:
        """Landmarks, the distances to them, and their scaling."""
        count = len(shape.vertices)
        wanted = self.landmarks or (count if count <= ALL_PAIRS else USUAL)
        yield 0.0
        walk = landmark_steps(shape, Geodesics(shape, self.method), wanted)
        chosen, distances = yield from map_steps(lambda share: 0.9 * share, walk)
        among = distances[chosen]
        distances[chosen] = 0.5 * (among + among.T)  # the heat method is not quite symmetric
        negligible = ROUNDING if len(chosen) == count else NOISE
        scaling = yield from landmark_mds_steps(np.square(distances), chosen, negligible)
        taken = "all pairs" if len(chosen) == count else f"{len(chosen)} landmarks"
        return Basis(
            scaling.embedding, f"{taken}, {percentage(scaling.discarded)} of the Gram matrix left out"
        )
