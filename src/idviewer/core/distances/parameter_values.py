"""Values of parameters: what is missing, what defaults stand for, what means nothing on another shape."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from idviewer.core.distances.parameters import Number
from idviewer.core.distances.registry import Distance, parameters_of


def missing_parameters(distance: Distance) -> list[str]:
    """The parameters without which the distance can do nothing, and which are not given.

    >>> from idviewer.core.distances import Diffusion, GivenDistances
    >>> missing_parameters(Diffusion()), missing_parameters(GivenDistances())
    ([], ['matrix'])
    """
    return [
        name
        for name, one in parameters_of(distance).items()
        if one.required and getattr(distance, name) is None
    ]


def parameter_values(distance: Distance, lambda_2: float | None) -> dict[str, Any]:
    """The distance's parameters, defaults worked out, by the name of the field.

    Args:
        distance: of any kind.
        lambda_2: the first non-zero eigenvalue, from which defaults are; None where it is not known.

    Returns:
        Numbers and texts, None where a default is not known.

    >>> from idviewer.core.distances import GPS, Diffusion
    >>> parameter_values(Diffusion(), 2.0), parameter_values(Diffusion(time=1.0), 2.0)
    ({'time': 0.0625}, {'time': 1.0})
    >>> parameter_values(GPS(), 2.0)
    {}
    """
    values = {}
    for name, parameter in parameters_of(distance).items():
        value = getattr(distance, name)
        if value is None and isinstance(parameter, Number) and lambda_2 is not None:
            value = parameter.default(lambda_2)
        values[name] = value if value is None or isinstance(value, int | float | str) else str(value)
    return values


def with_defaults(distance: Distance) -> Distance:
    """The same kind of distance for another shape: what means nothing there is left to its default.

    >>> from idviewer.core.distances import Diffusion
    >>> with_defaults(Diffusion(time=2.0))
    Diffusion(time=None)
    """
    return replace(
        distance, **{name: None for name, one in parameters_of(distance).items() if one.shape_specific}
    )
