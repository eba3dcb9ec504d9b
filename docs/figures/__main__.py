"""Makes figures: python -m figures [NUMBER ...], in docs/. Pictures need no display."""

from __future__ import annotations

import argparse
import os
import sys
import time
from itertools import product
from pathlib import Path

from figures import document
from figures.gallery import FIGURES
from figures.registry import Run
from idviewer.core import COORDINATES
from idviewer.core.compilation import compile_steps
from idviewer.core.steps import finish

DOCS = Path(__file__).resolve().parents[1]
WIDTH = 30


def main() -> None:
    arguments = parser().parse_args()
    arguments.images.mkdir(parents=True, exist_ok=True)
    chosen = arguments.figures or list(FIGURES)
    run = Run(arguments.images)
    start = time.monotonic()
    tell(0, len(chosen), "compiling kernels", start)
    for dimension, coordinates in product((2, 3), COORDINATES):
        finish(compile_steps(dimension, coordinates))
    for done, number in enumerate(chosen):
        tell(done, len(chosen), FIGURES[number].title, start)
        document.write(arguments.document, number, FIGURES[number].make(run).markdown())
    tell(len(chosen), len(chosen), f"written: {arguments.document} and {arguments.images}", start)
    print(file=sys.stderr)


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(prog="figures", description="Does the paper's experiments again.")
    made.add_argument(
        "figures", nargs="*", type=known, metavar="NUMBER", help=f"{', '.join(FIGURES)}; or all"
    )
    made.add_argument("--images", type=Path, default=DOCS / "images" / "figures", help="where pictures go")
    made.add_argument(
        "--document", type=Path, default=DOCS / "figures.md", help="where the numbers are put in"
    )
    return made


def known(number: str) -> str:
    """The number of a figure that there is."""
    if number not in FIGURES:
        raise argparse.ArgumentTypeError(f"there is no figure {number}; there are {', '.join(FIGURES)}")
    return number


def tell(done: int, whole: int, what: str, start: float) -> None:
    """A line on standard error that is overwritten, or one line each where that is no terminal."""
    full = WIDTH * done // whole
    bar = "#" * full + "." * (WIDTH - full)
    line = f"[{bar}] {done:2d}/{whole}  {time.monotonic() - start:4.0f} s  {what}"
    if sys.stderr.isatty():
        columns = os.get_terminal_size(sys.stderr.fileno()).columns
        print(f"\r\x1b[K{line[: columns - 1]}", end="", file=sys.stderr, flush=True)
    else:
        print(line, file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
