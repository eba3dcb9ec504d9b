"""What a run was asked for."""

from __future__ import annotations

from dataclasses import dataclass

from bodies import Body


@dataclass(frozen=True)
class Settings:
    """What to measure on, and how often.

    Attributes:
        bodies: the smallest first.
        turns: repetitions, of which the medians count.
        poses: of a drag, of each kind.
        doublings: how many times the body of the growth is made finer; each has four times the faces.
    """

    bodies: tuple[Body, ...]
    turns: int
    poses: int
    doublings: int
