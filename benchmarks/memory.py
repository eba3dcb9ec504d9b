"""The most memory that the viewer ever holds: opened, left alone until its slice is complete, and dragged."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bodies import Body
from settings import Settings
from table import Bar, Row

TITLE = "Peak memory"
MOVES = 30
NOTE = (
    f"The program in a process of its own, until the slice of the last of {MOVES} poses of a drag is "
    "complete; where there is neither a display nor Xvfb, the pipeline without its window. The largest "
    "resident set (VmHWM), that of VTK, Qt and Mesa included."
)
AT_MOST = Bar(700.0)
PROGRAM = Path(__file__).with_name("viewer_process.py")
TIMEOUT = 300


def rows(settings: Settings) -> Iterator[Row]:
    for body in settings.bodies:
        if body.readme:
            with screen() as environment:
                what = "viewer" if environment else "pipeline without a window"
                peak, files = _megabytes(body, environment)
            bar = AT_MOST if body.large and environment else None
            yield Row(what, body.label, peak, "MB", ("of it files,", files), bar=bar, readme=True)


@contextmanager
def screen() -> Iterator[dict[str, str]]:
    """Variables for a window on a screen of our own, else on the user's; none where there is none."""
    if shutil.which("Xvfb") is None:
        yield {"DISPLAY": os.environ["DISPLAY"]} if os.environ.get("DISPLAY") else {}
        return
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1400x1000x24", "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=[writing], stderr=subprocess.DEVNULL)
    try:
        os.close(writing)
        with os.fdopen(reading) as said:
            number = said.readline().strip()
        yield {"DISPLAY": f":{number}", "QT_QPA_PLATFORM": "xcb", "LIBGL_ALWAYS_SOFTWARE": "1"}
    finally:
        server.terminate()
        server.wait()


def _megabytes(body: Body, environment: dict[str, str]) -> tuple[float, float]:
    """The peak, and the part that is mapped files at the end: programs and libraries."""
    with tempfile.TemporaryDirectory() as settings:
        done = subprocess.run(
            [sys.executable, PROGRAM, body.path, str(MOVES), "window" if environment else "pipeline"],
            env={**os.environ, **environment, "XDG_CONFIG_HOME": settings},
            capture_output=True,
            text=True,
            timeout=TIMEOUT,
        )
    if done.returncode != 0:
        raise RuntimeError(f"the viewer ended with status {done.returncode}: {done.stderr[-2000:]}")
    peak, files = done.stdout.split()[-2:]
    return float(peak) / 1024.0, float(files) / 1024.0
