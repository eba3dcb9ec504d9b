"""Trials: mutants of files, read one after the other, each outcome a line of JSON on standard output.

A trial is told before it begins, so that whoever reads the lines knows in which one this process was when it
ended or hung.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import tracemalloc
import warnings
from pathlib import Path

import numpy as np
from tests.fuzz.mutations import mutant
from tests.fuzz.seeds import SLOW_SUFFIXES, seeds

from idviewer.core import ShapeError, read_shape

ALLOWANCE = 4_000_000
"""Bytes that reading may take in any case, for modules loaded and for tables."""
GROWTH = 20
"""Times the file's size that reading may take beside."""
SLOW_SHARE = 0.05


def make(number: int, seed: int, files: dict[str, list[bytes]]) -> tuple[str, bytes]:
    """The suffix and the bytes of a trial; the same for the same number and seed."""
    rng = np.random.default_rng([seed, number])
    slow = rng.random() < SLOW_SHARE
    suffixes = [suffix for suffix in files if (suffix in SLOW_SUFFIXES) == slow]
    suffix = suffixes[int(rng.integers(len(suffixes)))]
    kind = files[suffix]
    data, other = (kind[int(rng.integers(len(kind)))] for _ in range(2))
    return suffix, mutant(rng, data, other)


def read(path: Path) -> tuple[str, str]:
    """The outcome of reading a file: loaded, refused or a fault of the reader, and what was said."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            shape = read_shape(path)
    except ShapeError as error:
        message = str(error)
        tidy = (
            message.isprintable() and message.startswith(str(path)) and len(message) < len(str(path)) + 2000
        )
        return ("refused" if tidy else "untidy"), message
    except MemoryError as error:
        return "memory", repr(error)
    except BaseException as error:
        return "fault", f"{type(error).__name__}: {error}"
    ok = bool(np.isfinite(shape.vertices).all()) and len(shape.facets) > 0
    return ("loaded" if ok else "senseless"), ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=2009)
    given = parser.parse_args()
    files = seeds()
    with tempfile.TemporaryDirectory() as name:
        for suffix, kind in files.items():  # what readers import is not what they allocate
            (Path(name) / f"seed{suffix}").write_bytes(kind[0])
            read(Path(name) / f"seed{suffix}")
        for number in range(given.first, given.first + given.count):
            suffix, data = make(number, given.seed, files)
            path = Path(name) / f"trial{suffix}"
            path.write_bytes(data)
            _tell(number=number, suffix=suffix)
            tracemalloc.start()
            outcome, message = read(path)
            peak = tracemalloc.get_traced_memory()[1]
            tracemalloc.stop()
            if peak > ALLOWANCE + GROWTH * len(data):
                outcome, message = "memory", f"{peak:,} bytes for a file of {len(data):,}; {message}"
            _tell(number=number, suffix=suffix, outcome=outcome, message=message)


def _tell(**content: object) -> None:
    sys.stdout.write(json.dumps(content) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
