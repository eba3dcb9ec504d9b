"""Distances and coordinates by their names on the command line, and the help on all: from the registries."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from idviewer.cli.options import DistanceOptions
    from idviewer.core import Distance
    from idviewer.core.distances import Parameter
    from idviewer.core.spectrum import Refine

HELP_WIDTH = 78
"""Of the help, in characters."""


class ChosenDistance(NamedTuple):
    """A distance as it is asked for.

    Attributes:
        distance: on the boundary.
        coordinates: the name of those that carry it inside.
        refine: how the boundary is refined.
    """

    distance: Distance
    coordinates: str
    refine: Refine


def distance_of(options: DistanceOptions) -> Distance:
    """The distance of that name, with those parameters.

    Raises:
        ValueError: there is no such distance or parameter, or a value means nothing.
        FileNotFoundError: there is no such file.
    """
    from idviewer.core import DISTANCES, parameters_of
    from idviewer.core.distances import File, missing_parameters

    name = options.distance
    if name not in DISTANCES:
        raise ValueError(f"--distance {name}: there is no such distance; there are: {', '.join(DISTANCES)}")
    parameters, values = parameters_of(DISTANCES[name]), {}
    for option, parameter, text in _settings(options):
        if parameter not in parameters:
            raise ValueError(f"{option}: {name} has no {parameter}; {_alternatives(name, parameter)}")
        values[parameter] = _value(option, parameters[parameter], text)
        try:
            made = DISTANCES[name](**values)
        except ValueError as error:
            raise ValueError(f"{option}: {error}") from error
        one = parameters[parameter]
        if isinstance(one, File) and not one.exists(text):
            raise FileNotFoundError(f"{option}: there is no file {text}")
    made = DISTANCES[name](**values)
    for parameter in missing_parameters(made):
        needs = parameters[parameter].domain
        raise ValueError(f"--distance {name}: it needs {needs}; add --set {parameter}=FILE")
    return made


def chosen_distance(options: DistanceOptions) -> ChosenDistance:
    """The distance of that name, with its parameters, coordinates, and the refinement of the boundary.

    Raises:
        ValueError: there is no such distance, parameter or kind of coordinates, or a value means nothing.
        FileNotFoundError: there is no such file.
    """
    from idviewer.core import COORDINATES

    distance = distance_of(options)
    if options.coordinates not in COORDINATES:
        raise ValueError(
            f"--coordinates {options.coordinates}: there are no such coordinates; "
            f"there are: {', '.join(COORDINATES)}"
        )
    return ChosenDistance(distance, options.coordinates, refinement_of(options.refine))


def refinement_of(text: str) -> Refine:
    """What --refine says: a word, or a length.

    Raises:
        ValueError: it says neither.
    """
    from idviewer.core.spectrum import checked_refinement

    try:
        return checked_refinement(text)
    except ValueError as error:
        raise ValueError(f"--refine {text}: {error}") from None


def _settings(options: DistanceOptions) -> list[tuple[str, str, str]]:
    """Settings: the option as written, the parameter's name, the value's text."""
    settings = []
    for text in options.set:
        name, equals, value = text.partition("=")
        if not equals:
            raise ValueError(f"--set {text}: write NAME=VALUE, such as --set time=0.1")
        settings.append((f"--set {text}", name.strip(), value))
    if options.time is not None:
        settings.append((f"--time {options.time:g}", "time", repr(options.time)))
    return settings


def _value(option: str, parameter: Parameter, text: str) -> Any:
    try:
        return parameter.parse(text)
    except ValueError as error:
        raise ValueError(f"{option}: {error}") from error


def _alternatives(name: str, parameter: str) -> str:
    """Advice what else to write than a parameter that the distance does not have."""
    from idviewer.core import DISTANCES, parameters_of

    others = [other for other, kind in DISTANCES.items() if parameter in parameters_of(kind)]
    if others:
        return f"leave it out, or take --distance {', '.join(others)}"
    return f"its parameters: {', '.join(parameters_of(DISTANCES[name])) or 'none'}"


def distances_help() -> str:
    """Every distance with its parameters, and all coordinates, for the end of a verb's help."""
    from idviewer.core import COORDINATES, DISTANCES, parameters_of

    lines = ["Distances (--distance NAME) and their parameters (--set NAME=VALUE):"]
    for name, kind in DISTANCES.items():
        lines.append(f"  {name:<13}{kind.title}")
        for parameter, one in parameters_of(kind).items():
            told = f"{parameter}: {one.help}; {one.domain}"
            lines += wrap(told, HELP_WIDTH, initial_indent=" " * 17, subsequent_indent=" " * 19)
    lines.append("Coordinates (--coordinates NAME):")
    lines += [f"  {name:<17}{kind.title}" for name, kind in COORDINATES.items()]
    return "\n".join(lines)
