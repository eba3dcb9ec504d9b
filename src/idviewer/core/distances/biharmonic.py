"""Biharmonic distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from idviewer.core.distances.registry import register_distance
from idviewer.core.distances.spectral import PowerOfEigenvalues


@register_distance
@dataclass(frozen=True)
class Biharmonic(PowerOfEigenvalues):
    """Biharmonic distance: the embedding is (phi_k / lambda_k)_k; it has no parameter.

    Its sum converges with resolution: each mode beyond the paper's cut-off weighs less than 1 % of the
    first. With all modes its square is g^T M g, where L g = z, g has mean 0 (1^T M g = 0), and z is the
    difference of two vertices' unit vectors. Source: Lipman, Rustamov and Funkhouser 2010, "Biharmonic
    distance".

    >>> from idviewer.core import Diffusion
    >>> Biharmonic.exponent, Biharmonic().cutoff(1.0) == Diffusion().cutoff(1.0)
    (-1.0, True)
    """

    name: ClassVar[str] = "biharmonic"
    title: ClassVar[str] = "Biharmonic distance"
    menu_order: ClassVar[int] = 30
    exponent: ClassVar[float] = -1.0
