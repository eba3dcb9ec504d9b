"""The base class of boundary distances, and the table of all of them: for menus and the command line."""

from __future__ import annotations

from abc import ABCMeta
from collections.abc import Generator, Hashable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.distances.parameters import Parameter
from idviewer.core.errors import DistanceError
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum
from idviewer.core.steps import finish

Steps = Generator[float | None, None, "Basis"]
Registered = TypeVar("Registered", bound="type[Distance]")


@dataclass(frozen=True, eq=False)
class Basis:
    """Columns that are sampled inside, one row a vertex.

    Attributes:
        columns: (n, k) one row a vertex; times the distance's scale it is the embedding.
        remark: a note for the scale bar, such as the part that was left out.
    """

    columns: Floats
    remark: str = ""


class QuadraticForm(Protocol):
    """z^T A z without an embedding, for distances that have it cheaper that way."""

    def squares_steps(self, differences: Floats) -> Generator[float, None, Floats]:
        """z^T A z of each row z (p, n) with the sum 0; yields the share done every few milliseconds."""


class CheckedParameters(ABCMeta):
    """Checks the parameters of every new distance, however its class initialises itself."""

    def __call__(cls, *args: Any, **values: Any) -> Any:
        """A new distance; a ValueError names the parameter whose value is not allowed."""
        distance = super().__call__(*args, **values)
        check_parameters(distance)
        return distance


class Distance(metaclass=CheckedParameters):
    """A boundary distance: it embeds the vertices so that distances between them become Euclidean.

    A new one is a frozen dataclass that derives from this, carries the decorator `register_distance`, and
    has either `basis` or `basis_steps`. The embedding of vertex i is basis[i] * scale. Only the basis is
    ever sampled inside, so whatever changes the scale alone (a diffusion time) reuses every sample. A field
    whose metadata holds a `Parameter` gets an option on the command line and a control in the window, and
    its value is checked by the parameter; None is allowed where it is the field's default.

    Raises:
        ValueError: the value of a parameter is not allowed.

    Attributes:
        name: for the command line.
        title: for menus.
        menu_order: place in menus.
        dimensions: of the shapes that it works on.
        spectral: whether it needs eigenpairs.
        needs_resolution: whether the boundary must be fine enough for the modes that count, because distances
            between its vertices or along its edges are wrong otherwise.
        is_length: whether its values are lengths, in the shape's unit.
        of_given_vertices: whether it has values for the vertices of the shape as it was given, and no others.
    """

    __dataclass_fields__: ClassVar[dict[str, Any]]
    name: ClassVar[str]
    title: ClassVar[str]
    menu_order: ClassVar[int] = 1000
    dimensions: ClassVar[tuple[int, ...]] = (2, 3)
    spectral: ClassVar[bool] = False
    needs_resolution: ClassVar[bool] = False
    is_length: ClassVar[bool] = False
    of_given_vertices: ClassVar[bool] = False

    def cutoff(self, lambda_2: float) -> float:
        """Largest eigenvalue that matters, given the first non-zero one (spectral distances only)."""
        return 0.0

    def basis(self, shape: Shape, spectrum: Spectrum | None) -> Floats:
        """The basis (n, k), one row a vertex; times `scale` it is the embedding.

        Args:
            shape: n vertices.
            spectrum: its eigenpairs; None for a distance that is not spectral.

        Raises:
            DistanceError: the distance cannot be computed on this shape.
        """
        return finish(self.basis_steps(shape, spectrum)).columns

    def basis_steps(self, shape: Shape, spectrum: Spectrum | None) -> Steps:
        """`basis` as a generator that yields the share done, or None, every few milliseconds.

        Args:
            shape: n vertices.
            spectrum: its eigenpairs; None for a distance that is not spectral.

        Returns:
            The columns of `basis`, and a remark on them.
        """
        yield from ()  # nothing to wait for
        return Basis(self.basis(shape, spectrum))

    @property
    def basis_key(self) -> Hashable:
        """Distances with equal keys have the same basis on the same shape: their samples are shared."""
        return self

    def scale(self, spectrum: Spectrum | None) -> Floats:
        """Factors (k,) of the columns, or (1,) for all of them; `spectrum` is that of the basis."""
        return np.ones(1)

    def describe(self, spectrum: Spectrum | None) -> str:
        """Name and parameters in words, for a scale bar."""
        return self.title

    def range_remedy(self, spectrum: Spectrum | None, largest: float) -> str:
        """Advice where distances leave the range of floats, as the end of a sentence.

        Args:
            spectrum: of the shape, where the distance is spectral.
            largest: of the distances.
        """
        return "scale the shape to another unit"

    def form(self, shape: Shape) -> QuadraticForm | None:
        """The quadratic form, where there is one; pairs and fields of points then need no embedding."""
        return None

    def squares(self, shape: Shape) -> Floats | None:
        """Squared distances (n, n) between the vertices, where they are given rather than computed."""
        return None


