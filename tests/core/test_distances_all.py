"""What holds of every distance in the table: a metric, a scale law, and parameters that are checked."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np
import pytest
from tests.core.property_shapes import Body, complete, inside, shape, with_vertices

from idviewer.core import DISTANCES, Distance, InteriorDistance, parameters_of
from idviewer.core.distances import (
    Choice,
    File,
    Formula,
    Integer,
    Number,
    distance_from,
    missing_parameters,
    parameter_values,
    register_distance,
)

KINDS = pytest.mark.parametrize("kind", DISTANCES)
SHAPES = pytest.mark.parametrize("name", ["random polygon with a hole", "random mesh"])
PARAMETERS = [(kind, name) for kind in DISTANCES for name in parameters_of(DISTANCES[kind])]
EACH_PARAMETER = pytest.mark.parametrize(("kind", "parameter"), PARAMETERS)

NUMBERS = [0.0, -1, -1e-300, math.nan, math.inf, -math.inf, 10**400, np.float64(-1), np.float32("nan")]
STRANGE = [True, np.bool_(True), np.array(1.0), 1j, object, b"1"]
WRONG: dict[type, list[Any]] = {
    Number: [*NUMBERS, *STRANGE, False, "0.5", "", [1.0]],
    Integer: [*NUMBERS[1:], *STRANGE, 10**9, 7.5, 8.0, np.float64(8), "8", "", [8]],
    Choice: [*NUMBERS, *STRANGE, "magic", "x" * 500, "", None, ["heat"]],
    File: [*NUMBERS, *STRANGE, "", " ", [[1.0], [2.0, 3.0]], {}],
    Formula: [*NUMBERS, *STRANGE[:-2], None, ["x"], b"x"],
}
"""Values that no parameter of the kind allows."""


def right(parameter: Any) -> list[Any]:
    """Values that the parameter allows, and what is kept of them."""
    match parameter:
        case Number():
            return [(2, 2.0), (0.5, 0.5), (np.float32(0.5), 0.5), (np.int64(3), 3.0), (Fraction(1, 2), 0.5)]
        case Integer():
            low = parameter.lowest
            return [(low, low), (np.int32(low), low), (np.uint8(low), low), (parameter.highest,) * 2]
        case Choice():
            return [(word, word) for word, _ in parameter.choices]
        case File():
            return [("d.npy", "d.npy")]
        case Formula():
            return [(parameter.example, parameter.example), (np.exp, np.exp)]
    raise TypeError(parameter)


@EACH_PARAMETER
def test_values_that_mean_nothing_are_refused_in_one_line(kind, parameter):
    made = DISTANCES[kind]
    values = WRONG[type(parameters_of(made)[parameter])]
    for value in values:
        for make in (
            lambda value=value: made(**{parameter: value}),
            lambda value=value: distance_from(kind, {parameter: value}),
            lambda value=value: replace(made(), **{parameter: value}),
        ):
            with pytest.raises(ValueError, match=rf"^the ({kind} )?{parameter} must be .*, not ") as error:
                make()
            told = str(error.value)
            assert "\n" not in told
            assert len(told) < 200
            shown = repr(value) if isinstance(value, str) else str(value)
            assert shown[:50] in told


@EACH_PARAMETER
def test_values_that_mean_something_are_kept_as_plain_ones(kind, parameter):
    for value, kept in right(parameters_of(DISTANCES[kind])[parameter]):
        found = getattr(DISTANCES[kind](**{parameter: value}), parameter)
        assert found == kept
        assert type(found) is type(kept)


@EACH_PARAMETER
def test_none_is_allowed_where_it_is_the_default(kind, parameter):
    default = getattr(DISTANCES[kind](), parameter)
    if default is None:
        assert DISTANCES[kind](**{parameter: None}) == DISTANCES[kind]()
    else:
        with pytest.raises(ValueError, match="None"):
            DISTANCES[kind](**{parameter: None})


RATE = Number("Rate", "how often", "r", lambda lambda_2: lambda_2)


def test_a_class_is_checked_however_it_initialises_itself():
    @dataclass(frozen=True)
    class Plain(Distance):
        name: ClassVar[str] = "plain"
        rate: float | None = field(default=None, metadata={"parameter": RATE})

    @dataclass(frozen=True)
    class Forgetful(Plain):
        def __post_init__(self) -> None:
            """Calls nothing of its base's."""

    class Mixed:
        def __post_init__(self) -> None:
            """Comes before the base in the order of classes."""

    @dataclass(frozen=True)
    class WithMixin(Mixed, Plain):
        pass

    class Derived(Plain):
        """No dataclass of its own."""

    @dataclass(frozen=True, init=False)
    class OwnStart(Plain):
        def __init__(self, rate: float | None = None) -> None:
            object.__setattr__(self, "rate", rate)

    for one in (Plain, Forgetful, WithMixin, Derived, OwnStart):
        assert one().rate is None
        assert one(rate=2).rate == 2.0
        for wrong in (-1.0, math.nan, True, "1"):
            with pytest.raises(ValueError, match=r"^the plain rate must be a positive number, not"):
                one(rate=wrong)


