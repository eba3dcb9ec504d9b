"""Abaqus input files: the outer surface of all solid elements, or else the shells, where instances are.

meshio is not used: of several blocks of nodes it keeps the last, it knows no parts and instances, and it
opens whatever file an *INCLUDE names.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.errors import Part
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.memory_bound import MEMORY_BOUND
from idviewer.core.io.text import UnreadableError, as_text, integers
from idviewer.core.io.written_numbers import numbers
from idviewer.core.validation.cell_surfaces import CELL_KINDS, Cells, surface_of_cells
from idviewer.core.validation.polygon_soup import PolygonSoup

_SOLID = re.compile(r"(?:AC|DC|C|COH)3D(\d+)[A-Z]*|SC(\d)R[A-Z]*")
_SOLID_KINDS = {
    **{4: "tetra", 5: "pyramid", 6: "wedge", 8: "hexahedron"},
    **{10: "tetra10", 13: "pyramid13", 15: "wedge15", 20: "hexahedron20"},
}
_SHELL = re.compile(r"(?:DS|STRI|R3D|M3D|SFM3D|F3D|S)(\d)[A-Z0-9]*")
_SHELL_KINDS = {3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8", 9: "quad9"}
_WIRES_AND_POINTS = re.compile(
    r"(B|T|PIPE|ELBOW|FRAME)\d+.*|R3D2|RB3D2|(SPRING|MASS|ROTARYI|CONN|DASHPOT|GAP|DCOUP|JOINTC|HEATCAP|IT).*"
)
_UNKNOWN_WORK = ("INCLUDE", "NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "PARAMETER")
"""Keywords that make nodes and elements, or take them from elsewhere."""


@dataclass
class _Block:
    """A keyword with its parameters, and the tokens of the lines below it."""

    keyword: str
    given: dict[str, str]
    rows: list[list[bytes]]


@dataclass
class _AbaqusPart:
    """Nodes and elements of one part, or of one instance.

    Attributes:
        name: empty for those outside of parts.
        nodes: their numbers, one array for each block.
        points: (n, 3) coordinates, likewise.
        elements: kind, and nodes of each element, likewise.
    """

    name: str = ""
    nodes: list[Ints] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)
    elements: list[tuple[str, Ints]] = field(default_factory=list)

    def add_nodes(self, block: _Block) -> None:
        if any(len(row) != 4 for row in block.rows):
            raise UnreadableError("truncated, or a node does not have a number and three coordinates")
        tokens = [token for row in block.rows for token in row]
        self.nodes.append(integers(tokens[::4]))
        values, _ = numbers([token for axis in (1, 2, 3) for token in tokens[axis::4]])
        self.points.append(np.ascontiguousarray(values.reshape(3, -1).T))

    def add_elements(self, block: _Block, kind: str) -> None:
        values = integers([token for row in block.rows for token in row])
        width = CELL_KINDS[kind].points + 1
        if len(values) % width:
            raise UnreadableError(
                f"truncated: an element {block.given['TYPE']} does not have {width - 1} nodes"
            )
        self.elements.append((kind, values.reshape(-1, width)[:, 1:]))

    def cells(self, offset: int) -> tuple[Floats, list[Cells]]:
        """Points, and the elements by places among all points."""
        numbers_of = np.concatenate([np.empty(0, np.int64), *self.nodes])
        points = np.concatenate([np.empty((0, 3)), *self.points])
        order = np.argsort(numbers_of, kind="stable")
        known = numbers_of[order]
        if np.any(known[1:] == known[:-1]):
            raise UnreadableError(f"it has two nodes with the number {known[1:][known[1:] == known[:-1]][0]}")
        blocks = []
        for kind, nodes in self.elements:
            places = np.searchsorted(known, nodes)
            places[places == len(known)] = 0
            if nodes.size and (not len(known) or np.any(known[places] != nodes)):
                raise UnreadableError("truncated or damaged: an element refers to a missing node")
            blocks.append(Cells(kind, order[places] + offset))
        return points, blocks


def read_abaqus(source: FileSource) -> Contents[PolygonSoup]:
    """Read the surface in an Abaqus input file, of all instances together or of a chosen one.

    Args:
        source: the file.

    Raises:
        UnreadableError: it is damaged, takes nodes from elsewhere, or has elements that are not known.
        PartError: it has no such instance.
    """
    reader = _AbaqusReader(len(source.data))
    for block in _blocks(as_text(source.data)):
        reader.take(block)
    placed = reader.placed()
    parts = tuple(Part(one.name) for one in placed if one.name)
    if source.part is not None:
        named = [one for one in placed if one.name]
        chosen = source.chosen(parts, "instances")
        placed = named if chosen is None else [named[chosen]]
    points, blocks, offset = [np.empty((0, 3))], [], 0
    for one in placed:
        own, cells = one.cells(offset)
        points.append(own)
        blocks += cells
        offset += len(own)
    vertices = np.concatenate(points)
    if not blocks:
        raise UnreadableError("it holds no solid and no shell elements")
    polygons, notes = surface_of_cells(vertices, blocks)
    if reader.passed_over:
        notes += (f"Elements without a surface were passed over: {', '.join(reader.passed_over)}.",)
    return Contents(PolygonSoup(vertices, *polygons), notes, parts=parts)


def _blocks(text: bytes) -> Iterator[_Block]:
    """Keywords and what stands below them."""
    block: _Block | None = None
    heading = ""
    for line in text.splitlines():
        if line.startswith(b"**") or not line.strip():
            continue
        if not line.startswith(b"*") and not heading:
            if block is not None:
                block.rows.append([token for token in map(bytes.strip, line.split(b",")) if token])
            continue
        heading += line.decode("latin-1").strip()
        if heading.endswith(","):  # it goes on in the next line
            continue
        if block is not None:
            yield block
        keyword, *given = (one.strip() for one in heading[1:].split(","))
        pairs = [one.partition("=") for one in given]
        named = {name.strip().upper(): value.strip().strip('"') for name, _, value in pairs}
        block, heading = _Block(" ".join(keyword.upper().split()), named, []), ""
    if block is not None:
        yield block


class _AbaqusReader:
    """Parts, the instances of them, and what stands outside of both."""

    def __init__(self, size: int) -> None:
        self.size, self.spent = size, 0
        self.outside = _AbaqusPart()
        self.parts: dict[str, _AbaqusPart] = {}
        self.instances: list[_AbaqusPart] = []
        self.current = self.outside
        self.open: list[str] = []
        self.passed_over: dict[str, None] = {}

    def take(self, block: _Block) -> None:
        keyword = block.keyword
        if keyword in _UNKNOWN_WORK or "INPUT" in block.given:
            raise UnreadableError(f"it makes its mesh by *{keyword}, or elsewhere, which is not supported")
        if keyword in ("PART", "INSTANCE", "ASSEMBLY"):
            self.open.append(keyword)
            name = block.given.get("NAME", "")
            if keyword == "PART":
                self.current = self.parts.setdefault(name.upper(), _AbaqusPart(name))
            if keyword == "INSTANCE":
                self.current = self.instance(name, block)
                self.instances.append(self.current)
        elif keyword in ("END PART", "END INSTANCE", "END ASSEMBLY"):
            if not self.open or self.open.pop() != keyword[4:]:
                raise UnreadableError(f"damaged: its *{keyword} ends nothing")
            self.current = self.outside
        elif keyword == "NODE":
            if block.given.get("SYSTEM", "R").upper() != "R":
                raise UnreadableError(
                    "its nodes have cylindrical or spherical coordinates, which are not supported"
                )
            self.current.add_nodes(block)
        elif keyword == "ELEMENT":
            self.elements(block)

    def elements(self, block: _Block) -> None:
        kind = block.given.get("TYPE", "").upper()
        if solid := _SOLID.fullmatch(kind):
            known = _SOLID_KINDS.get(int(solid[1] or solid[2]))
        else:
            shell = _SHELL.fullmatch(kind)
            known = _SHELL_KINDS.get(int(shell[1])) if shell else None
        if known is not None:
            self.current.add_elements(block, known)
        elif _WIRES_AND_POINTS.fullmatch(kind):
            self.passed_over[kind] = None
        else:
            raise UnreadableError(f"it has elements of the type {kind[:20]!a}, which are not known")

    def instance(self, name: str, block: _Block) -> _AbaqusPart:
        """A part where it is placed: moved, then turned about an axis."""
        part = self.parts.get(block.given.get("PART", "").upper(), _AbaqusPart())
        points = list(part.points)
        self.spent += (
            1000 + sum(one.nbytes for one in points) + sum(nodes.nbytes for _, nodes in part.elements)
        )
        MEMORY_BOUND.check(self.spent, self.size, "what its instances describe")
        for row, count in zip(block.rows, (3, 7), strict=False):
            values, _ = numbers(row)
            if len(values) != count:
                raise UnreadableError(f"the instance {name[:20]!a} is placed by {len(values)} numbers")
            points = [one + values if count == 3 else _turned(one, values) for one in points]
        return _AbaqusPart(name, list(part.nodes), points, list(part.elements))

    def placed(self) -> list[_AbaqusPart]:
        if self.open:
            raise UnreadableError(f"truncated: its *{self.open[-1]} does not end")
        parts = self.instances if self.instances else list(self.parts.values())
        return [*(one for one in parts if one.elements), *([self.outside] if self.outside.elements else [])]


def _turned(points: Floats, line: Floats) -> Floats:
    """Points turned about an axis, given by two points on it and an angle in degrees (Rodrigues' formula)."""
    start, axis, angle = line[:3], line[3:6] - line[:3], np.radians(line[6])
    length = np.linalg.norm(axis)
    if not length > 0.0:
        raise UnreadableError("an instance is turned about no axis")
    axis = axis / length
    away = points - start
    along = (away @ axis)[:, None] * axis
    return start + along + np.cos(angle) * (away - along) + np.sin(angle) * np.cross(axis, away)
