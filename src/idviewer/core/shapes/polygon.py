"""The polygon that everything else computes on: a simple outline, with holes or without."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import Floats, Ints, as_points, frozen
from idviewer.core.shapes.labels import Labelled
from idviewer.core.shapes.polygon_bridges import bridges_between, resistances_between
from idviewer.core.shapes.polygon_region import contained, prepared_region
from idviewer.core.shapes.polygon_resampling import cut_loops, resampled_loops
from idviewer.core.validation import polygon_checks as checks
from idviewer.core.validation.file_numbering import FileNumbering
from idviewer.core.validation.polygon_checks import PolygonError

__all__ = ["Polygon", "PolygonError"]


@dataclass(frozen=True, eq=False, init=False)
class Polygon(Labelled):
    """A polygon whose outline neither crosses nor touches itself, with holes or without.

    The constructor takes copies and checks everything. Polygons compare by identity, and any thread may
    read them. The loops of a polygon with holes are joined by bridges: a minimum spanning tree over the
    nearest pairs of vertices, along which heat flows and boundary distances are measured. A bridge has a
    length but no mass. The paper knows one loop, and then there are no bridges.

    Attributes:
        vertices: (n, 2) float64 points, read-only.
        loops: vertex numbers of each loop, read-only: the outer one (that of the largest area) first and
            counter-clockwise, the holes clockwise. One loop through all vertices if none are given; the
            order and the sense in which loops are given do not matter.
        name: for titles; file name without its suffix.
        notes: what was changed when it was read, one sentence each.
        unit: of the coordinates, such as "mm"; empty where it is not known.
        numbering: which point of the file, or of the arrays that were given, became which vertex.

    Raises:
        PolygonError: under three vertices, repeated ones, edges that cross or touch, holes that lie outside
            or in each other, no area, numbers that are not finite.

    >>> square = Polygon([[0, 0], [0, 1], [1, 1], [1, 0]])
    >>> square.area, square.perimeter, square.loops[0].tolist()
    (1.0, 4.0, [0, 3, 2, 1])
    """

    dimension: ClassVar[int] = 2

    vertices: NDArray[np.float64]
    loops: tuple[NDArray[np.int64], ...] = ()
    name: str = ""
    notes: tuple[str, ...] = ()
    unit: str = ""
    numbering: FileNumbering = field(init=False, repr=False)

    def __init__(
        self,
        vertices: ArrayLike,
        loops: Sequence[ArrayLike] | None = None,
        name: str = "",
        notes: Sequence[str] = (),
        unit: str = "",
    ) -> None:
        self._label(name, notes, unit)
        try:
            points = checks.points_of(vertices)
            numbers = checks.checked_loops(points, checks.loops_of(loops, len(points)))
        except PolygonError as error:
            raise self._named(error) from None
        self._fill(points, numbers)

    def _named(self, error: PolygonError) -> PolygonError:
        return PolygonError(f"{self.name}: {error}") if self.name else error

    def _label(self, name: str, notes: Sequence[str], unit: str) -> None:
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "notes", tuple(notes))
        object.__setattr__(self, "unit", unit)

    def _fill(
        self, vertices: Floats, loops: tuple[Ints, ...], numbering: FileNumbering | None = None
    ) -> None:
        object.__setattr__(self, "vertices", frozen(vertices))
        object.__setattr__(self, "loops", tuple(map(frozen, loops)))
        object.__setattr__(self, "numbering", numbering or FileNumbering.unchanged(len(vertices)))

    def with_numbering(self, numbering: FileNumbering) -> Polygon:
        """The same polygon, whose vertices are known to a file by other numbers.

        Args:
            numbering: for the n vertices.
        """
        numbered = copy(self)
        object.__setattr__(numbered, "numbering", numbering)
        return numbered

    @property
    def file_vertices(self) -> Ints:
        """Number (f,) of the vertex that each point of the file became, all loops one after the other."""
        return self.numbering.became

    def __repr__(self) -> str:
        holes = {1: "", 2: ", 1 hole"}.get(len(self.loops), f", {len(self.loops) - 1} holes")
        return f"Polygon({self.name!r}, {len(self.vertices)} vertices{holes})"

    @classmethod
    def of_loops(cls, loops: Sequence[ArrayLike], name: str = "", notes: Sequence[str] = ()) -> Polygon:
        """Make the polygon whose loops are given as points.

        Args:
            loops: (k, 2) points each, the last not repeating the first.
            name: of the polygon, which errors begin with.
            notes: repairs made before, one sentence each.

        Raises:
            PolygonError: the loops are not finite points, or bound no polygon.

        >>> outer, hole = [[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [2, 1], [2, 2], [1, 2]]
        >>> Polygon.of_loops([outer, hole])
        Polygon('', 8 vertices, 1 hole)
        """
        try:
            points = [checks.points_of(loop) for loop in loops]
        except PolygonError as error:
            raise PolygonError(f"{name}: {error}" if name else str(error)) from None
        ends = np.cumsum([0, *map(len, points)])
        numbers = tuple(np.arange(first, stop) for first, stop in itertools.pairwise(ends))
        return cls(np.concatenate([np.empty((0, 2)), *points]), numbers, name, tuple(notes))

    def with_vertices(self, vertices: ArrayLike) -> Polygon:
        """The same loops with vertices moved.

        Args:
            vertices: (n, 2).

        Raises:
            PolygonError: like the constructor.

        >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
        >>> square.with_vertices([[0, 0], [1, 0], [3, 3], [0, 1]]).area
        3.0
        """
        try:
            points = checks.points_of(vertices)
            if len(points) != len(self.vertices):
                raise PolygonError(
                    f"{len(self.vertices)} vertices are to be moved, and {len(points)} are given"
                )
            loops = checks.checked_loops(points, self.loops)
        except PolygonError as error:
            raise self._named(error) from None
        polygon = object.__new__(Polygon)
        polygon._label(self.name, self.notes, self.unit)
        polygon._fill(points, loops, self.numbering)
        return polygon

    def resampled(self, count: int) -> Polygon:
        """The outline sampled at so many points; corners stay, between them the spacing is equal.

        A corner is a vertex where the outline turns by more than 20 degrees. Points are shared out so that
        the widest spacing is as small as can be.

        Args:
            count: of all loops together.

        Raises:
            PolygonError: too few points for the corners, or so few that edges cross.

        >>> len(Polygon([[0, 0], [3, 0], [0, 4]]).resampled(24).vertices)
        24
        """
        try:
            loops = resampled_loops(self.vertices, self.loops, count)
            made = Polygon.of_loops(loops)
        except PolygonError as error:
            raise self._named(PolygonError(f"with {count} points: {error}")) from None
        return made.with_labels(self.name, self.notes, self.unit)

    def refined(self, edge_length: float) -> Polygon:
        """Cut edges into equal parts until none is longer than asked; the outline stays where it is.

        The vertices stay, first and in order. Where no edge is longer, it is the polygon itself.

        Args:
            edge_length: the longest allowed, in the polygon's unit.

        Raises:
            PolygonError: it is no positive number, or so short that there would be millions of vertices.

        >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
        >>> square.refined(0.4).loops[0].tolist()
        [0, 4, 5, 1, 6, 7, 2, 8, 9, 3, 10, 11]
        >>> square.refined(1.0) is square
        True
        """
        if 0.0 < self.longest_edge <= edge_length < math.inf:
            return self
        try:
            arrays = cut_loops(self.vertices, self.loops, self.lengths, edge_length)
        except PolygonError as error:
            raise self._named(error) from None
        polygon = object.__new__(Polygon)
        polygon._label(self.name, self.notes, self.unit)
        polygon._fill(*arrays, self.numbering.extended(len(arrays[0])))
        return polygon

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points lie inside; those on the boundary do.

        Args:
            points: (p, 2).

        Returns:
            (p,).

        >>> Polygon([[0, 0], [1, 0], [0, 1]]).contains([[0.2, 0.2], [0.5, 0.5], [0.6, 0.6]]).tolist()
        [True, True, False]
        """
        return contained(self._region, self.vertices, as_points(points, 2))

    @cached_property
    def _region(self) -> shapely.Polygon:
        return prepared_region(self.vertices, self.loops)

    @cached_property
    def bounds(self) -> Floats:
        """Lowest and highest corner of the bounding box, (2, 2)."""
        return frozen(np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)]))

    @cached_property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""
        return float(np.linalg.norm(self.bounds[1] - self.bounds[0]))

    @property
    def facets(self) -> Ints:
        """The edges, as all shapes call the pieces of their boundaries."""
        return self.edges

    @cached_property
    def edges(self) -> Ints:
        """Edges (n, 2): each vertex and the one that follows it, the interior on the left."""
        return frozen(np.stack([np.arange(len(self.vertices)), checks.successors_of(self.loops)], axis=1))

    @cached_property
    def lengths(self) -> Floats:
        """Length of each edge, (n,)."""
        sides = self.vertices[self.edges[:, 1]] - self.vertices
        return frozen(np.hypot(sides[:, 0], sides[:, 1]))

    @property
    def longest_edge(self) -> float:
        """Length of the longest edge."""
        return float(self.lengths.max())

    @cached_property
    def area(self) -> float:
        """Area enclosed, holes not counted."""
        return float(sum(checks.signed_area(self.vertices[loop]) for loop in self.loops))

    @cached_property
    def perimeter(self) -> float:
        """Length of all loops."""
        return float(self.lengths.sum())

    @cached_property
    def bridges(self) -> Ints:
        """Vertices (h, 2) joined by each bridge; one bridge fewer than loops."""
        return frozen(bridges_between(self.vertices, self.loops))

    @cached_property
    def bridge_lengths(self) -> Floats:
        """Length of each bridge, (h,)."""
        sides = self.vertices[self.bridges[:, 1]] - self.vertices[self.bridges[:, 0]]
        return frozen(np.hypot(sides[:, 0], sides[:, 1]))

    def resistances(self) -> Floats:
        """Effective resistances (n, n) between vertices; edges and bridges resist as much as they are long.

        The resistance between i and j is (e_i - e_j)^T L^+ (e_i - e_j) with the polygon's Laplacian L: the
        commute time distance squared, in closed form.
        """
        bridges = np.column_stack([self.bridges, self.bridge_lengths])
        return resistances_between(self.loops, self.lengths, bridges)