def test_what_is_no_distance_is_not_registered():
    class NoDataclass(Distance):
        name, title = "no_dataclass", "No dataclass"

    @dataclass(frozen=True)
    class Nameless(Distance):
        title: ClassVar[str] = "Nameless"

    @dataclass(frozen=True)
    class Loose(Distance):
        name: ClassVar[str] = "loose"
        title: ClassVar[str] = "Loose"
        rate: float | None = field(default=None, metadata={"parameter": "a rate"})

    @dataclass(frozen=True)
    class Second(Distance):
        name: ClassVar[str] = "gps"
        title: ClassVar[str] = "Another GPS"

    before = dict(DISTANCES)
    for kind, part in (
        (NoDataclass, r"NoDataclass: a distance is a dataclass; write @dataclass\(frozen=True\) below"),
        (Nameless, "Nameless: a distance has a name and a title; it lacks 'name'"),
        (Loose, "Loose.rate: its metadata's parameter is no Parameter"),
        (Second, "there are two distances with the name 'gps'"),
    ):
        with pytest.raises((TypeError, ValueError), match=part):
            register_distance(kind)
    assert before == DISTANCES


def test_the_table_is_in_the_order_of_menus():
    assert list(DISTANCES.values()) == sorted(DISTANCES.values(), key=lambda one: (one.menu_order, one.name))
    for name, kind in DISTANCES.items():
        assert (kind.name, parameters_of(kind) is not None) == (name, True)
        assert kind.title
        assert set(kind.dimensions) <= {2, 3}


@pytest.mark.one_is_quick
@SHAPES
@KINDS
def test_it_is_a_metric(name, kind, rng):
    """Non-negative, symmetric, 0 from a point to itself, and no way round is shorter."""
    body = shape(name)
    points = np.concatenate([inside(body, rng, 15), body.vertices[:5]])
    solver = InteriorDistance(body, complete(kind, body.vertices))
    i, j = (axis.ravel() for axis in np.indices((len(points),) * 2))
    apart = solver.distance(points[i], points[j]).reshape(len(points), -1)
    largest = apart.max()
    assert (apart >= 0).all()
    np.testing.assert_allclose(apart, apart.T, rtol=1e-9, atol=1e-12 * largest)
    assert np.diag(apart).max() < 1e-9 * largest
    for third in range(len(points)):
        assert (apart <= apart[:, third, None] + apart[third] + 1e-12 * largest).all()


def scaled(distance: Distance, size: float, lambda_2: float) -> Distance:
    """The distance whose numbers mean the same on a shape so many times as large.

    A number's unit is that of its default, which says how it changes with the size.
    """
    values = {
        name: value * one.default(lambda_2 / size**2) / one.default(lambda_2)
        for name, one in parameters_of(distance).items()
        if isinstance(one, Number) and (value := getattr(distance, name)) is not None
    }
    return replace(distance, **values)


def variants(kind: str, body: Body, lambda_2: float) -> list[Distance]:
    """With all defaults, and with each number away from its default."""
    plain = complete(kind, body.vertices)
    numbers = {name: one for name, one in parameters_of(plain).items() if isinstance(one, Number)}
    return [plain, *(replace(plain, **{name: 3.0 * one.default(lambda_2)}) for name, one in numbers.items())]


@pytest.mark.one_is_quick
@SHAPES
@KINDS
def test_size_changes_it_by_a_factor(name, kind, rng):
    """d(s p, s q) = s^k d(p, q) with one k for all sizes, given numbers in the shape's unit."""
    body = shape(name)
    points = inside(body, rng, 12)
    modes = InteriorDistance(body).spectrum
    for distance in variants(kind, body, float(modes.values[0])):
        plain = InteriorDistance(body, distance).distance(points[:6], points[6:])
        powers = []
        for size in (0.25, 3.0):
            larger = with_vertices(body, size * body.vertices)
            there = scaled(distance, size, float(modes.values[0]))
            found = InteriorDistance(larger, there).distance(size * points[:6], size * points[6:])
            factor = np.median(found / plain)
            np.testing.assert_allclose(found, factor * plain, rtol=1e-6)
            powers.append(math.log(factor) / math.log(size))
        np.testing.assert_allclose(powers[0], powers[1], rtol=1e-6, atol=1e-6)
        assert not distance.is_length or powers[0] == pytest.approx(1.0)


@pytest.mark.one_is_quick
@SHAPES
@KINDS
def test_a_default_that_is_written_out_is_the_same(name, kind, rng):
    body = shape(name)
    points = inside(body, rng, 12)
    plain = InteriorDistance(body, complete(kind, body.vertices))
    lambda_2 = float(plain.spectrum.values[0]) if plain.boundary.distance.spectral else None
    values = parameter_values(plain.boundary.distance, lambda_2)
    numbers = {
        one: values[one] for one, of in parameters_of(DISTANCES[kind]).items() if isinstance(of, Number)
    }
    written = InteriorDistance(body, replace(plain.boundary.distance, **numbers))
    np.testing.assert_allclose(
        written.distance(points[:6], points[6:]), plain.distance(points[:6], points[6:]), rtol=1e-9
    )


@KINDS
def test_what_a_distance_lacks_is_a_file(kind):
    lacking = missing_parameters(DISTANCES[kind]())
    assert lacking == [one for one, of in parameters_of(DISTANCES[kind]).items() if isinstance(of, File)]
    vertices = shape("random polygon").vertices
    assert missing_parameters(complete(kind, vertices)) == []
