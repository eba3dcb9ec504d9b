"""What may be set of a distance: fields' metadata from which the command line and the window are built."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Parameter:
    """Anything that shapes a distance.

    Attributes:
        title: in words.
        help: what it does, in one line without a full stop.
    """

    title: str
    help: str = ""

    needed = False
    """Whether a distance can do nothing before it is given."""

    of_shape = False
    """Whether a value means nothing on another shape."""

    def parse(self, text: str) -> Any:
        """The value that a text stands for; a ValueError says what is wrong."""
        return text

    def in_words(self) -> str:
        """What may be written, for a line of help."""
        return "TEXT"


@dataclass(frozen=True)
class Number(Parameter):
    """A positive number, None where the default is meant.

    Attributes:
        symbol: in formulas.
        default: from lambda_2, the first non-zero eigenvalue, to the value that None stands for.
        span: smallest and largest value to offer, as multiples of the default.

    >>> Number("Time", "", "t", lambda lambda_2: 1 / lambda_2).parse("0.5")
    0.5
    """

    symbol: str = ""
    default: Callable[[float], float] = lambda lambda_2: 1.0
    span: tuple[float, float] = (0.5, 2.0)

    of_shape = True

    def parse(self, text: str) -> float:
        """A finite number."""
        try:
            return float(text)
        except ValueError:
            raise ValueError(f"{text!r} is not a number") from None

    def in_words(self) -> str:
        """For a line of help."""
        return "a positive number"


@dataclass(frozen=True)
class Integer(Parameter):
    """A whole number, None where it is chosen by itself.

    Attributes:
        lowest, highest: what is offered.
        automatic: what None stands for, in words.

    >>> Integer("Landmarks", "", 3, 9).parse("12")
    Traceback (most recent call last):
    ValueError: it lies between 3 and 9, not 12
    """

    lowest: int = 0
    highest: int = 100
    automatic: str = "automatic"

    def parse(self, text: str) -> int:
        """A whole number in the range."""
        try:
            value = int(text)
        except ValueError:
            raise ValueError(f"{text!r} is not a whole number") from None
        return self.checked(value)

    def checked(self, value: int) -> int:
        """The value, if it lies in the range."""
        if not self.lowest <= value <= self.highest:
            raise ValueError(f"it lies between {self.lowest} and {self.highest}, not {value}")
        return value

    def in_words(self) -> str:
        """For a line of help."""
        return f"{self.lowest} to {self.highest}"


@dataclass(frozen=True)
class Choice(Parameter):
    """One of a few words.

    Attributes:
        choices: each word, and its title.

    >>> Choice("Method", "", (("heat", "Heat"), ("exact", "Exact"))).parse("magic")
    Traceback (most recent call last):
    ValueError: there is no 'magic'; there are: heat, exact
    """

    choices: tuple[tuple[str, str], ...] = ()

    def parse(self, text: str) -> str:
        """One of the words."""
        words = [word for word, _ in self.choices]
        if text not in words:
            raise ValueError(f"there is no {text!r}; there are: {', '.join(words)}")
        return text

    def in_words(self) -> str:
        """For a line of help."""
        return " or ".join(word for word, _ in self.choices)


@dataclass(frozen=True)
class File(Parameter):
    """A file to be read.

    Attributes:
        suffix: how its name ends.
        content: what is in it, in words.
    """

    suffix: str = ".npy"
    content: str = ""

    needed = True
    of_shape = True

    def parse(self, text: str) -> str:
        """The path."""
        if not text.strip():
            raise ValueError("no file is named")
        return text

    def in_words(self) -> str:
        """For a line of help."""
        return f"a {self.suffix} file with {self.content}"


@dataclass(frozen=True)
class Formula(Parameter):
    """An expression, checked by the distance that it belongs to.

    Attributes:
        example: one that works.
    """

    example: str = ""

    def in_words(self) -> str:
        """For a line of help."""
        return f"an expression such as {self.example}"


def positive(value: float, what: str) -> None:
    """Refuses what is no positive number.

    >>> positive(-1.0, "the diffusion time")
    Traceback (most recent call last):
    ValueError: the diffusion time must be a positive number, not -1.0
    """
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"{what} must be a positive number, not {value}")
