"""What distances share whose embedding is (f(lambda_k) phi_k)_k."""

from __future__ import annotations

from collections.abc import Hashable
from typing import ClassVar

from idviewer.core.arrays import Floats
from idviewer.core.distances.registry import Distance
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum, paper_cutoff


class Spectral(Distance):
    """A distance whose basis is the eigenvectors; its scale is a function of the eigenvalues."""

    spectral: ClassVar[bool] = True

    def cutoff(self, lambda_2: float) -> float:
        """The paper's, 110.5 lambda_2."""
        return paper_cutoff(lambda_2)

    def basis(self, shape: Shape, spectrum: Spectrum | None) -> Floats:
        """The eigenvectors."""
        return require_spectrum(spectrum).vectors

    @property
    def basis_key(self) -> Hashable:
        """One for all."""
        return "eigenvectors"

    def describe(self, spectrum: Spectrum | None) -> str:
        """Such as "Biharmonic distance, 76 modes"."""
        count = len(require_spectrum(spectrum).values)
        return f"{self.title}, {count} mode{'s' if count > 1 else ''}"


class PowerOfEigenvalues(Spectral):
    """A distance whose embedding is (lambda_k^exponent phi_k)_k, cut off where the paper does."""

    exponent: ClassVar[float]

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """lambda^exponent."""
        return require_spectrum(spectrum).values ** self.exponent


def require_spectrum(spectrum: Spectrum | None) -> Spectrum:
    """The eigenpairs, which must be there."""
    if spectrum is None:
        raise ValueError("a spectral distance needs the shape's eigenpairs")
    return spectrum


def percentage(share: float) -> str:
    """A share in percent, two digits.

    >>> percentage(0.0312), percentage(0.25)
    ('3.1%', '25%')
    """
    return f"{share:.0%}" if share > 0.095 else f"{100.0 * share:.2g}%"
