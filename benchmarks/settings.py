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
        sizes: numbers of vertices at which a body is opened and its eigenpairs are computed.
        patient: whether peers are waited for that take a quarter of an hour.
    """

    bodies: tuple[Body, ...]
    turns: int
    poses: int
    doublings: int
    sizes: tuple[int, ...]
    patient: bool
