"""A mesh from imperfect input: what can be repaired is repaired and noted, what cannot is an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.validation.mesh_checks import validate
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.repair_choices import NO_CHOICES, ComponentChoice, RepairChoices


def repair_mesh(
    vertices: ArrayLike,
    faces: ArrayLike | Sequence[Sequence[int]],
    name: str = "",
    component: ComponentChoice | None = None,
    drop_walls: bool = False,
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
        drop_walls: leave out faces that have the solid on both sides, or on neither; else they are refused.

    Raises:
        MeshError: what is wrong cannot be repaired.

    >>> soup = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [9, 9, 9]]
    >>> repair_mesh(soup, [[1, 2, 0], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).notes
    ('1 isolated vertex was dropped.', '1 face wound against its neighbours was turned.')
    """
    return repaired_mesh(
        _soup_of(vertices, faces, name), name, name, RepairChoices(_checked(component), drop_walls)
    )


def repair_meshes(
    vertices: ArrayLike, faces: ArrayLike | Sequence[Sequence[int]], name: str = "", drop_walls: bool = False
) -> tuple[Mesh, ...]:
    """Make a Mesh of each component of vertices and faces, that of the largest volume first.

    Args:
        vertices, faces, name, drop_walls: as in `repair_mesh`.

    Raises:
        MeshError: one of them cannot be repaired.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    >>> two = repair_meshes([*corners, *([4.0 + 2 * x, y, z] for x, y, z in corners)],
    ...                     [*faces, *([4 + a, 4 + b, 4 + c] for a, b, c in faces)], "two")
    >>> [(mesh.name, round(mesh.volume, 3)) for mesh in two]
    [('two, component 1', 0.333), ('two, component 2', 0.167)]
    """
    return repaired_meshes(_soup_of(vertices, faces, name), name, name, RepairChoices(drop_walls=drop_walls))


def repaired_meshes(
    polygons: PolygonSoup, name: str, source: str, choices: RepairChoices
) -> tuple[Mesh, ...]:
    """Make a Mesh of each component of polygons that may need repairs, that of the largest volume first.

    Args:
        polygons, name, source: as in `repaired_mesh`.
        choices: as there; no component is chosen.

    Raises:
        MeshError: one of them has faults that cannot be repaired; it lists them.
    """
    first = validate(polygons, replace(choices, component=1))
    count = len(first.components)
    if count < 2:
        return (repaired_mesh(polygons, name, source, choices),)
    return tuple(
        repaired_mesh(
            polygons, f"{name}, component {one}".lstrip(", "), source, replace(choices, component=one)
        )
        for one in range(1, count + 1)
    )


def repaired_mesh(polygons: PolygonSoup, name: str, source: str, choices: RepairChoices = NO_CHOICES) -> Mesh:
    """Make a Mesh of polygons that may need repairs.

    Args:
        polygons: as they were read.
        name: of the mesh.
        source: what an error names, such as the file.
        choices: what the user decides, such as the component to take.

    Raises:
        MeshError: there are faults that cannot be repaired; it lists them.
    """
    report = validate(polygons, choices)
    if report.fatal:
        raise MeshError.from_report(report, source)
    notes = tuple(finding.note for finding in report.findings)
    if any(finding.kind == "flat_faces" for finding in report.findings):
        # All other checks follow the repairs that could spoil them; flips come late, so all is checked again.
        again = validate(PolygonSoup.of(report.vertices, report.faces), RepairChoices(strict=True))
        if again.repaired:
            raise MeshError.from_report(again, source)
        again.numbering = report.numbering
        report = again
    return Mesh.from_report(report, name, notes)


def _checked(component: ComponentChoice | None) -> ComponentChoice | None:
    if isinstance(component, str) and component != "largest":
        raise MeshError(f"component {component!r}: give its number, 1 for the largest, or 'largest'")
    return component


def _soup_of(vertices: ArrayLike, faces: ArrayLike | Sequence[Sequence[int]], name: str) -> PolygonSoup:
    try:
        return PolygonSoup.of(vertices, faces)
    except (TypeError, ValueError) as error:
        raise MeshError(f"{name}: {error}" if name else str(error)) from error
