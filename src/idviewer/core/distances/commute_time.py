"""Commute time, exact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from idviewer.core.distances.effective_resistance import EffectiveResistance, commute_embedding_steps
from idviewer.core.distances.registry import Basis, Distance, Steps, check_size, register_distance
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum


@dataclass(frozen=True)
class CommuteTimeSettings:
    """Limits of the exact commute time.

    Attributes:
        largest_embedding: vertices of the shapes that a dense embedding is made of. At 4,000 it takes 10 s,
            0.5 GB with the kernels' copy, and 5 ms a sample.
    """

    largest_embedding: int = 4000


COMMUTE_TIME_SETTINGS = CommuteTimeSettings()


@register_distance
@dataclass(frozen=True)
class CommuteTime(Distance):
    """Commute-time distance without truncation: d^2 = z^T L^+ z with z = w(p) - w(q); it has no parameter.

    Pairs of points, fields and the potential take one sparse solve a point, on shapes of any size. Slices
    are sampled from a dense embedding of full rank, which only small shapes have (`CommuteTimeSettings`);
    beyond, `GPS` is the truncated form. The expected length of a random walk there and back is d^2 times
    the sum of all degrees of the graph (Yen et al. 2007). Source: Rustamov et al. 2009, section 4 (class
    2), eq. 2 with A = L^+.

    >>> from idviewer.core import InteriorDistance, Polygon
    >>> square = InteriorDistance(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]), CommuteTime())
    >>> (square.distance([[0, 0]], [[1, 0], [1, 1]]) ** 2).round(12).tolist()
    [0.75, 1.0]
    """

    name: ClassVar[str] = "commute"
    title: ClassVar[str] = "Commute-time distance"
    menu_order: ClassVar[int] = 15
    needs_resolution: ClassVar[bool] = True

    def basis_steps(self, shape: Shape, spectrum: Spectrum | None) -> Steps:
        """Rows of the inverse Cholesky factor of the grounded Laplacian, (n, n - 1), as a generator.

        Args:
            shape: n vertices.
            spectrum: not used.

        Raises:
            DistanceError: the shape has more vertices than a dense embedding may.
        """
        check_size(
            shape,
            COMMUTE_TIME_SETTINGS.largest_embedding,
            "the exact commute time's embedding",
            "take gps, its truncated form, or a shape of fewer vertices",
        )
        return Basis((yield from commute_embedding_steps(shape)))

    def form(self, shape: Shape) -> EffectiveResistance:
        """The quadratic form z^T L^+ z of a shape's Laplacian L, by sparse solves."""
        return EffectiveResistance(shape)
