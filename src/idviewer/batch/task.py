"""Task: one shape of a collection, with everything that its result depends on, and what became of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

Status = Literal["computed", "kept", "failed"]

Options = Mapping[str, Any]
"""Plain values by name, as JSON holds them."""


@dataclass(frozen=True)
class Task:
    """One shape of a collection, to be computed by anybody who gets it: it can be pickled.

    Attributes:
        name: of the result's files, without a suffix; no two tasks of a collection have the same.
        path: of the shape's file, absolute.
        options: everything else that the result depends on.
        inputs: further files whose content it depends on.
        labels: columns of the manifest that are no options, for the table.
        settings: options that change no result.
    """

    name: str
    path: Path
    options: Options = field(default_factory=dict)
    inputs: tuple[Path, ...] = ()
    labels: Mapping[str, str] = field(default_factory=dict)
    settings: Options = field(default_factory=dict)


@dataclass(frozen=True)
class Outcome:
    """What became of a task.

    Attributes:
        task: the task.
        status: "computed" now, "kept" from an earlier run, or "failed".
        reason: for which it failed; one line.
        content: the result of one that did not, as its JSON file holds it.
        seconds: that it took.
        worker: which process did it, for the events.
    """

    task: Task
    status: Status
    reason: str = ""
    content: Mapping[str, Any] = field(default_factory=dict)
    seconds: float = 0.0
    worker: str = ""


Reserve = Callable[[float], None]
"""Called with bytes of memory before they are needed; waits until they are there, or raises MemoryError."""


class Made(NamedTuple):
    """Result of a task.

    Attributes:
        result: what goes into its JSON file, the same wherever it is computed: plain values, no NaN.
        files: names of its other files, by what they are.
        seconds: that stages took, by their names.
    """

    result: dict[str, Any]
    files: dict[str, str]
    seconds: dict[str, float]


Work = Callable[[Task, Path, Reserve], Made]
"""A function of a module, which other processes can import: computes a task and writes all files but the JSON
one into a folder, each as a whole or not at all."""
