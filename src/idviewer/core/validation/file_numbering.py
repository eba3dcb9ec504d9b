"""File numbering: which vertex of a file became which of the shape, and values carried between both."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, Ints


@dataclass(frozen=True, eq=False)
class FileNumbering:
    """The numbers of vertices before and after repairs.

    Attributes:
        became: (f,) for each vertex of the file, its number in the shape; -1 where it was dropped.
        origins: (n,) for each vertex of the shape, its number in the file, the first where several were
            merged; -1 where a repair made it.
        gap: the largest coordinate difference between vertices that were merged, in the shape's unit.
        closing: numbers in the file of points that only close a polygon's loop by repeating its first.

    >>> numbering = FileNumbering.unchanged(4).renumbered(np.array([-1, 0, 1, 0]))
    >>> numbering.became.tolist(), numbering.origins.tolist()
    ([-1, 0, 1, 0], [1, 2])
    """

    became: Ints
    origins: Ints
    gap: float = 0.0
    closing: Ints = field(default_factory=lambda: np.empty(0, np.int64))

    @classmethod
    def unchanged(cls, count: int) -> FileNumbering:
        """Every vertex as it was.

        Args:
            count: of the vertices.

        >>> FileNumbering.unchanged(2).trivial
        True
        """
        return cls(np.arange(count), np.arange(count))

    @property
    def trivial(self) -> bool:
        """Whether the shape's vertices are the file's, in their order."""
        return len(self.became) == len(self.origins) and bool(
            np.array_equal(self.became, np.arange(len(self.became)))
            and np.array_equal(self.origins, self.became)
        )

    @property
    def merged(self) -> int:
        """How many vertices of the file became a vertex that another one became, too."""
        kept = self.became[self.became >= 0]
        return len(kept) - len(np.unique(kept))

    @property
    def dropped(self) -> int:
        """How many vertices of the file are not in the shape."""
        return int(np.count_nonzero(self.became < 0))

    def in_file_order(self, values: ArrayLike) -> Floats:
        """Values at the shape's vertices in the file's order; NaN where a vertex was dropped.

        Args:
            values: (n, ...) one entry for each vertex of the shape.

        Raises:
            ValueError: there are not as many values as the shape has vertices.

        Returns:
            (f, ...) one for each vertex of the file; merged vertices get the same.

        >>> FileNumbering.unchanged(3).renumbered(np.array([1, -1, 0])).in_file_order([5.0, 7.0]).tolist()
        [7.0, nan, 5.0]
        """
        array = np.asarray(values, dtype=np.float64)
        if array.ndim == 0 or len(array) != len(self.origins):
            raise ValueError(
                f"values of the shape {array.shape} are none of {len(self.origins)} vertices; "
                "give one for each vertex of the shape"
            )
        return np.concatenate([array, np.full((1, *array.shape[1:]), np.nan)])[self.became]

    def renumbered(self, became: Ints, gap: float = 0.0) -> FileNumbering:
        """The numbering after vertices were merged, dropped or reordered.

        Args:
            became: (n,) for each vertex so far, its new number; -1 where it is dropped.
            gap: the largest coordinate difference between vertices that were merged.

        >>> FileNumbering.unchanged(3).renumbered(np.array([2, 0, 1])).origins.tolist()
        [1, 2, 0]
        """
        origins = np.full(int(became.max(initial=-1)) + 1, -1)
        kept = np.flatnonzero((became >= 0) & (self.origins >= 0))[
            ::-1
        ]  # backwards, so that the first of several stays
        origins[became[kept]] = self.origins[kept]
        return FileNumbering(_followed(self.became, became), origins, max(self.gap, gap), self.closing)

    def extended(self, count: int) -> FileNumbering:
        """The numbering after new vertices were put behind those that there are.

        Args:
            count: of all vertices then.

        >>> FileNumbering.unchanged(2).extended(3).origins.tolist()
        [0, 1, -1]
        """
        before = len(self.origins)
        return self.split(np.append(np.arange(before), np.full(count - before, -1)))

    def with_closing(self, closing: Ints) -> FileNumbering:
        """The numbering of a polygon's file that repeats first points to close loops.

        Args:
            closing: (c,) numbers of the repetitions.
        """
        return replace(self, closing=closing)

    def without_closing(self) -> FileNumbering:
        """The numbering of the file's points without those that only close loops.

        >>> closed = FileNumbering(np.array([0, 1, 2, 0]), np.arange(3), closing=np.array([3]))
        >>> closed.without_closing().trivial
        True
        """
        before = np.cumsum(np.isin(np.arange(len(self.became)), self.closing))
        return FileNumbering(
            np.delete(self.became, self.closing), self.origins - before[self.origins], self.gap
        )

    def followed_by(self, second: FileNumbering) -> FileNumbering:
        """The numbering from before the first step to after the second.

        Args:
            second: which counts from what the first one gives.

        >>> first = FileNumbering.unchanged(3).renumbered(np.array([-1, 0, 1]))
        >>> first.followed_by(FileNumbering.unchanged(2).renumbered(np.array([1, 0]))).became.tolist()
        [-1, 1, 0]
        """
        origins = np.where(second.origins >= 0, np.append(self.origins, -1)[second.origins], -1)
        return FileNumbering(_followed(self.became, second.became), origins, max(self.gap, second.gap))

    def split(self, came_from: Ints) -> FileNumbering:
        """The numbering after vertices were copied, or new ones were made.

        Args:
            came_from: (m,) for each new vertex, the one so far that it is or copies; -1 for a new point.

        >>> numbering = FileNumbering.unchanged(2).split(np.array([0, 1, 1, -1]))
        >>> numbering.became.tolist(), numbering.origins.tolist()
        ([0, 1], [0, 1, 1, -1])
        """
        became = np.full(len(self.origins), -1)
        known = np.flatnonzero(came_from >= 0)[::-1]
        became[came_from[known]] = known
        origins = np.where(came_from >= 0, self.origins[came_from], -1)
        return replace(self, became=_followed(self.became, became), origins=origins)


def _followed(first: Ints, second: Ints) -> Ints:
    """The numbers after two steps; what the first drops stays dropped."""
    return np.where(first >= 0, np.append(second, -1)[first], -1)
