"""Parameters of distances: fields' metadata from which values are checked and menus and options are built."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from idviewer.core.distances.matrix_input import ArrayInput, as_array_input
from idviewer.core.io.array_files import ARRAY_SUFFIXES, split_name

LONGEST_SHOWN_VALUE = 60
"""Characters of a refused value that its error repeats."""


@dataclass(frozen=True)
class Extra:
    """An optional package, and the extra of idviewer that installs it.

    Attributes:
        name: of the extra.
        package: as Python imports it.

    >>> Extra("colours", "no_such_package").installed
    False
    >>> Extra("colours", "no_such_package").remedy
    "needs the package no_such_package: pip install 'idviewer[colours]'"
    """

    name: str
    package: str

    @property
    def installed(self) -> bool:
        """Whether the package is there; it is not imported."""
        return find_spec(self.package) is not None

    @property
    def remedy(self) -> str:
        """The missing package and the command that installs it, as the end of a sentence."""
        return f"needs the package {self.package}: pip install 'idviewer[{self.name}]'"


@dataclass(frozen=True)
class Parameter:
    """Base of all kinds of parameters: a value that shapes a distance.

    Attributes:
        title: for the window.
        help: what it does, in one line without a full stop.
        required: whether a distance can do nothing before it is given.
        shape_specific: whether a value means nothing on another shape.
    """

    title: str
    help: str = ""

    required = False
    shape_specific = False

    @property
    def domain(self) -> str:
        """The values there are, for a line of help."""
        return "TEXT"

    def parse(self, text: str) -> Any:
        """The value that a text on the command line stands for.

        Raises:
            ValueError: it stands for none; whether the value is allowed, `check` tells.
        """
        return text

    def check(self, value: Any) -> Any:
        """The value as a distance keeps it.

        Raises:
            ValueError: it is not allowed; the message, "must be ..., not ...", wants a subject.
        """
        return value


@dataclass(frozen=True)
class Number(Parameter):
    """A positive number, None where the default is meant.

    Attributes:
        symbol: in formulas.
        default: from lambda_2, the first non-zero eigenvalue, to the value that None stands for.
        span: smallest and largest value to offer, as multiples of the default.

    >>> time = Number("Time", "", "t", lambda lambda_2: 1 / lambda_2)
    >>> time.parse("0.5"), time.check(2)
    (0.5, 2.0)
    >>> time.check(float("inf"))
    Traceback (most recent call last):
    ValueError: must be a positive number, not inf
    """

    symbol: str = ""
    default: Callable[[float], float] = lambda lambda_2: 1.0
    span: tuple[float, float] = (0.5, 2.0)

    shape_specific = True

    @property
    def domain(self) -> str:
        """The values there are."""
        return "a positive number"

    def parse(self, text: str) -> float:
        """The text as a float. Raises: ValueError where it is no number."""
        try:
            return float(text)
        except ValueError:
            raise ValueError(f"{text!r} is not a number") from None

    def check(self, value: Any) -> float:
        """The value as a float, a Python or NumPy number. Raises: ValueError unless finite and above 0."""
        try:
            number = float(value) if _is_number(value, numbers.Real) else math.nan
        except OverflowError:
            number = math.inf
        if 0.0 < number < math.inf:
            return number
        raise ValueError(_refusal(self.domain, value))


@dataclass(frozen=True)
class Integer(Parameter):
    """A whole number, None where it is chosen by itself.

    Attributes:
        lowest: the smallest allowed.
        highest: the largest allowed.
        automatic: what None stands for, in words.

    >>> Integer("Landmarks", "", 3, 9).check(12)
    Traceback (most recent call last):
    ValueError: must be a whole number from 3 to 9, not 12
    """

    lowest: int = 0
    highest: int = 100
    automatic: str = "automatic"

    @property
    def domain(self) -> str:
        """The values there are."""
        return f"{self.lowest} to {self.highest}"

    def parse(self, text: str) -> int:
        """The text as an int. Raises: ValueError where it is no whole number."""
        try:
            return int(text)
        except ValueError:
            raise ValueError(f"{text!r} is not a whole number") from None

    def check(self, value: Any) -> int:
        """The value as an int, of Python's or NumPy's. Raises: ValueError where it is none in the range."""
        if _is_number(value, numbers.Integral) and self.lowest <= value <= self.highest:
            return int(value)
        raise ValueError(_refusal(f"a whole number from {self.domain}", value))


@dataclass(frozen=True)
class Choice(Parameter):
    """One of a few words.

    Attributes:
        choices: each word, and its title.
        extras: the extra that a word needs, for those that need one.

    >>> method = Choice("Method", "", (("heat", "Heat"), ("exact", "Exact")))
    >>> method.check("magic")
    Traceback (most recent call last):
    ValueError: must be heat or exact, not 'magic'
    >>> Choice("Method", "", method.choices, (("exact", Extra("exact", "no_such_package")),)).titles
    (('heat', 'Heat'), ('exact', 'Exact, not installed'))
    """

    choices: tuple[tuple[str, str], ...] = ()
    extras: tuple[tuple[str, Extra], ...] = ()

    @property
    def domain(self) -> str:
        """The values there are, and what to install for those that are not."""
        return "; ".join([" or ".join(word for word, _ in self.choices), *self.remedies])

    @property
    def titles(self) -> tuple[tuple[str, str], ...]:
        """Each word, and its title, which says so where what it needs is not installed."""
        missing = self._missing()
        return tuple(
            (word, f"{title}, not installed" if word in missing else title) for word, title in self.choices
        )

    @property
    def remedies(self) -> list[str]:
        """One clause for each word whose package is not installed."""
        return [f"{word} {extra.remedy}" for word, extra in self._missing().items()]

    def _missing(self) -> dict[str, Extra]:
        return {word: extra for word, extra in self.extras if not extra.installed}

    def check(self, value: Any) -> str:
        """The value as one of the words. Raises: ValueError where it is none of them."""
        words = [word for word, _ in self.choices]
        if isinstance(value, str) and value in words:
            return str(value)
        raise ValueError(_refusal(" or ".join(words), value))


@dataclass(frozen=True)
class File(Parameter):
    """A file with an array, or the array itself.

    Attributes:
        content: what is in it, in words.
        suffixes: how its name may end.

    >>> File("Matrix", content="distances", suffixes=(".npy", ".mtx")).check(3)
    Traceback (most recent call last):
    ValueError: must be a .npy or .mtx file with distances, not 3
    """

    content: str = ""
    suffixes: tuple[str, ...] = ARRAY_SUFFIXES

    required = True
    shape_specific = True

    @property
    def domain(self) -> str:
        """The values there are."""
        *others, last = self.suffixes
        return f"a {', '.join(others)} or {last} file with {self.content}"

    def exists(self, value: str) -> bool:
        """Whether there is a file of that path, perhaps with an array's name behind it."""
        return Path(split_name(value)[0]).is_file()

    def check(self, value: Any) -> str | ArrayInput:
        """A path as text, or an array behind its identity, not read yet. Raises: ValueError for others."""
        try:
            found = as_array_input(value)
        except ValueError:  # rows of different lengths
            found = ""
        if not found.strip() if isinstance(found, str) else found.array.ndim == 0:
            raise ValueError(_refusal(self.domain, value))
        return found


