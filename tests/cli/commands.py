"""Points, options and answers for the tests of the command line."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

INSIDE, OUTSIDE = "-0.3,0.1,0.2", "0.3,4,0.2"
QUICK = ("--distance", "euclidean")
"""Needs no eigenpairs; for tests to which the kind of distance does not matter."""


class Answer(NamedTuple):
    status: int
    out: str
    err: str


Run = Callable[..., Answer]


def refused(answer: Answer) -> str:
    """The one line of an error."""
    assert answer.status == 2
    assert answer.out == ""
    assert answer.err.startswith("idviewer: ")
    assert answer.err.count("\n") == 1
    return answer.err
