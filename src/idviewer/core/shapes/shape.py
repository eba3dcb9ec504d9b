"""Shape: what triangle meshes in space and polygons in the plane share, and the door for their arrays.

Whatever takes a shape takes its arrays as well:

- of a mesh, `(vertices, faces)`, (n, 3) points and (m, 3) vertex numbers, as `Mesh` does;
- of a polygon, `vertices`, (n, 2) points, or `(vertices, loops)`, as `Polygon` does.

They are checked each time; for many calls on one shape make a `Mesh` or a `Polygon` once.
"""

from __future__ import annotations

from typing import Any, ClassVar, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats, Ints
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.validation.file_numbering import FileNumbering


class Shape(Protocol):
    """A boundary with vertices, and the interior that it encloses.

    Attributes:
        dimension: of the space, 2 or 3.
        name: for titles.
    """

    dimension: ClassVar[int]

    @property
    def name(self) -> str:
        """For titles; file name without its suffix."""

    @property
    def notes(self) -> tuple[str, ...]:
        """Repairs made when it was read, one sentence each."""

    @property
    def unit(self) -> str:
        """Unit of the coordinates, such as "mm"; empty where it is not known."""

    @property
    def numbering(self) -> FileNumbering:
        """Which vertex of the file became which of these."""

    @property
    def vertices(self) -> Floats:
        """Vertices (n, dimension), read-only."""

    @property
    def edges(self) -> Ints:
        """Vertices (e, 2) of each edge of the boundary."""

    @property
    def facets(self) -> Ints:
        """Vertices (f, dimension) of each piece of the boundary: triangles in space, edges in the plane."""

    @property
    def bounds(self) -> Floats:
        """Lowest and highest corner of the bounding box, (2, dimension)."""

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal."""


MeshLike = Mesh | tuple[ArrayLike, ArrayLike]
"""A mesh, or its `(vertices, faces)`."""

PolygonLike = Polygon | ArrayLike | tuple[ArrayLike, Any]
"""A polygon, its `vertices`, or its `(vertices, loops)`."""

ShapeLike = Shape | MeshLike | PolygonLike
"""A shape, or its arrays."""


def as_shape(given: ShapeLike) -> Shape:
    """The shape itself, or the mesh or polygon with these arrays.

    Args:
        given: a shape, `(vertices, faces)` of a mesh, `vertices` or `(vertices, loops)` of a polygon.

    Raises:
        ShapeError: the arrays are no such thing (a MeshError or a PolygonError); one line says why.

    >>> as_shape([[0, 0], [1, 0], [0, 1]])
    Polygon('', 3 vertices)
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> as_shape((corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    Mesh('', 4 vertices, 4 faces)
    """
    if hasattr(given, "dimension"):
        return cast(Shape, given)
    if isinstance(given, tuple) and len(given) == 2 and _width(given[0]):
        vertices, pieces = cast(tuple[ArrayLike, Any], given)
        return Polygon(vertices, pieces) if _width(vertices) == 2 else Mesh(vertices, pieces)
    width = _width(given)
    if width == 2:
        return Polygon(cast(ArrayLike, given))
    what = "an array of points alone" if width else f"a {type(given).__name__}"
    raise MeshError(
        f"{what} is no shape; give a Mesh or a Polygon, (vertices, faces) of a mesh, "
        "or the (n, 2) vertices of a polygon"
    )


def as_mesh(given: MeshLike) -> Mesh:
    """The mesh itself, or that of `(vertices, faces)`.

    Raises:
        MeshError: they are no mesh; one line says why.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> as_mesh((corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])).edges.shape
    (6, 2)
    """
    shape = as_shape(given)
    if not isinstance(shape, Mesh):
        raise MeshError("a Mesh, or its (vertices, faces), is needed here, and not a shape in the plane")
    return shape


def as_polygon(given: PolygonLike) -> Polygon:
    """The polygon itself, or that of `vertices` or `(vertices, loops)`.

    Raises:
        PolygonError: they are no polygon; one line says why.

    >>> as_polygon([[0, 0], [1, 0], [0, 1]]).area
    0.5
    """
    try:
        shape = as_shape(given)
    except MeshError as error:
        raise PolygonError(str(error)) from None
    if not isinstance(shape, Polygon):
        raise PolygonError("a Polygon, or its vertices, is needed here, and not a shape in space")
    return shape


def _width(points: Any) -> int:
    """The dimension of a list of points, 0 if it is none."""
    try:
        array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        return 0
    return array.shape[1] if array.ndim == 2 else 0
