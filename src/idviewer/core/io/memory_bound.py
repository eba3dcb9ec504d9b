"""How much memory a file may ask for before it is refused: what it announces, held against its size."""

from __future__ import annotations

from dataclasses import dataclass

from idviewer.core.io.text import UnreadableError


@dataclass(frozen=True)
class MemoryBound:
    """Settings of the bound: a share of the file's size and a constant.

    Attributes:
        times: bytes of what is made of a file, for each of its bytes.
        constant: bytes in addition, so that small files can be well compressed.
        seconds: of computing that a library's process may take in any case.
        seconds_per_megabyte: of the file, beside.
    """

    times: int = 20
    constant: int = 1 << 18
    seconds: int = 5
    seconds_per_megabyte: float = 5.0

    def of(self, size: int) -> int:
        """Bytes that may be made of a file.

        Args:
            size: of the file in bytes.

        >>> MemoryBound(20, 1000).of(10)
        1200
        """
        return self.times * size + self.constant

    def seconds_for(self, size: int) -> int:
        """Seconds of computing that a library's process may take.

        Args:
            size: of the file in bytes.

        >>> MemoryBound().seconds_for(2_000_000)
        15
        """
        return self.seconds + int(self.seconds_per_megabyte * size / 1e6)

    def check(self, needed: int, size: int, what: str) -> None:
        """Refuse what would take too much.

        Args:
            needed: bytes that are asked for.
            size: of the file in bytes.
            what: asks for them, for the message.

        Raises:
            UnreadableError: it is more than the bound.

        >>> MEMORY_BOUND.check(1000, 10, "its points")
        """
        if needed > self.of(size):
            raise UnreadableError(
                f"{what} would take {needed:,} bytes, more than {self.times} times the file's {size:,}"
            )


MEMORY_BOUND = MemoryBound()
