"""Polygons of any shape and size become triangles that lose nothing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.validation.polygon_soup import PolygonSoup, triangulated


def _zigzag(teeth: int) -> list[tuple[float, float]]:
    upper = [(float(i), 2.0 if i % 2 else 1.0) for i in range(2 * teeth, -1, -1)]
    return [(0.0, 0.0), (2.0 * teeth, 0.0), *upper]


def _star(points: int) -> list[tuple[float, float]]:
    angles = np.pi * np.arange(2 * points) / points
    radii = np.where(np.arange(2 * points) % 2, 0.3, 1.0)
    return [(float(r * np.cos(a)), float(r * np.sin(a))) for r, a in zip(radii, angles, strict=True)]


def _area(outline: list[tuple[float, float]]) -> float:
    x, y = np.array(outline).T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2)


OUTLINES = {
    "L": shapes.L_OUTLINE,
    "comb": _zigzag(5),
    "star": _star(7),
    "arrow": [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)],
    "straight corners": [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0), (0.0, 2.0)],
    "U": [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (2.0, 3.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)],
}


@pytest.mark.parametrize("outline", OUTLINES.values(), ids=list(OUTLINES))
@pytest.mark.parametrize("seed", range(4))
def test_concave_polygons_in_any_position_keep_their_area_and_volume(outline, seed):
    vertices, polygons = shapes.extruded(outline, height=2.0)
    rng = np.random.default_rng(seed)
    rotation = np.linalg.qr(rng.standard_normal((3, 3)))[0] if seed else np.eye(3)
    rotation *= np.sign(np.linalg.det(rotation))
    start = int(rng.integers(len(outline)))
    polygons = [polygon[start % len(polygon) :] + polygon[: start % len(polygon)] for polygon in polygons]
    mesh = repair_mesh(vertices @ rotation.T * 1e-9, polygons)
    assert mesh.volume == pytest.approx(2 * _area(outline) * 1e-27, rel=1e-12)
    perimeter = np.linalg.norm(np.diff(np.array([*outline, outline[0]]), axis=0), axis=1).sum()
    assert mesh.area == pytest.approx((2 * _area(outline) + 2 * perimeter) * 1e-18, rel=1e-12)
    assert len(mesh.vertices) == len(vertices)
    assert not any("wound" in note or "inside out" in note for note in mesh.notes)


def test_a_polygon_of_k_corners_gives_k_minus_2_triangles_whatever_its_shape():
    rng = np.random.default_rng(3)
    for size in (4, 5, 8, 20):
        for points in (
            rng.standard_normal((size, 3)),
            np.zeros((size, 3)),
            np.outer(np.arange(size), [1.0, 2, 3]),
        ):
            triangles = triangulated(PolygonSoup.of(points, [list(range(size))]))
            assert triangles.shape == (size - 2, 3)
            # Inner edges are met twice, the polygon's sides once and in their direction: nothing is lost.
            sides = {side for t in triangles.tolist() for side in zip(t, t[1:] + t[:1], strict=True)}
            outer = {side for side in sides if side[::-1] not in sides}
            assert outer == {(i, (i + 1) % size) for i in range(size)}


def test_triangles_come_in_the_order_of_their_polygons():
    vertices, quads = shapes.cube_quads()
    mixed = [quads[0].tolist(), quads[1, :3].tolist(), quads[1, [0, 2, 3]].tolist(), *quads[2:].tolist()]
    owners = triangulated(PolygonSoup.of(vertices, mixed))
    assert owners[2].tolist() == mixed[1]
    assert owners[3].tolist() == mixed[2]
    assert repair_mesh(vertices, mixed).volume == 1.0
