"""What was measured, the bars it is held against, and both as a Markdown table."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

HEADER = ("What", "On", "Measured", "Beside it", "Largest error", "Bar", "Reached")
START, END = "<!-- benchmarks: written by `make bench BENCH_ARGS=--readme` -->", "<!-- end of benchmarks -->"


@dataclass(frozen=True)
class Bar:
    """What a row should reach: a value of at most `limit`, or a ratio of at least that, and an error."""

    limit: float
    error: float = math.inf
    ratio: bool = False


@dataclass(frozen=True)
class Row:
    """One measured number.

    Attributes:
        what: was measured.
        on: which mesh.
        value: in the unit; infinite where it did not come within the time that was waited.
        unit: of value and of the number beside it.
        beside: another number to see it by, and what that is: a peer's, or the median beside a percentile.
        error: the largest true one, as a share of the largest value; None where there is nothing to be wrong.
        bar: what is wanted; None where nothing is.
        readme: whether it belongs into the README's table too.
    """

    what: str
    on: str
    value: float
    unit: str
    beside: tuple[str, float] | None = None
    error: float | None = None
    bar: Bar | None = None
    readme: bool = False

    @property
    def ratio(self) -> float:
        """How many times the value the number beside it is."""
        return self.beside[1] / self.value if self.beside is not None else math.nan

    @property
    def reached(self) -> bool | None:
        """Whether it reaches its bar, value and error; None without one."""
        if self.bar is None:
            return None
        enough = self.ratio >= self.bar.limit if self.bar.ratio else self.value <= self.bar.limit
        return enough and (self.error or 0.0) <= self.bar.error

    @property
    def cells(self) -> tuple[str, ...]:
        """In the order of the header."""
        beside = "" if self.beside is None else f"{self.beside[0]} {quantity(self.beside[1], self.unit)}"
        if self.bar is not None and self.bar.ratio:
            beside += f" = {number(self.ratio)}x"
        error = "" if self.error is None else share(self.error)
        reached = {None: "", True: "yes", False: "**no**"}[self.reached]
        return (
            self.what,
            self.on,
            quantity(self.value, self.unit),
            beside,
            error,
            self._bar_in_words(),
            reached,
        )

    def _bar_in_words(self) -> str:
        if self.bar is None:
            return ""
        words = f"{number(self.bar.limit)}x" if self.bar.ratio else quantity(self.bar.limit, self.unit)
        return words if math.isinf(self.bar.error) else f"{words}, error {share(self.bar.error)}"


def number(value: float) -> str:
    """Three significant digits, thousands set off by commas."""
    return f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def quantity(value: float, unit: str) -> str:
    """A number and its unit."""
    return "not reached" if math.isinf(value) else f"{number(value)} {unit}".strip()


def share(error: float) -> str:
    """An error in one significant digit or two."""
    return f"{error:.1e}".replace("e-0", "e-") if error else "0"


def markdown(rows: Iterable[Row]) -> str:
    """A table with the numbers on the right."""
    lines = [HEADER, (":--", ":--", *("--:",) * (len(HEADER) - 2)), *(row.cells for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def put_into(path: Path, text: str) -> None:
    """Replace what stands between the two markers of a file."""
    old = path.read_text()
    if old.count(START) != 1 or old.count(END) != 1:
        raise SystemExit(f"{path}: put the lines {START!r} and {END!r} where the table shall go")
    before, rest = old.split(START)
    after = rest.split(END)[1]
    beside = path.with_name(path.name + ".part")
    beside.write_text(f"{before}{START}\n\n{text}\n\n{END}{after}")
    beside.replace(path)
