"""Repair choices: what a user decides about a mesh, since no check can."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

ComponentChoice = int | Literal["largest"]
"""Number of a component, 1 for that of the largest volume, or the largest."""


@dataclass(frozen=True)
class RepairChoices:
    """Decisions about a mesh.

    Attributes:
        component: which of several components to take; None where there may be only one.
        drop_walls: leave out the faces that have solid on both sides, or on neither.
        strict: nothing is to be repaired, so a surface that touches itself in vertices stays in one piece.
    """

    component: ComponentChoice | None = None
    drop_walls: bool = False
    strict: bool = False

    @property
    def number(self) -> int | None:
        """Number of the component to take, from 1."""
        return 1 if self.component == "largest" else self.component


NO_CHOICES = RepairChoices()
