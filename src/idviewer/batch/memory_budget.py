"""Memory for several shapes at once: each asks for what it is foretold to need, and waits for that."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable

from idviewer.core.memory import bytes_in_words
from idviewer.core.spectrum import available_bytes, vertices_for

BASE_BYTES = 350e6
"""Of a process before it has a shape: the program, its libraries and its machine code."""

USABLE_SHARE = 0.9
"""Of the machine's memory; the rest is the system's."""


def usable_bytes() -> float:
    """The memory that a collection may take on this machine."""
    return USABLE_SHARE * available_bytes()


def processes_for(budget: float) -> int:
    """How many processes so many bytes suffice for, with room for a small shape in each."""
    return max(1, int(min(budget, 1e15) / (1.5 * BASE_BYTES)))


def why_too_large(needed: float, budget: float) -> str:
    """The reason why a shape that needs so many bytes is not computed; empty if it fits."""
    room = budget - BASE_BYTES
    if needed <= room:
        return ""
    advice = f"simplify it to about {vertices_for(room):,} vertices" if room > 0.0 else "allow for more"
    return (
        f"it would need about {bytes_in_words(needed)} of memory, of which there are "
        f"{bytes_in_words(max(room, 0.0))} for a shape: {advice}"
    )


class MemoryBudget:
    """Bytes that processes share; who asks first gets them first, so that a large shape's turn comes.

    Args:
        budget: bytes for all.

    >>> shared = MemoryBudget(10.0)
    >>> shared.ask("a", 6.0), shared.ask("b", 5.0), shared.ask("c", 1.0)
    (['a'], [], [])
    >>> shared.give_back("a")
    ['b', 'c']
    """

    def __init__(self, budget: float) -> None:
        self.budget = budget
        self._held: dict[Hashable, float] = {}
        self._waiting: deque[tuple[Hashable, float]] = deque()

    def ask(self, who: Hashable, amount: float) -> list[Hashable]:
        """Ask for bytes beside those that `who` holds; all whose turn has come, which may be nobody."""
        self._waiting.append((who, amount))
        return self._served()

    def give_back(self, who: Hashable) -> list[Hashable]:
        """Give back all that `who` holds or waits for; all whose turn has come by that."""
        self._held.pop(who, None)
        self._waiting = deque(one for one in self._waiting if one[0] != who)
        return self._served()

    def _served(self) -> list[Hashable]:
        served = []
        # Who is alone gets what there is: it would wait for nobody.
        while self._waiting and (
            sum(self._held.values()) + self._waiting[0][1] <= self.budget or self._is_alone()
        ):
            who, amount = self._waiting.popleft()
            self._held[who] = self._held.get(who, 0.0) + amount
            served.append(who)
        return served

    def _is_alone(self) -> bool:
        return set(self._held) <= {self._waiting[0][0]}
