"""All figures: importing this module enters them, in the paper's order."""

from __future__ import annotations

from figures import barycentroids, bodies3d, boundaries, choices, sources, timing
from figures.registry import FIGURES as ENTERED
from figures.registry import Figure

__all__ = ["FIGURES", "GROUPS"]

GROUPS = (sources, boundaries, bodies3d, choices, barycentroids, timing)

EXPECTED = ("1", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "table1")
"""Every experiment of the paper; figure 2 is a sketch of the method."""

FIGURES: dict[str, Figure] = {number: ENTERED[number] for number in EXPECTED}
