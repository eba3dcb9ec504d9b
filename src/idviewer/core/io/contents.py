"""What a reader gets, the bytes of a file, and what it gives: one shape of it, and what is to be told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from idviewer.core.errors import Part
from idviewer.core.io.text import UnreadableError

Geometry = TypeVar("Geometry")

NAMED_PARTS = 8
"""So many of a file's shapes are named in a message; a list of all is in the error."""


@dataclass(frozen=True)
class FileSource:
    """A file as its reader gets it.

    Attributes:
        data: its bytes.
        path: of the file; for names, and for files beside it that it is made of.
        part: name of the one of its shapes to take; None where there may be only one.
    """

    data: bytes
    path: Path
    part: str | None = None

    def refuse_part(self) -> None:
        """Refuse the choice of a part in a format that holds one shape alone.

        Raises:
            PartError: a part is chosen.
        """
        if self.part is not None:
            raise PartError(f"it holds one shape, and no part {self.part!a}; leave the part out")

    def chosen(
        self,
        parts: Sequence[Part],
        kind: str,
        other_names: Sequence[Sequence[str]] = (),
        by_place: bool = True,
        hint: str = "",
    ) -> int | None:
        """Number of the part to take: the one named, or the only one; None where there is none at all.

        A part goes by its name or, where none is named so, by another name that it alone has, or else by its
        place in the file, counted from 1.

        Args:
            parts: the shapes in the file, in its order.
            kind: what they are called there, in the plural, such as "features".
            other_names: of each part, by which it may be chosen, too.
            by_place: whether a number is a part's place; not where names are numbers.
            hint: what else can be done, to end the message with.

        Raises:
            PartError: there are several and none is chosen, or there is none of that name.

        >>> parts = [Part("left", "area 1"), Part("right", "area 2")]
        >>> FileSource(b"", Path("a.json"), "right").chosen(parts, "features")
        1
        """
        if self.part is None:
            if len(parts) > 1:
                raise PartError(_choice(parts, kind) + hint, tuple(parts))
            return 0 if parts else None
        names = [part.name for part in parts]
        if self.part in names:
            return names.index(self.part)
        so_named = [number for number, others in enumerate(other_names) if self.part in others]
        if len(so_named) == 1:
            return so_named[0]
        if len(so_named) > 1:
            parts = [parts[number] for number in so_named]
            raise PartError(
                f"{self.part!a} is the name of several: {named_parts(parts)}; choose one", tuple(parts)
            )
        if by_place and self.part.isascii() and self.part.isdigit() and 1 <= int(self.part) <= len(parts):
            return int(self.part) - 1
        there = f"there are {named_parts(parts)}" if parts else "there are none"
        raise PartError(f"it has no {self.part!a} among its {kind}; {there}", tuple(parts))


@dataclass(frozen=True)
class Contents(Generic[Geometry]):
    """The shape that was read, unchecked.

    Attributes:
        geometry: a PolygonSoup of a mesh, or the loops of a polygon.
        notes: what was passed over or understood in some way, one sentence each.
        unit: of the coordinates, such as "mm"; empty where the file does not say.
        parts: the shapes in the file that the geometry is made of, where one alone can be chosen instead.
    """

    geometry: Geometry
    notes: tuple[str, ...] = ()
    unit: str = ""
    parts: tuple[Part, ...] = ()


class PartError(UnreadableError):
    """A choice of one of a file's shapes that is missing, or that there is not.

    Attributes:
        parts: the shapes to choose from, in the file's order.
    """

    def __init__(self, message: str, parts: tuple[Part, ...] = ()) -> None:
        super().__init__(message)
        self.parts = parts


def _choice(parts: Sequence[Part], kind: str) -> str:
    held = f"it holds {len(parts):,} {kind}: {named_parts(parts)}"
    return f"{held}; choose one by its name, part={parts[0].name!r}"


def named_parts(parts: Sequence[Part]) -> str:
    """The names of parts for a message; of many, the first ones.

    Args:
        parts: the shapes in a file.

    >>> named_parts([Part("left", "area 1"), Part("right")])
    "'left' (area 1), 'right'"
    """
    words = [f"{part.name!r} ({part.description})" if part.description else repr(part.name) for part in parts]
    return ", ".join(words[:NAMED_PARTS]) + (", ..." if len(words) > NAMED_PARTS else "")
