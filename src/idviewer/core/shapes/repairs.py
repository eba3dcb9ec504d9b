"""Repairs that change a shape, and so are made only where they are asked for by name: which, and how much."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any

from idviewer.core.errors import ShapeError


@dataclass(frozen=True)
class Repairs:
    """Repairs to make when a mesh is read, in the order of the attributes; by default none.

    Attributes:
        weld: the widest gap that is closed, in the shape's unit; None welds nothing.
        fill_holes: the most edges of a hole that is filled; None fills none.
        drop_walls: leave out faces that have the solid on both sides, or on neither.
        unite: make one body of closed parts that overlap each other.

    Raises:
        ShapeError: a width that is no positive number, or holes of fewer than three edges.

    >>> Repairs(weld=1e-4, fill_holes=30).options
    '--weld 1e-4 --fill-holes 30'
    >>> bool(Repairs())
    False
    """

    weld: float | None = None
    fill_holes: int | None = None
    drop_walls: bool = False
    unite: bool = False

    def __post_init__(self) -> None:
        if self.weld is not None and not (math.isfinite(self.weld) and self.weld > 0.0):
            raise ShapeError(f"weld {self.weld}: it is the width of a gap, a positive number such as 1e-4")
        if self.fill_holes is not None and self.fill_holes < 3:
            raise ShapeError(f"fill holes {self.fill_holes}: a hole has three edges or more; give 3 or more")

    def __bool__(self) -> bool:
        return self != Repairs()

    @property
    def asked(self) -> dict[str, Any]:
        """The repairs to make, by name, with their values."""
        wanted = {one.name: getattr(self, one.name) for one in fields(self)}
        return {name: value for name, value in wanted.items() if value is not None and value is not False}

    @property
    def options(self) -> str:
        """The options of the command line that ask for them."""
        words = []
        for name, value in self.asked.items():
            words.append("--" + name.replace("_", "-") + ("" if value is True else f" {number_text(value)}"))
        return " ".join(words)


NO_REPAIRS = Repairs()


@dataclass(frozen=True)
class RepairRecord:
    """The account of one repair, made or foretold.

    Attributes:
        name: of the repair, a field of `Repairs`.
        value: of that field.
        count: of the things that it changes; 0 where there is nothing to do.
        sentence: what it does, without the full stop.
        moved: the largest distance that a vertex moves, in the shape's unit.
    """

    name: str
    value: Any
    count: int
    sentence: str
    moved: float = 0.0


def number_text(value: float) -> str:
    """A number as people type it.

    >>> number_text(1e-05), number_text(0.25), number_text(30), number_text(2e-4)
    ('1e-5', '0.25', '30', '2e-4')
    """
    if isinstance(value, int):
        return str(value)
    plain, power = f"{value:.6g}", f"{value:.5e}"
    digits, exponent = power.split("e")
    short = f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}"
    return plain.replace("e-0", "e-").replace("e+0", "e") if len(plain) <= len(short) else short
