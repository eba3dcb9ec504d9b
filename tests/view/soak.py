"""A night of harm: `python -m tests.view.soak --count 10000 --closes 200 --kills 1000 --seed 2009`.

Random events on one window, windows that are closed at their work, and writers that are killed. Besides what
holds for a few events, memory may grow by less than a twentieth between two rests on the same shape, the
first when a quarter of the events is over.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SETTLING, EVENTS_BETWEEN_RESTS = 0.25, 25
"""The share of the events after which memory is measured first; and how many there are between two rests."""
GROWTH = 0.05
"""Of memory, that is allowed."""


def play(count: int, seed: int, folder: Path) -> int:
    """Play events and print what came of them; 1 if anything was wrong."""
    from PySide6.QtWidgets import QApplication
    from tests.view.heard import Heard
    from tests.view.random_events import RandomEvents, write_files

    from idviewer.app import make_window
    from idviewer.session import SpectrumCache

    application = QApplication([])
    application.setApplicationName("idviewer")
    files, heard, started, sizes = write_files(folder), Heard(), time.monotonic(), []
    os.chdir(folder)
    with heard.listen():
        window = make_window(cache=SpectrumCache(folder / "cache"))
        window.resize(1000, 640)
        window.show()
        events = RandomEvents(window, files, seed, heard)
        done = 0
        while done < count:
            if not sizes and done >= SETTLING * count:
                sizes.append(events.open_and_rest(files[0]))
            part = min(EVENTS_BETWEEN_RESTS, count - done)
            events.play(part)
            events.come_to_rest()
            if done // 500 < (done := done + part) // 500:
                print(f"{done} events, {len(heard.complaints)} faults", file=sys.stderr, flush=True)
        sizes.append(events.open_and_rest(files[0]))
        window.close()
    growth = sizes[-1] / sizes[0] - 1
    print(f"{done} events in {time.monotonic() - started:.0f} s: {dict(events.done)}")
    print(f"memory: {sizes[0] / 1e6:.0f} MB, then {sizes[-1] / 1e6:.0f} MB ({growth:+.1%})")
    print(f"faults: {len(heard.complaints)}", *heard.complaints, sep="\n")
    return 1 if heard.complaints or growth >= GROWTH else 0


def do_all(given: argparse.Namespace, folder: Path) -> int:
    """Closes and kills in processes of their own, then the events; 1 if anything was wrong in any."""
    others = {
        "tests.view.closes": ("--count", given.closes),
        "tests.killed_writers": ("--kills", given.kills),
    }
    failed = 0
    for module, (option, count) in others.items():
        command = [sys.executable, "-X", "faulthandler", "-m", module, option, str(count)]
        ended = subprocess.run([*command, "--seed", str(given.seed)], check=False).returncode if count else 0
        if ended:
            failed = 1
            print(f"{module} ended with {ended}", flush=True)
    return play(given.count, given.seed, folder) | failed if given.count else failed


def main() -> int:
    """On the display that there is, or on one made for it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--closes", type=int, default=200)
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=2009)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        settings = Path(name) / "settings"
        settings.mkdir()
        os.environ |= {
            "XDG_CONFIG_HOME": str(settings),
            "QT_QPA_PLATFORM": "xcb",
            "LIBGL_ALWAYS_SOFTWARE": "1",
        }
        if "DISPLAY" in os.environ:
            return do_all(given, Path(name))
        from pyvirtualdisplay import Display

        with Display(size=(1400, 900)):  # which ends after whoever draws on it
            command = [sys.executable, "-m", "tests.view.soak", *sys.argv[1:]]
            return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
