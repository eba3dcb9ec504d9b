"""3MF packages: all that is built, where its items and components are placed, in the model's unit.

The package is read by the standard library: zip and expat, with bounds of what they may unpack.
"""

from __future__ import annotations

import io
import posixpath
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.errors import Part
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.memory_bound import MEMORY_BOUND
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.threemf_model import Model, ModelObject, Placement, read_model
from idviewer.core.validation.polygon_soup import PolygonSoup

_UNITS = {
    **{"micron": "um", "millimeter": "mm", "centimeter": "cm"},
    **{"inch": "in", "foot": "ft", "meter": "m"},
}
_SUPPORTS = ("support", "solidsupport")
_PIECE = 1000
"""Bytes that one more place of an object takes, however small the object."""


def read_3mf(source: FileSource) -> Contents[PolygonSoup]:
    """Read the polygons of a 3MF file, of all items that are built or of a chosen one.

    Args:
        source: the file.

    Raises:
        UnreadableError: it is no whole package, contradicts itself, or needs what is not supported.
        PartError: it has no such item.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(source.data)) as archive:
            package = _Package(archive, len(source.data))
            return _contents(package, source)
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError) as error:
        raise UnreadableError(f"truncated or damaged ({error})") from error


def _contents(package: _Package, source: FileSource) -> Contents[PolygonSoup]:
    root = package.root()
    model = package.model(root)
    if model.unit not in _UNITS:
        raise UnreadableError(f"its unit {model.unit[:20]!a} is none of 3MF's")
    notes = []
    items = model.items
    if not items:
        used = {one.identity for made in model.objects.values() for one in made.components}
        unplaced = np.vstack([np.eye(3), np.zeros(3)])
        items = [Placement(identity, "", unplaced) for identity in model.objects if identity not in used]
        notes.append("It has no items to build; all its objects were taken.")
    kept = [item for item in items if package.object(item, root)[0].kind not in _SUPPORTS]
    if len(kept) < len(items):
        notes.append(f"{len(items) - len(kept):,} supports were passed over.")
    parts = tuple(Part(_name(package.object(item, root)[0], item)) for item in kept)
    if source.part is not None:
        chosen = source.chosen(parts, "items")
        kept = kept if chosen is None else [kept[chosen]]
    soup = PolygonSoup.joined([piece for item in kept for piece in package.pieces(item, root)])
    if package.other_shapes():
        notes.append(f"{', '.join(package.other_shapes())} in it were passed over.".capitalize())
    return Contents(soup, tuple(notes), _UNITS[model.unit], parts)


def _name(made: ModelObject, item: Placement) -> str:
    return made.name or item.name or f"object {item.identity}"


@dataclass
class _Package:
    """The files of a package, and what was made of them."""

    archive: zipfile.ZipFile
    size: int
    spent: int = 0
    models: dict[str, Model] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.names = {name.lstrip("/").lower(): name for name in self.archive.namelist()}

    def member(self, path: str) -> zipfile.ZipInfo | None:
        name = self.names.get(posixpath.normpath(path.lstrip("/")).lower())
        return None if name is None else self.archive.getinfo(name)

    def take(self, needed: int) -> None:
        self.spent += needed
        MEMORY_BOUND.check(self.spent, self.size, "what it describes")

    def root(self) -> str:
        """The path of the model that the package begins with."""
        found: list[str] = []
        relations = self.member("_rels/.rels")
        if relations is not None:
            self.take(relations.file_size)
            parser = expat.ParserCreate()
            parser.StartElementHandler = lambda tag, given: (
                found.append(given["Target"])
                if given.get("Type", "").endswith("/3dmodel") and "Target" in given
                else None
            )
            parser.StartDoctypeDeclHandler = _refuse_type
            try:
                parser.Parse(self.archive.read(relations), True)
            except expat.ExpatError as error:
                raise UnreadableError("truncated or damaged: its relations") from error
        path = next(iter(found), "3D/3dmodel.model")
        if self.member(path) is None:
            raise UnreadableError("it holds no model")
        return path

    def model(self, path: str) -> Model:
        key = posixpath.normpath(path.lstrip("/")).lower()
        if key not in self.models:
            member = self.member(path)
            if member is None:
                raise UnreadableError(f"its model {path[:60]!a} is missing")
            self.take(member.file_size)
            with self.archive.open(member) as stream:
                self.models[key] = read_model(stream)
        return self.models[key]

    def object(self, placed: Placement, path: str) -> tuple[ModelObject, str]:
        """An object that is placed by something in a model file, and the path of its own."""
        own = placed.path or path
        made = self.model(own).objects.get(placed.identity)
        if made is None:
            raise UnreadableError(f"its object {placed.identity[:20]!a} is missing")
        if len({model.unit for model in self.models.values()}) > 1:
            raise UnreadableError("its models have several units")
        return made, own

    def pieces(
        self, placed: Placement, path: str, outer: Floats | None = None, depth: int = 0
    ) -> Iterator[PolygonSoup]:
        """An object's mesh and its components, where they are placed."""
        made, own = self.object(placed, path)
        if depth > 50:
            raise UnreadableError("its components are made of each other")
        matrix = placed.matrix if outer is None else _one_after_the_other(placed.matrix, outer)
        self.take(_PIECE + 8 * len(made.coordinates) + 8 * len(made.corners))
        if made.corners:
            points, triangles = made.mesh()
            if np.linalg.det(matrix[:3]) < 0:  # a mirror turns the winding round
                triangles = triangles[:, ::-1]
            yield PolygonSoup(points @ matrix[:3] + matrix[3], triangles.ravel(), np.full(len(triangles), 3))
        for component in made.components:
            yield from self.pieces(component, own, matrix, depth + 1)

    def other_shapes(self) -> list[str]:
        return list(dict.fromkeys(name for model in self.models.values() for name in model.other_shapes))


def _one_after_the_other(first: Floats, second: Floats) -> Floats:
    """The transformation (4, 3) that does one and then another."""
    made = first @ second[:3]
    made[3] += second[3]
    return made


def _refuse_type(*_: object) -> None:
    raise UnreadableError("its relations declare a document type, which 3MF does not allow")
