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
    """

    name: ClassVar[str] = "euclidean"
    title: ClassVar[str] = "Euclidean distance"
    menu_order: ClassVar[int] = 80

    def basis(self, shape: Shape, spectrum: Spectrum | None) -> Floats:
        """The vertices, about the middle of the bounding box to keep their digits."""
        return shape.vertices - shape.bounds.mean(axis=0)
