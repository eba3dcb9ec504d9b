"""Which figures there are, and what a function that makes one gets and gives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Drawing
from PIL import Image

DOTS = 100
"""Pixels in an inch of a drawing."""

SEED = 20090715
"""Of everything random."""


@dataclass(frozen=True)
class Table:
    """Numbers beside a picture, already in words, and what to say about them all."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""

    def markdown(self) -> str:
        """The first column on the left, the others on the right."""
        lines = [self.header, [":--", *["--:"] * (len(self.header) - 1)], *self.rows]
        text = "\n".join(f"| {' | '.join(line)} |" for line in lines)
        return f"{text}\n\n{self.note}" if self.note else text


@dataclass(frozen=True)
class Run:
    """Where pictures go, and whether everything is to be tiny: for tests, which look at no picture."""

    folder: Path
    tiny: bool = False

    @property
    def samples(self) -> int:
        """Points inside a 2D shape."""
        return 200 if self.tiny else 30_000

    def save(self, drawing: Drawing, number: str) -> None:
        """Write the picture of a figure, in few bytes and either as a whole or not at all."""
        drawing.set_dpi(40 if self.tiny else DOTS)
        canvas = FigureCanvasAgg(drawing)
        canvas.draw()
        height, width = canvas.buffer_rgba().shape[:2]
        pixels = Image.frombuffer("RGBA", (width, height), canvas.buffer_rgba()).convert("RGB")
        path = self.folder / picture_name(number)
        beside = path.with_name(f"{path.name}.part")
        few = pixels.quantize(255, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        few.save(beside, format="PNG", optimize=True)
        beside.replace(path)


Make = Callable[[Run], Table]


@dataclass(frozen=True)
class Figure:
    """One figure of the paper: its number there ("table1" for the table), a title, and what makes it."""

    number: str
    title: str
    make: Make
    drawn: bool = True


FIGURES: dict[str, Figure] = {}
"""By their numbers, in the order in which they are entered."""


def figure(number: str, title: str, drawn: bool = True) -> Callable[[Make], Make]:
    """Decorator that enters a function in `FIGURES`; `drawn` says whether there is a picture."""

    def enter(make: Make) -> Make:
        assert number not in FIGURES, f"figure {number} is there twice"
        FIGURES[number] = Figure(number, title, make, drawn)
        return make

    return enter


def picture_name(number: str) -> str:
    """The file of a figure.

    >>> picture_name("5")
    'figure_05.png'
    """
    return f"figure_{int(number):02d}.png"
