"""The model files in a 3MF package: objects, what they are made of, and which of them are built.

They are read by expat as a stream, without a document type, so that no entity is ever expanded.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from typing import IO, Any
from xml.parsers import expat

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.io.text import UnreadableError

_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_EXTENSIONS = "http://schemas.microsoft.com/3dmanufacturing/"
_PRODUCTION = f"{_EXTENSIONS}production/2015/06"
_HARMLESS_EXTENSIONS = (
    _PRODUCTION,
    f"{_EXTENSIONS}material/2015/02",
    f"{_EXTENSIONS}slice/2015/07",
    f"{_EXTENSIONS}trianglesets/2021/07",
)
_OTHER_SHAPES = {
    "beamlattice": "beam lattices",
    "booleanshape": "boolean shapes",
    "levelset": "level sets",
    "displacementmesh": "displaced meshes",
}
"""Elements of extensions that add shapes."""


@dataclass
class Placement:
    """An object at a place, as a component of another or as an item that is built.

    Attributes:
        identity: of the object in its model file.
        path: of that file; empty for the same one.
        matrix: (4, 3), for points as rows.
        name: of the item; may be empty.
    """

    identity: str
    path: str
    matrix: Floats
    name: str = ""


@dataclass
class ModelObject:
    """An object of a model file.

    Attributes:
        name: may be empty.
        kind: "model", "support", "solidsupport", "surface" or "other".
        coordinates: of its points, one after the other.
        corners: of its triangles, likewise.
        components: what it is made of beside.
    """

    name: str
    kind: str
    coordinates: array[float] = field(default_factory=lambda: array("d"))
    corners: array[int] = field(default_factory=lambda: array("q"))
    components: list[Placement] = field(default_factory=list)

    def mesh(self) -> tuple[Floats, Ints]:
        """Points (n, 3) and triangles (m, 3)."""
        points = np.array(self.coordinates, dtype=np.float64)
        return points.reshape(-1, 3), np.array(self.corners, dtype=np.int64).reshape(-1, 3)


@dataclass
class Model:
    """A model file.

    Attributes:
        unit: as the file names it.
        objects: by identity.
        items: that are built, in their order.
        other_shapes: names of shapes in it that are not read.
    """

    unit: str = "millimeter"
    objects: dict[str, ModelObject] = field(default_factory=dict)
    items: list[Placement] = field(default_factory=list)
    other_shapes: dict[str, None] = field(default_factory=dict)


def read_model(stream: IO[bytes]) -> Model:
    """Read a model file.

    Args:
        stream: of its XML.

    Raises:
        UnreadableError: it is damaged, declares entities, or needs an extension that is not supported.
    """
    reader = _Reader()
    parser = expat.ParserCreate(namespace_separator="}")
    parser.StartElementHandler = reader.begin
    parser.StartNamespaceDeclHandler = reader.declare
    parser.StartDoctypeDeclHandler = reader.refuse_type
    try:
        parser.ParseFile(stream)
    except expat.ExpatError as error:
        problem = expat.ErrorString(error.code)
        raise UnreadableError(
            f"truncated or damaged: line {error.lineno} of its model ({problem})"
        ) from error
    except (ValueError, OverflowError) as error:
        if isinstance(error, UnreadableError):
            raise
        line = parser.CurrentLineNumber
        problem = f"line {line} of its model has something else where a number belongs ({error})"
        raise UnreadableError(problem) from error
    except KeyError as error:
        line = parser.CurrentLineNumber
        raise UnreadableError(f"an element in line {line} of its model has no {error.args[0]}") from error
    return reader.model


class _Reader:
    """What expat calls."""

    def __init__(self) -> None:
        self.model = Model()
        self.prefixes: dict[str, str] = {}
        self.current = ModelObject("", "model")

    def declare(self, prefix: str | None, address: str) -> None:
        self.prefixes[prefix or ""] = address

    def refuse_type(self, *_: Any) -> None:
        raise UnreadableError("its model declares a document type, which 3MF does not allow")

    def begin(self, tag: str, given: dict[str, str]) -> None:
        space, _, name = tag.rpartition("}")
        if space not in (_CORE, ""):
            if name in _OTHER_SHAPES:
                self.model.other_shapes[_OTHER_SHAPES[name]] = None
        elif name == "vertex":
            self.current.coordinates.extend((float(given["x"]), float(given["y"]), float(given["z"])))
        elif name == "triangle":
            self.current.corners.extend((int(given["v1"]), int(given["v2"]), int(given["v3"])))
        elif name == "object":
            self.current = ModelObject(given.get("name", ""), given.get("type", "model"))
            self.model.objects[given["id"]] = self.current
        elif name == "component":
            self.current.components.append(_placement(given))
        elif name == "item":
            self.model.items.append(_placement(given))
        elif name == "model":
            self.model.unit = given.get("unit", "millimeter")
            for prefix in given.get("requiredextensions", "").split():
                address = self.prefixes.get(prefix, prefix)
                if address not in _HARMLESS_EXTENSIONS:
                    raise UnreadableError(f"it needs the extension {address}, which is not supported")


def _placement(given: dict[str, str]) -> Placement:
    matrix = np.vstack([np.eye(3), np.zeros(3)])
    if "transform" in given:
        try:
            matrix = np.array(list(map(float, given["transform"].split()))).reshape(4, 3)
        except ValueError as error:
            raise UnreadableError(f"a transform is not twelve numbers ({given['transform'][:40]})") from error
    path = given.get(f"{_PRODUCTION}}}path", "")
    return Placement(given["objectid"], path, matrix, given.get("partnumber", ""))
