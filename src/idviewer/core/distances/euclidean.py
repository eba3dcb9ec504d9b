"""Straight-line distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from idviewer.core.arrays import Floats
from idviewer.core.distances.registry import Distance, register_distance
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum


@register_distance
@dataclass(frozen=True)
class Euclidean(Distance):
    """Straight-line distance: the vertices are their own embedding, so the interior reproduces |p - q|.

    A check of the whole chain, and the distance to compare with. Source: Rustamov et al. 2009, section 5.

    >>> from idviewer.core import interior_distance
    >>> square = [[0, 0], [4, 0], [4, 4], [0, 4]]
    >>> interior_distance(square, [[1, 1]], [[1, 3]], Euclidean()).round(12).tolist()
    [2.0]
    """

    name: ClassVar[str] = "euclidean"
    title: ClassVar[str] = "Euclidean distance"
    menu_order: ClassVar[int] = 80
    is_length: ClassVar[bool] = True

    def basis(self, shape: Shape, spectrum: Spectrum | None) -> Floats:
        """The vertices (n, dimension), about the middle of the bounding box to keep their digits.

        Args:
            shape: n vertices.
            spectrum: not used.
        """
        return shape.vertices - shape.bounds.mean(axis=0)
