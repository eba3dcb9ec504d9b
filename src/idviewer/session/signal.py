"""A list of callables to tell."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Signal:
    """Tells every connected callable, in the order in which they were connected.

    >>> heard = []
    >>> signal = Signal()
    >>> signal.connect(heard.append)
    >>> signal.emit(3)
    >>> heard
    [3]
    """

    def __init__(self) -> None:
        self._slots: list[Callable[..., object]] = []

    def connect(self, slot: Callable[..., object]) -> None:
        """Call slot at each emit from now on."""
        self._slots.append(slot)

    def disconnect(self, slot: Callable[..., object]) -> None:
        """Stop calling slot; nothing happens if it is not connected."""
        if slot in self._slots:
            self._slots.remove(slot)

    def emit(self, *arguments: Any) -> None:
        """Call every slot with the arguments."""
        for slot in tuple(self._slots):
            slot(*arguments)