DISTANCES: dict[str, type[Distance]] = {}
"""Every distance by its name, in the order of menus."""


def register_distance(kind: Registered) -> Registered:
    """Enter a class in `DISTANCES`; to be written above `@dataclass(frozen=True)`.

    Raises:
        TypeError: the class is no dataclass, has no name or title, or holds something else than a
            `Parameter` as a field's parameter.
        ValueError: another distance has its name.
    """
    if "__dataclass_params__" not in vars(kind):
        raise TypeError(
            f"{kind.__qualname__}: a distance is a dataclass; write @dataclass(frozen=True) "
            "below @register_distance"
        )
    lacking = [one for one in ("name", "title") if not hasattr(kind, one)]
    if lacking:
        raise TypeError(f"{kind.__qualname__}: a distance has a name and a title; it lacks {lacking[0]!r}")
    for field, parameter in parameters_of(kind).items():
        if not isinstance(parameter, Parameter):
            raise TypeError(f"{kind.__qualname__}.{field}: its metadata's parameter is no Parameter")
    if kind.name in DISTANCES and DISTANCES[kind.name].__qualname__ != kind.__qualname__:
        raise ValueError(f"there are two distances with the name {kind.name!r}")
    DISTANCES[kind.name] = kind
    ordered = sorted(DISTANCES.values(), key=lambda one: (one.menu_order, one.name))
    DISTANCES.clear()
    DISTANCES.update((one.name, one) for one in ordered)
    return kind


def check_dimension(kind: Distance, shape: Shape) -> None:
    """Refuse a shape in whose dimension a kind of distance does not work.

    Raises:
        DistanceError: it does not.
    """
    if shape.dimension not in kind.dimensions:
        where = " and ".join(f"{one}D" for one in kind.dimensions)
        raise DistanceError(
            f"the {kind.title.lower()} works in {where}, and the shape is {shape.dimension}D; choose another"
        )


def check_size(shape: Shape, limit: int, what: str, advice: str) -> None:
    """Refuse shapes of more vertices than a limit, beyond which dense matrices would not fit.

    Args:
        shape: n vertices.
        limit: the largest n.
        what: takes n^2 numbers, for the error.
        advice: what to do instead, for the error.

    Raises:
        DistanceError: there are more.
    """
    count = len(shape.vertices)
    if count > limit:
        raise DistanceError(
            f"{what} takes {8e-9 * count**2:.2g} GB for {count:,} vertices; the limit is {limit:,}: {advice}"
        )


def parameters_of(kind: type[Distance] | Distance) -> dict[str, Parameter]:
    """The parameters of a kind of distance, by the name of the field.

    >>> from idviewer.core.distances import GPS, Diffusion
    >>> [(name, one.symbol) for name, one in parameters_of(Diffusion).items()], parameters_of(GPS)
    ([('time', 't')], {})
    """
    found = ((one.name, one.metadata.get("parameter")) for one in fields(kind))
    return {name: parameter for name, parameter in found if parameter is not None}


def check_parameters(distance: Distance) -> None:
    """Check every parameter's value, and keep it as the parameter wants it kept.

    Raises:
        ValueError: a value is not allowed; one line names the parameter, the value and what is.

    >>> from idviewer.core.distances import Diffusion
    >>> Diffusion(time=True)
    Traceback (most recent call last):
    ValueError: the diffusion time must be a positive number, not True
    """
    for field in fields(distance) if is_dataclass(distance) else ():
        parameter, value = field.metadata.get("parameter"), getattr(distance, field.name)
        if parameter is None or (value is None and field.default is None):
            continue
        try:
            checked = parameter.check(value)
        except ValueError as error:
            subject = field.name if field.name == distance.name else f"{distance.name} {field.name}"
            raise ValueError(f"the {subject} {error}") from None
        object.__setattr__(distance, field.name, checked)


def distance_from(name: str, values: Mapping[str, Any]) -> Distance:
    """The distance of that name with those values of its parameters.

    Raises:
        ValueError: there is no such distance, it has no such parameter, or a value is not allowed.

    >>> distance_from("diffusion", {"time": 2.0})
    Diffusion(time=2.0)
    """
    if name not in DISTANCES:
        raise ValueError(f"there is no such distance; there are: {', '.join(DISTANCES)}")
    unknown = [one for one in values if one not in parameters_of(DISTANCES[name])]
    if unknown:
        has = ", ".join(parameters_of(DISTANCES[name])) or "none"
        raise ValueError(f"{name} has no parameter {unknown[0]!r}; its parameters: {has}")
    return DISTANCES[name](**values)
