"""Boundary distances: each embeds the vertices so that distances between them become Euclidean."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from idviewer.core.mesh import Mesh
from idviewer.core.spectrum import SMALLEST_KEPT, Spectrum, paper_cutoff, paper_time

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Parameter:
    """A number that shapes a distance: metadata of a field that is None where the default is meant.

    Attributes:
        title: in words.
        symbol: in formulas.
        default: from lambda_2, the first non-zero eigenvalue, to the value that None stands for.
        span: smallest and largest value to offer, as multiples of the default.
    """

    title: str
    symbol: str
    default: Callable[[float], float]
    span: tuple[float, float]


class Distance(Protocol):
    """What the interior needs from a boundary distance.

    The embedding of vertex i is basis[i] * scale. Only the basis is ever sampled inside, so whatever
    changes the scale alone (a diffusion time) reuses every sample.
    """

    __dataclass_fields__: ClassVar[dict[str, Any]]
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


TIME = Parameter("Time", "t", paper_time, (1 / 8, 64.0))


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

    time: float | None = field(default=None, metadata={"parameter": TIME})

    def __post_init__(self) -> None:
        if self.time is not None and not (math.isfinite(self.time) and self.time > 0.0):
            raise ValueError(f"the diffusion time must be a positive number, not {self.time}")

    def cutoff(self, lambda_2: float) -> float:
        """The bound below which exp(-lambda t) stays above 1e-6; for long times the paper's."""
        paper = paper_cutoff(lambda_2)
        return paper if self.time is None else max(paper, -math.log(SMALLEST_KEPT) / self.time)

    def basis(self, mesh: Mesh, spectrum: Spectrum | None) -> Floats:
        """The eigenvectors."""
        return _needed(spectrum).vectors

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """exp(-lambda t)."""
        return np.exp(-_needed(spectrum).values * self.resolved_time(_needed(spectrum)))

    def resolved_time(self, spectrum: Spectrum) -> float:
        """The time t that is used, in the mesh's unit squared."""
        return paper_time(float(spectrum.values[0])) if self.time is None else self.time

    def describe(self, spectrum: Spectrum | None) -> str:
        """Such as "Diffusion distance, t = 0.0123"; says so where the time asks for further modes."""
        known = _needed(spectrum)
        time = self.resolved_time(known)
        words = f"{self.title}, t = {time:.3g}"
        if known.bound < (1.0 - 1e-9) * self.cutoff(float(known.values[0])):
            words += f"; modes left out weigh up to {_percentage(math.exp(-known.bound * time))}"
        return words


class _PowerOfEigenvalues:
    """A distance whose embedding is (lambda_k^exponent phi_k)_k, cut off where the paper does."""

    title: ClassVar[str]
    exponent: ClassVar[float]
    spectral: ClassVar[bool] = True

    def cutoff(self, lambda_2: float) -> float:
        """The paper's, 110.5 lambda_2."""
        return paper_cutoff(lambda_2)

    def basis(self, mesh: Mesh, spectrum: Spectrum | None) -> Floats:
        """The eigenvectors."""
        return _needed(spectrum).vectors

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """lambda^exponent."""
        return _needed(spectrum).values ** self.exponent

    def describe(self, spectrum: Spectrum | None) -> str:
        """Such as "Biharmonic distance, 76 modes"."""
        count = len(_needed(spectrum).values)
        return f"{self.title}, {count} mode{'s' if count > 1 else ''}"


@dataclass(frozen=True)
class GPS(_PowerOfEigenvalues):
    """Distance of the global point signatures (lambda_k^(-1/2) phi_k)_k; it has no parameter.

    With all modes its square is the commute time between two vertices up to a factor, z^T L^+ z with z the
    difference of their unit vectors; the paper's cut-off truncates that. It depends on how many modes
    there are: on a surface the sum diverges logarithmically with resolution. Source: Rustamov 2007,
    "Laplace-Beltrami eigenfunctions for deformation invariant shape representation"; for the commute time
    Yen et al. 2007, and Rustamov et al. 2009, section 4.

    >>> GPS.exponent, GPS().cutoff(1.0) == Diffusion().cutoff(1.0)
    (-0.5, True)
    """

    name: ClassVar[str] = "gps"
    title: ClassVar[str] = "GPS / commute-time distance"
    exponent: ClassVar[float] = -0.5


@dataclass(frozen=True)
class Biharmonic(_PowerOfEigenvalues):
    """Biharmonic distance: the embedding is (phi_k / lambda_k)_k; it has no parameter.

    Its sum converges with resolution: each mode beyond the paper's cut-off weighs less than 1 % of the
    first. With all modes its square is g^T M g, where L g = z, g has mean 0 (1^T M g = 0), and z is the
    difference of two vertices' unit vectors. Source: Lipman, Rustamov and Funkhouser 2010, "Biharmonic
    distance".

    >>> Biharmonic.exponent, Biharmonic().cutoff(1.0) == Diffusion().cutoff(1.0)
    (-1.0, True)
    """

    name: ClassVar[str] = "biharmonic"
    title: ClassVar[str] = "Biharmonic distance"
    exponent: ClassVar[float] = -1.0


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


def _percentage(share: float) -> str:
    """A share in percent, two digits."""
    return f"{share:.0%}" if share > 0.095 else f"{100.0 * share:.2g}%"


DISTANCES: dict[str, type[Distance]] = {kind.name: kind for kind in (Diffusion, GPS, Biharmonic, Euclidean)}
"""Every distance by its name; menus and the command line are built from it."""


def parameters_of(kind: type[Distance] | Distance) -> dict[str, Parameter]:
    """What may be set of a kind of distance, by the name of the field.

    >>> [(name, one.symbol) for name, one in parameters_of(Diffusion).items()], parameters_of(GPS)
    ([('time', 't')], {})
    """
    found = ((one.name, one.metadata.get("parameter")) for one in fields(kind))
    return {name: parameter for name, parameter in found if parameter is not None}


def values_of(distance: Distance, lambda_2: float) -> dict[str, float]:
    """The distance's parameters, defaults worked out, by the name of the field.

    >>> values_of(Diffusion(), 2.0), values_of(Diffusion(time=1.0), 2.0), values_of(GPS(), 2.0)
    ({'time': 0.0625}, {'time': 1.0}, {})
    """
    given = {name: getattr(distance, name) for name in parameters_of(distance)}
    return {
        name: parameter.default(lambda_2) if given[name] is None else given[name]
        for name, parameter in parameters_of(distance).items()
    }


def with_defaults(distance: Distance) -> Distance:
    """The same kind of distance, its parameters left to their defaults.

    >>> with_defaults(Diffusion(time=2.0))
    Diffusion(time=None)
    """
    return replace(distance, **dict.fromkeys(parameters_of(distance)))
