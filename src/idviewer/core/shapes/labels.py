"""Labels of shapes: what tells of them and changes nothing that is computed."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Self


class Labelled:
    """A frozen shape with a name, notes and a unit."""

    def with_labels(
        self, name: str | None = None, notes: Sequence[str] | None = None, unit: str | None = None
    ) -> Self:
        """The same shape with other labels; what is left out stays.

        Args:
            name: for titles.
            notes: one sentence each.
            unit: of the coordinates.

        >>> from idviewer.core import Polygon
        >>> Polygon([[0, 0], [1, 0], [0, 1]]).with_labels(unit="mm").unit
        'mm'
        """
        labelled = copy(self)
        for label, value in (("name", name), ("notes", notes), ("unit", unit)):
            if value is not None:
                object.__setattr__(labelled, label, value if isinstance(value, str) else tuple(value))
        return labelled
