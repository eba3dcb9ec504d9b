"""A mesh from imperfect input: what can be repaired is repaired and noted, what cannot is an error."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.raw_body import RawBody
from idviewer.core.shapes.repairs import NO_REPAIRS, Repairs
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.repair_choices import ComponentChoice


def repair_mesh(
    vertices: ArrayLike,
    faces: ArrayLike | Sequence[Sequence[int]],
    name: str = "",
    component: ComponentChoice | None = None,
    repairs: Repairs = NO_REPAIRS,
) -> Mesh:
    """Make a Mesh of vertices and faces that may need repairs.

    Duplicated vertices are merged (also boundary vertices within a millionth of the bounding box's diagonal,
    if that closes the surface), isolated ones dropped, polygons cut into triangles, duplicate and collapsed
    faces left out, faces without area flipped away, edges and vertices in which the body only touches itself
    cut apart, faces turned so that outer shells wind outward and those around voids inward. Every repair is a
    sentence in the mesh's notes.

    Args:
        vertices: (n, 3) points.
        faces: (m, 3) vertex indices; also polygons, as (m, k) indices or as a sequence of index sequences.
        name: of the mesh, and of the error.
        component: which of several components to take, 1 or "largest" for that of the largest volume. The
            shells of voids go with the shell around them.
        repairs: those that change the shape, to be made first; none by default.

    Raises:
        MeshError: what is wrong cannot be repaired.

    >>> soup = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [9, 9, 9]]
    >>> repair_mesh(soup, [[1, 2, 0], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).notes
    ('1 isolated vertex was dropped.', '1 face wound against its neighbours was turned.')
    """
    body = RawBody(_soup_of(vertices, faces, name), name, component=_checked(component))
    return body.repaired(repairs).mesh


def repair_meshes(
    vertices: ArrayLike,
    faces: ArrayLike | Sequence[Sequence[int]],
    name: str = "",
    repairs: Repairs = NO_REPAIRS,
) -> tuple[Mesh, ...]:
    """Make a Mesh of each component of vertices and faces, that of the largest volume first.

    Args:
        vertices, faces, name, repairs: as in `repair_mesh`.

    Raises:
        MeshError: one of them cannot be repaired.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    >>> two = repair_meshes([*corners, *([4.0 + 2 * x, y, z] for x, y, z in corners)],
    ...                     [*faces, *([4 + a, 4 + b, 4 + c] for a, b, c in faces)], "two")
    >>> [(mesh.name, round(mesh.volume, 3)) for mesh in two]
    [('two, component 1', 0.333), ('two, component 2', 0.167)]
    """
    return RawBody(_soup_of(vertices, faces, name), name).meshes(repairs, name)


def _checked(component: ComponentChoice | None) -> ComponentChoice | None:
    if isinstance(component, str) and component != "largest":
        raise MeshError(f"component {component!r}: give its number, 1 for the largest, or 'largest'")
    return component


def _soup_of(vertices: ArrayLike, faces: ArrayLike | Sequence[Sequence[int]], name: str) -> PolygonSoup:
    try:
        return PolygonSoup.of(vertices, faces)
    except (TypeError, ValueError) as error:
        raise MeshError(f"{name}: {error}" if name else str(error)) from error