@dataclass(frozen=True)
class Formula(Parameter):
    """An expression, which the distance that it belongs to reads, or a function.

    Attributes:
        example: one that works.

    >>> Formula("Filter", example="exp(-x)").check(3)
    Traceback (most recent call last):
    ValueError: must be an expression such as exp(-x), or a function, not 3
    """

    example: str = ""

    @property
    def domain(self) -> str:
        """The values there are."""
        return f"an expression such as {self.example}"

    def check(self, value: Any) -> Any:
        """The value, a text or a function. Raises: ValueError for all else."""
        if isinstance(value, str) or callable(value):
            return value
        raise ValueError(_refusal(f"{self.domain}, or a function", value))


def _is_number(value: Any, kind: type) -> bool:
    """Whether a value is a number of that kind, of Python's or NumPy's; True and False are none."""
    return isinstance(value, kind) and not isinstance(value, bool)


def _refusal(domain: str, value: Any) -> str:
    """Such as "must be a positive number, not -1.0", in one line."""
    shown = repr(value) if isinstance(value, str) else str(value)
    shown = " ".join(shown.split())
    if len(shown) > LONGEST_SHOWN_VALUE:
        shown = f"{shown[: LONGEST_SHOWN_VALUE - 1]}…"
    return f"must be {domain}, not {shown}"
