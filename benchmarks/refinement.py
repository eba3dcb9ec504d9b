"""Bodies as CAD programs tessellate them, refined by themselves, beside meshes that are cut evenly."""

from __future__ import annotations

from collections.abc import Iterator

import manifold3d
import numpy as np
from bodies import SEED
from settings import Settings
from table import Bar, Row
from timing import take_turns

from idviewer.core import Diffusion, InteriorDistance, Mesh
from idviewer.core.interior.barycentroid import interior_samples
from idviewer.core.shapes.mesh_refinement import refined_arrays

TITLE = "Coarse bodies: refined for the modes that count, and solved"
NOTE = (
    "Boxes of 12 triangles, an L, a cylinder with 96 sides, a plate with holes, and a needle. Beside it the "
    "mesh whose edges are all cut to the same length. The error is the largest "
    "difference of a distance to that on a mesh of sixteen times as many vertices, as a share of the largest."
)
Solid = manifold3d.Manifold
ACCURACY = 0.01
"""Largest difference to the finer mesh, as a share of the largest distance."""

FINER = 0.25
"""Of the edges' length: sixteen times as many vertices."""


def rows(settings: Settings) -> Iterator[Row]:
    for body in bodies():
        yield _row(body, settings)


def _row(body: Mesh, settings: Settings) -> Row:
    solver = InteriorDistance(body)
    resolved = solver.boundary.resolved
    distance = Diffusion(solver.boundary.distance.resolved_time(float(solver.spectrum.values[0])))
    length = resolved.edge_length
    assert length is not None

    def evenly_cut() -> InteriorDistance:
        even = Mesh(*refined_arrays(body.vertices, body.faces, length, exchanging=False))
        return InteriorDistance(even, refine="no")

    count = len(evenly_cut().shape.vertices)
    own, beside = take_turns(min(settings.turns, 3), lambda: InteriorDistance(body), evenly_cut)
    finer = InteriorDistance(body, distance, refine=FINER * length)
    counts = f"{len(body.vertices):,} -> {len(solver.shape.vertices):,} vertices"
    return Row(
        f"{len(solver.spectrum.values)} modes, {counts}",
        body.name,
        own,
        "s",
        beside=(f"{count:,} vertices", beside),
        error=difference(solver, finer),
        bar=Bar(1.0, ACCURACY, ratio=True),
    )


def difference(solver: InteriorDistance, finer: InteriorDistance) -> float:
    """Largest difference of a distance between points inside and vertices, as a share of the largest."""
    given = solver.boundary.full_shape
    inside, generator = interior_samples(given), np.random.default_rng(SEED)
    some = generator.permutation(len(inside))[:60]
    corners = given.vertices[generator.integers(0, len(given.vertices), 20)]
    points = np.concatenate([inside[some], corners])
    first, second = np.triu_indices(len(points), 1)
    here, there = (one.embed(points) for one in (solver, finer))
    here, there = (np.linalg.norm(rows[first] - rows[second], axis=1) for rows in (here, there))
    return float(np.nanmax(np.abs(here - there)) / np.nanmax(there))


def bodies() -> Iterator[Mesh]:
    """CAD-like bodies, the simplest first."""
    yield _mesh(Solid.cube((1, 1, 1)), "cube")
    yield _mesh(Solid.cube((8, 1, 1)), "bar")
    yield _mesh(Solid.cube((3, 1, 1)) + Solid.cube((1, 2, 1)), "L")
    yield _mesh(Solid.cylinder(3, 1, 1, 96), "cylinder")
    plate = Solid.cube((10, 6, 1))
    for x, y, radius in ((2, 2, 1), (5, 3, 1.2), (8, 4, 0.8), (8, 1.5, 0.5), (2, 4.5, 0.6)):
        plate -= Solid.cylinder(3, radius, radius, 48).translate((x, y, -1))
    yield _mesh(plate, "plate")
    yield _mesh(Solid.cube((1e4, 1, 1)), "needle")


def _mesh(solid: manifold3d.Manifold, name: str) -> Mesh:
    made = solid.to_mesh64()
    return Mesh(np.array(made.vert_properties)[:, :3], np.array(made.tri_verts).astype(int), name)
