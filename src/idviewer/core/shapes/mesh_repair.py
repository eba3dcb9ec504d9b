"""A mesh from imperfect input: what can be repaired is repaired and noted, what cannot is an error."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup


def repair_mesh(
    vertices: ArrayLike,
    faces: ArrayLike | Sequence[Sequence[int]],
    name: str = "",
    component: int | None = None,
) -> Mesh:
    """Make a Mesh of vertices and faces that may need repairs.

    Duplicated vertices are merged (also boundary vertices within a millionth of the bounding box's diagonal,
    if that closes the surface), isolated ones dropped, polygons cut into triangles, duplicate and collapsed
    faces left out, faces without area flipped away, faces turned so that all wind outward. Every repair is a
    sentence in the mesh's notes.

    Args:
        vertices: (n, 3) points.
        faces: (m, 3) vertex indices; also polygons, as (m, k) indices or as a sequence of index sequences.
        name: of the mesh, and of the error.
        component: which of several components to take, 1 for the largest.

    Raises:
        MeshError: what is wrong cannot be repaired.

    >>> soup = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [9, 9, 9]]
    >>> repair_mesh(soup, [[1, 2, 0], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).notes
    ('1 isolated vertex was dropped.', '1 face wound against its neighbours was turned.')
    """
    try:
        polygons = PolygonSoup.of(vertices, faces)
    except (TypeError, ValueError) as error:
        raise MeshError(f"{name}: {error}" if name else str(error)) from error
    return repaired_mesh(polygons, name, name, component)


def repaired_mesh(polygons: PolygonSoup, name: str, source: str, component: int | None) -> Mesh:
    """Make a Mesh of polygons that may need repairs.

    Args:
        polygons: as they were read.
        name: of the mesh.
        source: what an error names, such as the file.
        component: number of the one to take; None where there may be only one.

    Raises:
        MeshError: there are faults that cannot be repaired; it lists them.
    """
    report = validate(polygons, component)
    if report.fatal:
        raise MeshError.from_report(report, source)
    notes = tuple(finding.note for finding in report.findings)
    if any(finding.kind == "flat_faces" for finding in report.findings):
        # All other checks follow the repairs that could spoil them; flips come late, so all is checked again.
        again = validate(PolygonSoup.of(report.vertices, report.faces))
        if again.repaired:
            raise MeshError.from_report(again, source)
        again.numbering = report.numbering
        report = again
    return Mesh.from_report(report, name, notes)
