"""Any spectral filter of the user's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.distances.expressions import Expression
from idviewer.core.distances.parameters import Formula
from idviewer.core.distances.registry import register_distance
from idviewer.core.distances.spectral import Spectral, percentage, require_spectrum
from idviewer.core.errors import DistanceError
from idviewer.core.spectrum.eigen_solver import Spectrum

HEAT_KERNEL = "exp(-lambda / (8 * lambda_2))"
FILTER = Formula("Filter", "f of the eigenvalue lambda, at least 0; lambda_2 is the first one", HEAT_KERNEL)

NEGLIGIBLE_WEIGHT = 1e-6
"""Left-out modes that weigh less are not worth a word; as in the paper's appendix."""


@register_distance
@dataclass(frozen=True)
class SpectralFilter(Spectral):
    """The embedding is (f(lambda_k) phi_k)_k, with any f that is finite and not negative.

    Diffusion is exp(-lambda t), GPS lambda ** -0.5, biharmonic 1 / lambda. The modes are those below the
    paper's cut-off; the description says how much the first one left out weighs.

    Attributes:
        filter: an expression in lambda (or x) and lambda_2, the first non-zero eigenvalue, such as
            "exp(-lambda / (8 * lambda_2))" or "1 / (1 + lambda)"; or a function from the eigenvalues (k,)
            to as many numbers.

    >>> SpectralFilter("1 / (1 + lambda)").filter
    '1 / (1 + lambda)'
    >>> SpectralFilter("lambda.real")
    Traceback (most recent call last):
    ValueError: "lambda.real" at character 1 is no part of an expression; there are numbers, + - * / **, \
exp, log, sqrt, brackets, lambda (or x) and lambda_2
    """

    name: ClassVar[str] = "filter"
    title: ClassVar[str] = "Spectral filter"
    menu_order: ClassVar[int] = 40

    filter: str | Callable[[Floats], Floats] = field(default=HEAT_KERNEL, metadata={"parameter": FILTER})

    def __post_init__(self) -> None:
        if isinstance(self.filter, str):
            Expression(self.filter)

    def transfer_function(self, eigenvalues: Floats) -> Floats:
        """The factors f(lambda) of eigenvalues (k,).

        Raises:
            DistanceError: f is negative, infinite or NaN at an eigenvalue, zero at all, or of another shape.

        >>> SpectralFilter("1 / (1 + lambda)").transfer_function(np.array([1.0, 3.0])).tolist()
        [0.5, 0.25]
        """
        return self._check_weights(self._at(eigenvalues, float(eigenvalues[0])), eigenvalues)

    def _at(self, values: Floats, lambda_2: float) -> Floats:
        if isinstance(self.filter, str):
            return Expression(self.filter)(values, lambda_2)
        return np.asarray(self.filter(values.copy()), dtype=np.float64)

    def _check_weights(self, found: Floats, values: Floats) -> Floats:
        if found.shape != values.shape:
            raise DistanceError(
                f"{self._subject}: gives {found.shape} numbers for eigenvalues of shape {values.shape}"
            )
        wrong = np.flatnonzero(~(np.isfinite(found) & (found >= 0.0)))
        if len(wrong):
            first = wrong[0]
            raise DistanceError(
                f"{self._subject}: is {found[first]:.3g} at lambda = {values[first]:.6g}; "
                "a filter is finite and not negative at every eigenvalue"
            )
        if not found.any():
            raise DistanceError(f"{self._subject}: is 0 at every eigenvalue, so all distances would be 0")
        return found

    @property
    def _subject(self) -> str:
        if isinstance(self.filter, str):
            return f"the filter {self.filter}"
        return f"the filter {getattr(self.filter, '__name__', self.filter)}"

    def range_remedy(self, spectrum: Spectrum | None, largest: float) -> str:
        """Advice to write another factor before the filter.

        Args:
            spectrum: of the shape, where the distance is spectral.
            largest: of the distances.
        """
        size = "small" if largest < 1.0 else "large"
        return f"{self._subject} is too {size}; a factor before it changes the unit of distances alone"

    def describe(self, spectrum: Spectrum | None) -> str:
        """Title, filter and number of modes; and how much the first mode left out weighs."""
        known = require_spectrum(spectrum)
        shown = self._subject.removeprefix("the filter ")
        words = f"{self.title} {shown}, {len(known.values)} modes"
        if not np.isfinite(known.bound):
            return words
        beyond = self._at(np.array([known.bound]), float(known.values[0])).ravel()[:1]
        heaviest = self.scale(known).max()
        if len(beyond) and beyond[0] > NEGLIGIBLE_WEIGHT * heaviest:
            words += f"; the first left out weighs {percentage(float(beyond[0] / heaviest))}"
        return words
