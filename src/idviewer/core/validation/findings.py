"""One thing that is wrong with a mesh, in terms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.validation.finding_kinds import HARMLESS_KINDS, KINDS

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a mesh.

    Attributes:
        kind: one of a fixed set of names, for programs.
        count: how many there are.
        message: what, how much and where, on one line.
        where: one of the places; None where the finding has none.
        repair: what is done about it ("merged"); None if nothing can be: the mesh is unusable.
        remedy: what the user can do about a fatal finding.
        subject: the message without the place.
    """

    kind: str
    count: int
    message: str
    where: Point | None = None
    repair: str | None = None
    remedy: str = ""
    subject: str = ""

    @property
    def fatal(self) -> bool:
        """Whether the mesh cannot be used because of it."""
        return self.repair is None

    @property
    def harmless(self) -> bool:
        """Whether a mesh may stay so."""
        return self.kind in HARMLESS_KINDS

    @property
    def note(self) -> str:
        """The repair as a sentence."""
        sentence = f"{self.subject} {'was' if self.count == 1 else 'were'} {self.repair}."
        return sentence[0].upper() + sentence[1:]

    def as_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        severity = "fatal" if self.fatal else "kept" if self.harmless else "repaired"
        return {
            "kind": self.kind,
            "severity": severity,
            "count": self.count,
            "message": self.message,
            "where": None if self.where is None else list(self.where),
            "repair": self.repair,
            "remedy": self.remedy or None,
        }


def counted(kind: str, count: int, detail: str = "", place: tuple[Floats, float] | None = None) -> Finding:
    """A finding of things that can be counted.

    Args:
        kind: a key of `KINDS`.
        count: of the things.
        detail: appended to the message.
        place: one of their points (3,), and the size of the mesh.

    >>> counted("isolated_vertices", 2).note
    '2 isolated vertices were dropped.'
    """
    terms = KINDS[kind]
    subject = f"{count:,} {terms.one if count == 1 else terms.many}"
    return stated(kind, subject, detail, count, place)


def stated(
    kind: str, subject: str, detail: str = "", count: int = 1, place: tuple[Floats, float] | None = None
) -> Finding:
    """A finding in words of its own.

    Args:
        kind: a key of `KINDS`.
        subject: what was found, in words.
        detail: appended to the message.
        count: of the things found.
        place: one of their points (3,), and the size of the mesh.

    >>> stated("no_volume", "no volume").fatal
    True
    """
    terms = KINDS[kind]
    message = subject.rstrip(",") + detail
    where = None
    if place is not None:
        message += f", near {point_text(*place)}"
        where = tuple(place[0].tolist())
    return Finding(kind, count, message, where, terms.repair or None, terms.remedy, subject)


def point_text(point: Floats, size: float) -> str:
    """A point in words, with as many digits as a mesh of the given size needs.

    >>> point_text(np.array([1e6 + 0.25, 0.0, 1 / 3]), 1.0)
    '(1000000.25, 0, 0.3333)'
    """
    largest = float(np.abs(point).max())
    if largest == 0.0:
        return "(0, 0, 0)"
    digits = min(17, 4 + int(np.ceil(np.log10(largest / size)))) if 0 < size < largest else 4
    # Beside a large coordinate, a small one needs no more decimals: 1e-17 is shown as 0.
    step = 10.0 ** (int(np.floor(np.log10(largest))) + 1 - digits)
    rounded = [round(x / step) * step for x in point.tolist()]
    return "(" + ", ".join(f"{x:.{digits}g}" for x in rounded) + ")"
