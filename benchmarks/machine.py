"""The machine and the versions that numbers belong to, in one line."""

from __future__ import annotations

import datetime
import os
import platform
from importlib.metadata import version
from pathlib import Path

PACKAGES = ("numpy", "scipy", "numba", "vtk")


def description() -> str:
    """Processor, cores, Python, versions of what counts, and today's date."""
    versions = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    today = datetime.date.today().isoformat()
    return f"{processor()}, {os.cpu_count()} cores; Python {platform.python_version()}, {versions}; {today}"


def processor() -> str:
    """The processor's name, or at least its kind."""
    known = Path("/proc/cpuinfo")
    lines = known.read_text().splitlines() if known.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
