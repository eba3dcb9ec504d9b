"""A session as JSON lines: everything the mouse can do, written down and played again without a screen."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import asdict
from typing import Any, TextIO

import numpy as np

from idviewer.core import Distance, Plane, parameters_of
from idviewer.core.distances import distance_from
from idviewer.core.shapes.rays import Ray
from idviewer.session.session import Session


class Recorder:
    """Writes each act on a session as one line.

    Args:
        session: what to listen to.
        stream: where the lines go.
    """

    def __init__(self, session: Session, stream: TextIO) -> None:
        self._session, self._stream = session, stream
        session.acted.connect(self._write)

    def close(self) -> None:
        """Stop listening; the stream stays open."""
        self._session.acted.disconnect(self._write)

    def _write(self, verb: str, arguments: dict[str, Any]) -> None:
        plain = {name: _to_plain(value) for name, value in arguments.items()}
        self._stream.write(json.dumps({"do": verb, **plain}) + "\n")


def replay(lines: Iterable[str], session: Session, settle: Callable[[], None]) -> None:
    """Do again what the lines say.

    Args:
        lines: as a `Recorder` wrote them.
        session: on what.
        settle: waits until the session has nothing left to do; called after each line.

    Raises:
        ValueError: a line that is no act.
    """
    for number, line in enumerate(lines, start=1):
        try:
            act = json.loads(line)
            verb = act.pop("do")
            arguments = {name: _from_plain(name, value) for name, value in act.items()}
            if verb not in ("open", "set", "click", "reshape", "cancel", "resume"):
                raise KeyError(verb)
        except (KeyError, TypeError, AttributeError, ValueError) as error:
            raise ValueError(
                f"line {number} of the recording is no act of a session: {line.strip()[:80]}"
            ) from error
        getattr(session, verb)(**arguments)
        settle()


def _to_plain(value: Any) -> Any:
    if isinstance(value, Plane | Ray):
        return asdict(value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, tuple):
        return [_to_plain(item) for item in value]
    if isinstance(value, Distance):
        return {"name": value.name, **{one: _parameter(value, one) for one in parameters_of(value)}}
    return value


def _parameter(distance: Distance, name: str) -> Any:
    value = getattr(distance, name)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise ValueError(
        f"the {distance.title.lower()}'s {name} was handed over as a Python object and cannot be recorded; "
        "give a file or an expression"
    )


def _from_plain(name: str, value: Any) -> Any:
    if name == "planes":
        return tuple(Plane(tuple(one["origin"]), tuple(one["normal"])) for one in value)
    if name == "ray":
        return Ray(tuple(value["origin"]), tuple(value["direction"]))
    if name == "distance":
        parameters = {key: item for key, item in value.items() if key != "name"}
        return distance_from(value["name"], parameters)
    return tuple(value) if isinstance(value, list) else value
