"""Spectral distances, whose embedding is (f(lambda_k) phi_k)_k: their base classes."""

from __future__ import annotations

from collections.abc import Hashable
from typing import ClassVar

from idviewer.core.arrays import Floats
from idviewer.core.distances.registry import Distance
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum, paper_cutoff


class Spectral(Distance):
    """A distance whose basis is the eigenvectors, and its scale a function of the eigenvalues.

    A kind defines `transfer_function`, and `cutoff` where it wants other modes than the paper's.
    """

    spectral: ClassVar[bool] = True
    needs_resolution: ClassVar[bool] = True

    def cutoff(self, lambda_2: float) -> float:
        """The paper's bound of the eigenvalues, 110.5 lambda_2; source: Rustamov et al. 2009, appendix."""
        return paper_cutoff(lambda_2)

    def basis(self, shape: Shape, spectrum: Spectrum | None) -> Floats:
        """The eigenvectors (n, k), which all spectral distances share.

        Args:
            shape: n vertices; not used.
            spectrum: its eigenpairs.

        Raises:
            ValueError: there are none.
        """
        return require_spectrum(spectrum).vectors

    def transfer_function(self, eigenvalues: Floats) -> Floats:
        """The factor f(lambda_k) of each eigenvector.

        Args:
            eigenvalues: (k,) without 0, in one over the shape's unit squared; the first is lambda_2.

        Returns:
            (k,).
        """
        raise NotImplementedError

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """Factors f(lambda_k) of the eigenvectors, (k,).

        Args:
            spectrum: the shape's eigenpairs.

        Raises:
            ValueError: there are none.
        """
        return self.transfer_function(require_spectrum(spectrum).values)

    @property
    def basis_key(self) -> Hashable:
        """The same key for all spectral distances."""
        return "eigenvectors"

    def describe(self, spectrum: Spectrum | None) -> str:
        """Title and number of modes, such as "Biharmonic distance, 76 modes"."""
        count = len(require_spectrum(spectrum).values)
        return f"{self.title}, {count} mode{'s' if count > 1 else ''}"


class PowerOfEigenvalues(Spectral):
    """A distance whose embedding is (lambda_k^exponent phi_k)_k, cut off where the paper does."""

    exponent: ClassVar[float]

    def transfer_function(self, eigenvalues: Floats) -> Floats:
        """The factors lambda^exponent of eigenvalues (k,).

        >>> import numpy as np
        >>> from idviewer.core import Biharmonic
        >>> Biharmonic().transfer_function(np.array([2.0, 4.0])).tolist()
        [0.5, 0.25]
        """
        return eigenvalues**self.exponent


def require_spectrum(spectrum: Spectrum | None) -> Spectrum:
    """The eigenpairs, which must be there.

    Raises:
        ValueError: they are not.
    """
    if spectrum is None:
        raise ValueError("a spectral distance needs the shape's eigenpairs")
    return spectrum


def percentage(share: float) -> str:
    """A share in percent, two digits.

    >>> percentage(0.0312), percentage(0.25)
    ('3.1%', '25%')
    """
    return f"{share:.0%}" if share > 0.095 else f"{100.0 * share:.2g}%"
