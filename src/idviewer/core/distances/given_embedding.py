"""An embedding that the user gives."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from os import PathLike
from typing import ClassVar

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.distances.given_distances import COUNTING
from idviewer.core.distances.matrix_input import ArrayInput, RowsOfVertices
from idviewer.core.distances.parameters import File
from idviewer.core.distances.registry import Basis, Distance, Steps, register_distance
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import Spectrum

EMBEDDING = File("Embedding", "the embedded vertices", content="one row of coordinates for each vertex")


@register_distance
@dataclass(frozen=True)
class GivenEmbedding(Distance):
    """The distance of an embedding of the vertices, used as it is.

    Attributes:
        embedding: (f, m) with the row v_i* for each of the f vertices of the shape's file, or the path of a
            file that holds it: .npy, .npz ("e.npz:name" where it holds several arrays), .csv or .mtx.
        counting: "file" if rows count as the file does (see `mesh.file_vertices`), "shape" if they are those
            of `shape.vertices`; the same for a mesh made in memory.

    >>> import numpy as np
    >>> from idviewer.core import InteriorDistance, Mesh
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> solver = InteriorDistance(tetrahedron, GivenEmbedding(np.array([[0.0], [2.0], [0.0], [0.0]])))
    >>> solver.distance([[0.1, 0.1, 0.1]], [[0.6, 0.1, 0.1]]).round(12).tolist()
    [1.0]
    """

    name: ClassVar[str] = "embedding"
    title: ClassVar[str] = "Given embedding"
    menu_order: ClassVar[int] = 70
    of_given_vertices: ClassVar[bool] = True

    embedding: str | PathLike[str] | Floats | ArrayInput | None = field(
        default=None, metadata={"parameter": EMBEDDING}
    )
    counting: str = field(default="file", metadata={"parameter": COUNTING})

    @property
    def basis_key(self) -> Hashable:
        """The file or the array, and how it counts."""
        return self.name, self.embedding, self.counting

    def basis_steps(self, shape: Shape, spectrum: Spectrum | None) -> Steps:
        """The rows (n, k), about their mean to keep their digits, as a generator.

        Args:
            shape: n vertices.
            spectrum: not used.

        Raises:
            DistanceError: no file is named, or it holds no finite matrix with a row for each vertex.
            OSError: the file cannot be read.
        """
        yield 0.0
        rows = RowsOfVertices("embedding", self.counting).of(self.embedding, shape)
        return Basis(np.ascontiguousarray(rows - rows.mean(axis=0)))

    def describe(self, spectrum: Spectrum | None) -> str:
        """The title with the file's name."""
        return f"{self.title} {self.embedding}"
