"""Diffusion distance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.distances.parameters import Number
from idviewer.core.distances.registry import register_distance
from idviewer.core.distances.spectral import Spectral, percentage, require_spectrum
from idviewer.core.spectrum.eigen_solver import SMALLEST_KEPT, Spectrum, paper_cutoff, paper_time

TIME = Number("Time", "how long heat flows, in the shape's unit squared", "t", paper_time, (1 / 8, 64.0))

SMALLEST_WEIGHT = 1e-120
"""Of the first mode: below, squares of distances leave the range of floats."""


@register_distance
@dataclass(frozen=True)
class Diffusion(Spectral):
    """Diffusion distance: the embedding is the diffusion map (exp(-lambda_k t) phi_k)_k.

    Source: Coifman et al. 2005; Rustamov et al. 2009, section 4 (class 1) and appendix.

    Attributes:
        time: diffusion time t in the shape's unit squared; None stands for the paper's 1 / (8 lambda_2).

    >>> Diffusion().cutoff(1.0) == Diffusion(time=0.125).cutoff(1.0)
    True
    >>> Diffusion(time=-1.0)
    Traceback (most recent call last):
    ValueError: the diffusion time must be a positive number, not -1.0
    """

    name: ClassVar[str] = "diffusion"
    title: ClassVar[str] = "Diffusion distance"
    menu_order: ClassVar[int] = 10

    time: float | None = field(default=None, metadata={"parameter": TIME})

    def cutoff(self, lambda_2: float) -> float:
        """The bound below which exp(-lambda t) stays above 1e-6; for long times the paper's."""
        paper = paper_cutoff(lambda_2)
        return paper if self.time is None else max(paper, -math.log(SMALLEST_KEPT) / self.time)

    def transfer_function(self, eigenvalues: Floats) -> Floats:
        """The heat kernel's factors exp(-lambda t) of eigenvalues (k,).

        Source: Rustamov, Lipman and Funkhouser 2009, appendix.

        >>> Diffusion(time=1.0).transfer_function(np.array([0.0, 1.0])).round(3).tolist()
        [1.0, 0.368]
        """
        return np.exp(-eigenvalues * self.resolved_time(float(eigenvalues[0])))

    def resolved_time(self, lambda_2: float) -> float:
        """The time t that is used, in the shape's unit squared; by default the paper's, 1 / (8 lambda_2).

        >>> Diffusion().resolved_time(2.0), Diffusion(time=3.0).resolved_time(2.0)
        (0.0625, 3.0)
        """
        return paper_time(lambda_2) if self.time is None else self.time

    def range_remedy(self, spectrum: Spectrum | None, largest: float) -> str:
        """The time after which even the first mode weighs too little.

        Args:
            spectrum: of the shape, where the distance is spectral.
            largest: of the distances.
        """
        longest = -math.log(SMALLEST_WEIGHT) / float(require_spectrum(spectrum).values[0])
        return (
            f"the diffusion time {self.time:.3g} is too long for this shape; choose one below {longest:.3g}"
        )

    def describe(self, spectrum: Spectrum | None) -> str:
        """Title and time, such as "Diffusion distance, t = 0.0123"; says so where it asks for more modes."""
        known = require_spectrum(spectrum)
        lambda_2 = float(known.values[0])
        time = self.resolved_time(lambda_2)
        words = f"{self.title}, t = {time:.3g}"
        if known.bound < (1.0 - 1e-9) * self.cutoff(lambda_2):
            words += f"; modes left out weigh up to {percentage(math.exp(-known.bound * time))}"
        return words
