"""Boundary distances: each embeds the vertices so that distances between them become Euclidean."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from idviewer.core.mesh import Mesh
from idviewer.core.spectrum import SMALLEST_KEPT, Spectrum, paper_cutoff

Floats = NDArray[np.float64]


class Distance(Protocol):
    """What the interior needs from a boundary distance.

    The embedding of vertex i is basis[i] * scale. Only the basis is ever sampled inside, so whatever
    changes the scale alone (a diffusion time) reuses every sample.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    spectral: ClassVar[bool]

    def cutoff(self, lambda_2: float) -> float:
        """Largest eigenvalue that matters, given the first non-zero one (spectral distances only)."""

    def basis(self, mesh: Mesh, spectrum: Spectrum | None) -> Floats:
        """(n, k) one row a vertex."""

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """(k,) factor of each column, or (1,) for all of them."""

    def describe(self, spectrum: Spectrum | None) -> str:
        """Name and parameters in words, for a scale bar."""


@dataclass(frozen=True)
class Diffusion:
    """Diffusion distance: the embedding is the diffusion map (exp(-lambda_k t) phi_k)_k.

    Source: Coifman et al. 2005; Rustamov et al. 2009, section 4 (class 1) and appendix.

    Attributes:
        time: diffusion time t in the mesh's unit squared; None stands for the paper's 1 / (8 lambda_2).

    >>> Diffusion().cutoff(1.0) == Diffusion(time=0.125).cutoff(1.0)
    True
    >>> Diffusion(time=-1.0)
    Traceback (most recent call last):
    ValueError: the diffusion time must be a positive number, not -1.0
    """

    name: ClassVar[str] = "diffusion"
    title: ClassVar[str] = "Diffusion distance"
    spectral: ClassVar[bool] = True

    time: float | None = None

    def __post_init__(self) -> None:
        if self.time is not None and not (math.isfinite(self.time) and self.time > 0.0):
            raise ValueError(f"the diffusion time must be a positive number, not {self.time}")

    def cutoff(self, lambda_2: float) -> float:
        """The bound below which exp(-lambda t) stays above 1e-6."""
        return paper_cutoff(lambda_2) if self.time is None else -math.log(SMALLEST_KEPT) / self.time

    def basis(self, mesh: Mesh, spectrum: Spectrum | None) -> Floats:
        """The eigenvectors."""
        return _needed(spectrum).vectors

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """exp(-lambda t)."""
        return np.exp(-_needed(spectrum).values * self.resolved_time(_needed(spectrum)))

    def resolved_time(self, spectrum: Spectrum) -> float:
        """The time t that is used, in the mesh's unit squared."""
        return 1.0 / (8.0 * float(spectrum.values[0])) if self.time is None else self.time

    def describe(self, spectrum: Spectrum | None) -> str:
        """Such as "Diffusion distance, t = 0.0123"."""
        return f"{self.title}, t = {self.resolved_time(_needed(spectrum)):.3g}"


@dataclass(frozen=True)
class Euclidean:
    """Straight-line distance: the vertices are their own embedding, so the interior reproduces |p - q|.

    A check of the whole chain, and the distance to compare with. Source: Rustamov et al. 2009, section 5.
    """

    name: ClassVar[str] = "euclidean"
    title: ClassVar[str] = "Euclidean distance"
    spectral: ClassVar[bool] = False

    def cutoff(self, lambda_2: float) -> float:
        """No eigenpairs are needed."""
        return 0.0

    def basis(self, mesh: Mesh, spectrum: Spectrum | None) -> Floats:
        """The vertices, about the middle of the bounding box to keep their digits."""
        return mesh.vertices - mesh.bounds.mean(axis=0)

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """One."""
        return np.ones(1)

    def describe(self, spectrum: Spectrum | None) -> str:
        """The title; there are no parameters."""
        return self.title


def _needed(spectrum: Spectrum | None) -> Spectrum:
    if spectrum is None:
        raise ValueError("a spectral distance needs the mesh's eigenpairs")
    return spectrum


DISTANCES: dict[str, type[Distance]] = {kind.name: kind for kind in (Diffusion, Euclidean)}
"""Every distance by its name; menus and the command line are built from it."""
