"""Distances between all pairs of vertices that the user gives."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import ClassVar

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.distances.classical_mds import classical_mds_steps
from idviewer.core.distances.matrix_input import ArrayInput, RowsOfVertices
from idviewer.core.distances.parameters import Choice, File
from idviewer.core.distances.registry import Basis, Distance, Steps, check_size, register_distance
from idviewer.core.distances.spectral import percentage
from idviewer.core.errors import DistanceError
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum

MATRIX = File("Matrix", "the distances", content="n x n distances, n the number of vertices")
FITS = (("exact", "Must embed exactly"), ("approximate", "Nearest embedding"))
FIT = Choice("Embedding", "whether distances that do not embed are refused or approximated", FITS)
COUNTING = Choice(
    "Rows count as",
    "whether rows are the vertices of the file, or those left after its repairs",
    (("file", "The shape's file"), ("shape", "The shape's vertices")),
)
"""Of arrays with a row for each vertex."""

SYMMETRY_TOLERANCE = 1e-8
"""Largest difference between d_ij and d_ji, and largest d_ii, as a share of the largest distance."""

NEGATIVE_EIGENVALUE_TOLERANCE = 1e-7
"""Negative eigenvalues of the Gram matrix up to such a share of the largest are rounding of what is given."""

LARGEST_MATRIX = 4000
"""Vertices: the eigenvalues of so large a matrix take up to two minutes, and 1.6 GB."""


@register_distance
@dataclass(frozen=True)
class GivenDistances(Distance):
    """Any distances between the vertices, given as a matrix.

    Its Gram matrix A = -J D J / 2 (eq. 3, D the squared distances) is decomposed. If A is positive
    semi-definite, the distances embed exactly (class 2), and the interior distance interpolates them.
    Source: Rustamov et al. 2009, section 4.

    Attributes:
        matrix: (f, f) distances (not squared), in the order of the f vertices of the shape's file, or the
            path of a file with them: .npy, .npz ("d.npz:name" where it holds several arrays), .csv or .mtx.
        fit: "exact" refuses distances that do not embed; "approximate" takes the positive part of A, and
            the description says how much that leaves out (class 3).
        counting: "file" if rows and columns count as the file does (see `mesh.file_vertices`), "shape" if
            they are those of `shape.vertices`; the same for a mesh made in memory.

    >>> import numpy as np
    >>> from idviewer.core import InteriorDistance, Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> solver = InteriorDistance(tetrahedron, GivenDistances(2.0 * (1.0 - np.eye(4))))
    >>> solver.distance([[0.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]]).round(9).tolist()
    [2.0]
    """

    name: ClassVar[str] = "matrix"
    title: ClassVar[str] = "Given distances"
    menu_order: ClassVar[int] = 60
    of_given_vertices: ClassVar[bool] = True

    matrix: str | PathLike[str] | Floats | ArrayInput | None = field(
        default=None, metadata={"parameter": MATRIX}
    )
    fit: str = field(default="exact", metadata={"parameter": FIT})
    counting: str = field(default="file", metadata={"parameter": COUNTING})

    @property
    def basis_key(self) -> Hashable:
        """The file or the array, how it counts, and what is to be done where it does not embed."""
        return self.name, self.matrix, self.fit, self.counting

    def squares(self, shape: Shape) -> Floats:
        """Squared distances (n, n), made symmetric.

        Raises:
            DistanceError: the matrix holds no distances between this shape's vertices.
        """
        matrix = RowsOfVertices("distances", self.counting, both=True).of(self.matrix, shape)
        where = Path(self.matrix).name if isinstance(self.matrix, str) else "the distances"
        check_distances(matrix, where)
        return np.square(0.5 * (matrix + matrix.T))

    def basis_steps(self, shape: Shape, spectrum: Spectrum | None) -> Steps:
        """The embedding of the distances by classical MDS, (n, k), as a generator.

        Args:
            shape: n vertices.
            spectrum: not used.

        Raises:
            DistanceError: the shape is too large for a matrix, the matrix holds no distances between its
                vertices, or they do not embed and `fit` is "exact".
        """
        check_size(shape, LARGEST_MATRIX, "a matrix of distances", "take a shape of fewer vertices")
        yield 0.0
        scaled = yield from classical_mds_steps(self.squares(shape))
        if scaled.most_negative < -NEGATIVE_EIGENVALUE_TOLERANCE:
            if self.fit == "exact":
                share = percentage(-scaled.most_negative)
                raise DistanceError(
                    "these distances do not embed exactly: the most negative eigenvalue of their Gram matrix "
                    f"is {share} of the largest; fit=approximate takes the nearest embedding"
                )
            return Basis(scaled.embedding, f"{percentage(scaled.discarded)} of the Gram matrix left out")
        return Basis(scaled.embedding)

    def describe(self, spectrum: Spectrum | None) -> str:
        """The title with the file's name."""
        return f"{self.title} {Path(self.matrix).name if isinstance(self.matrix, str) else self.matrix}"


def check_distances(matrix: Floats, where: str) -> None:
    """Refuse a matrix that is not symmetric, zero on the diagonal and nowhere negative.

    Args:
        matrix: (n, n) finite numbers.
        where: the file or what else it is, for the error.

    Raises:
        DistanceError: it names the row and the column that are wrong.

    >>> check_distances(np.array([[0.0, -1.0], [-1.0, 0.0]]), "d.npy")
    Traceback (most recent call last):
    idviewer.core.errors.DistanceError: d.npy: the distance in row 0, column 1 is negative (-1)
    """
    largest = float(np.abs(matrix).max())
    if matrix.min() < 0.0:
        row, column = np.unravel_index(int(matrix.argmin()), matrix.shape)
        raise DistanceError(
            f"{where}: the distance in row {row}, column {column} is negative ({matrix.min():.4g})"
        )
    diagonal = int(np.diagonal(matrix).argmax())
    if matrix[diagonal, diagonal] > SYMMETRY_TOLERANCE * largest:
        raise DistanceError(
            f"{where}: a vertex is at distance 0 from itself, but row {diagonal} has "
            f"{matrix[diagonal, diagonal]:.4g} on the diagonal"
        )
    gaps = np.abs(matrix - matrix.T)
    if gaps.max() > SYMMETRY_TOLERANCE * largest:
        row, column = np.unravel_index(int(gaps.argmax()), gaps.shape)
        raise DistanceError(
            f"{where}: not symmetric: row {row}, column {column} has {matrix[row, column]:.6g}, "
            f"row {column}, column {row} has {matrix[column, row]:.6g}"
        )
