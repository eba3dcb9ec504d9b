"""GPS distance: the commute time, cut off after some modes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from idviewer.core.distances.registry import register_distance
from idviewer.core.distances.spectral import PowerOfEigenvalues


@register_distance
@dataclass(frozen=True)
class GPS(PowerOfEigenvalues):
    """Distance of the global point signatures (lambda_k^(-1/2) phi_k)_k; it has no parameter.

    With all modes its square is z^T L^+ z with z the difference of two vertices' unit vectors: exactly that
    of `CommuteTime`, no factor between them. The commute time itself is that times the sum of all degrees
    (Yen et al. 2007). The paper's cut-off truncates it.

    It depends on how many modes there are: on a surface the sum diverges logarithmically with resolution.
    Source: Rustamov 2007, "Laplace-Beltrami eigenfunctions for deformation invariant shape representation";
    Rustamov et al. 2009, section 4.

    >>> from idviewer.core import Diffusion
    >>> GPS.exponent, GPS().cutoff(1.0) == Diffusion().cutoff(1.0)
    (-0.5, True)
    """

    name: ClassVar[str] = "gps"
    title: ClassVar[str] = "GPS / truncated commute time"
    menu_order: ClassVar[int] = 20
    exponent: ClassVar[float] = -0.5
