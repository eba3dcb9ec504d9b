"""Campaigns of trials in processes that may end or hang: `python -m tests.fuzz.campaign --count 10000`."""

from __future__ import annotations

import argparse
import json
import queue
import subprocess
import sys
import threading
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

from tests.fuzz.seeds import seeds
from tests.fuzz.trials import make

GOOD = ("loaded", "refused")


@dataclass
class Tally:
    """Outcomes of a campaign.

    Attributes:
        counts: of each suffix and outcome.
        bad: trials that were neither loaded nor refused in one line.
    """

    counts: Counter[tuple[str, str]] = field(default_factory=Counter)
    bad: list[dict[str, Any]] = field(default_factory=list)

    def add(self, trial: dict[str, Any]) -> None:
        """Count a finished trial."""
        self.counts[trial["suffix"], trial["outcome"]] += 1
        if trial["outcome"] not in GOOD:
            self.bad.append(trial)

    def of(self, outcome: str) -> int:
        """How many trials had an outcome."""
        return sum(count for (_, kind), count in self.counts.items() if kind == outcome)


def run(count: int, seed: int, patience: float) -> Tally:
    """Try so many mutants; a process that is silent for longer than patience, in seconds, hangs."""
    tally, done = Tally(), 0
    while done < count:
        done = _run_process(done, count - done, seed, patience, tally)
    return tally


def _run_process(first: int, count: int, seed: int, patience: float, tally: Tally) -> int:
    """Trials from the first until all are done or the process is: the number of the next trial."""
    command = [sys.executable, "-m", "tests.fuzz.trials"]
    command += ["--first", str(first), "--count", str(count), "--seed", str(seed)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    lines: queue.Queue[str] = queue.Queue()
    reader = threading.Thread(target=_pass_on, args=(process, lines), daemon=True)
    reader.start()
    current: dict[str, Any] | None = None
    while line := _next_line(lines, patience if current else 600.0):
        told = json.loads(line)
        current = None if "outcome" in told else told
        if current is None:
            tally.add(told)
            first = told["number"] + 1
    hung = process.poll() is None and current is not None
    process.kill()
    _, said = process.communicate()
    reader.join()
    if current is not None:
        how = "hang" if hung else "crash"
        tally.add({**current, "outcome": how, "message": said[-500:]})
        return int(current["number"]) + 1
    if process.returncode not in (0, -9):
        raise RuntimeError(f"the trials could not begin: {said[-2000:]}")
    return first


def _pass_on(process: subprocess.Popen[str], lines: queue.Queue[str]) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line)
    process.wait()
    lines.put("")


def _next_line(lines: queue.Queue[str], patience: float) -> str:
    try:
        return lines.get(timeout=patience)
    except queue.Empty:
        return ""


def main() -> int:
    """Print a table and the bad trials, keep their files; 1 if there were any."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=2009)
    parser.add_argument("--patience", type=float, default=5.0)
    given = parser.parse_args()
    tally = run(given.count, given.seed, given.patience)
    outcomes = sorted({outcome for _, outcome in tally.counts}, key=lambda one: (one not in GOOD, one))
    print(f"{'file':<10}" + "".join(f"{outcome:>10}" for outcome in outcomes))
    for suffix in sorted({suffix for suffix, _ in tally.counts}):
        print(f"{suffix:<10}" + "".join(f"{tally.counts[suffix, outcome]:>10}" for outcome in outcomes))
    files = seeds()
    for trial in tally.bad:
        _, data = make(trial["number"], given.seed, files)
        print(f"{trial['outcome']}: trial {trial['number']} ({trial['suffix']}): {trial['message']}")
        print(f"  {data[:200]!r}")
    return 1 if tally.bad else 0


if __name__ == "__main__":
    sys.exit(main())
