"""Figures 8 and 9: bodies in space, and two tessellations of one."""

from __future__ import annotations

import numpy as np

from figures import flat, solid
from figures.bending import Floats
from figures.registry import Run, Table, figure
from figures.shapes import TINY, body, bundled, inner_points, simplified
from figures.words import number, percent
from idviewer.core import InteriorDistance, Mesh, Plane
from idviewer.session import Query

BODIES: dict[str, tuple[str, int, float, float | None]] = {
    "human": ("y", 2, 1.0, None),
    "human_sitting": ("x", 2, 1.0, None),
    "hand": ("y", 2, 1.0, 0.55),
    "cat": ("x", 1, -1.0, None),
    "octopus": ("z", 0, -1.0, None),
    "couple": ("y", 2, 1.0, None),
}
"""The axis across the plane, the axis and the side of the end that the source is put into, and where the
plane lies (in shares of the box; None for through the barycentroid)."""

INWARD = 0.06
"""How far the source is moved from the end of the section towards the barycentroid."""


def plane_and_source(mesh: Mesh, name: str) -> tuple[Plane, tuple[float, float, float]]:
    """Where a body is cut, and a point of the cut near one of its ends."""
    axis, along, side, share = BODIES[name]
    middle = solid.frame_of(mesh, Query()).barycentroid
    plane = Plane.along(axis, 0.5 if share is None else share, mesh.bounds)
    normal = solid.FRONT if axis == "y" else plane.normal
    plane = solid.cut(plane.origin if share is not None else middle, normal)
    points = solid.frame_of(mesh, Query(planes=(plane,))).slices[0].points
    end = points[np.argmax(side * points[:, along])]
    x, y, z = (end + INWARD * (middle - end)).tolist()
    return plane, (x, y, z)


@figure("8", "six bodies")
def six(run: Run) -> Table:
    """A slice of each, with the distance from one of its ends."""
    pictures, rows = [], []
    for name in list(BODIES)[: 3 if run.tiny else None]:
        mesh = body(run, name)
        plane, source = plane_and_source(mesh, name)
        pixels, frame = solid.picture(run, mesh, Query(planes=(plane,), source=source), 460)
        pictures.append(pixels)
        rows.append([name.replace("_", ", "), f"{len(mesh.vertices):,}", *numbers(run, mesh, source)])
        assert frame.exact
    solid.draw_rows(run, "8", [row[0] for row in rows], pictures, 3)
    header = (
        "body",
        "vertices",
        "eigenpairs",
        "largest d inside / on the surface",
        "sum of negative weights, mean",
    )
    return Table(header, rows)


def numbers(run: Run, mesh: Mesh, source: tuple[float, float, float]) -> list[str]:
    """Eigenpairs, how far values inside exceed those on the surface, and how common negative weights are."""
    solver = InteriorDistance(mesh)
    points = inner_points(mesh, 50 if run.tiny else 1000)
    inside = solver.field(source, points)
    at = np.linalg.norm(solver.boundary.embedding - solver.embed([source]), axis=1)
    negative = np.nanmean(solver.coordinates.negativity(points))
    return [
        f"{len(solver.spectrum.values)}",
        f"{np.nanmax(inside) / at.max():.3f}",
        f"{negative:.3f}",
    ]


@figure("9", "two tessellations")
def tessellation(run: Run) -> Table:
    """One body with 9,000 vertices and with 1,500, simplified from the finest bundled one."""
    fine = body(run, "human") if run.tiny else bundled("human_27k")
    counts = (TINY - 50, TINY - 150) if run.tiny else (9000, 1500)
    meshes = [simplified(fine, count) for count in counts]
    plane, source = plane_and_source(meshes[0], "human")
    query = Query(planes=(plane,), source=source)
    pictures = [solid.picture(run, mesh, query, 620, fine.vertices)[0] for mesh in meshes]
    drawing, axes = flat.row_of(2, 4.0, 6.4)
    for place, pixels, count in zip(axes[0], solid.cropped(pictures), counts, strict=True):
        solid.show_pixels(place, pixels)
        flat.title(place, f"{count:,} vertices")
    run.save(drawing, "9")
    return compared([fine, *meshes])


def compared(meshes: list[Mesh]) -> Table:
    """How much distances between random pairs of inner points differ from those in the first body."""
    points = inner_points(meshes[0], 600)
    pairs: list[Floats] = []
    for mesh in meshes:
        images = InteriorDistance(mesh).embed(points)
        pairs.append(np.linalg.norm(images[:300] - images[300:], axis=1))
    rows = []
    for first, second in ((0, 1), (0, 2), (1, 2)):
        both = np.isfinite(pairs[first]) & np.isfinite(pairs[second])
        before, after = pairs[first][both], pairs[second][both]
        change = np.abs(after - before)
        names = [number(len(meshes[each].vertices)) for each in (first, second)]
        rows.append(
            [
                " against ".join(names),
                percent(change.mean() / before.mean()),
                percent(change.max() / before.max()),
            ]
        )
    header = ("vertices", "mean change of d", "largest, of the largest d")
    return Table(header, rows, "300 random pairs of points inside, the same in all three.")
