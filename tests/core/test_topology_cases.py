"""Kinds of topology that files bring, each as its program would write it, with what is right for it."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.voxels import box, emptied, voxel_surface

from idviewer.core import InteriorDistance, Mesh, MeshError, Repairs, eigenpairs, repair_mesh
from idviewer.core.coordinates import mean_value_weights
from idviewer.core.shapes import crossings
from idviewer.core.shapes.rays import Ray


def gaping_sphere(width):
    """A soup of facets whose corners differ by up to a width, as single-precision exporters write it."""
    vertices, faces = shapes.soup(shapes.icosphere(2))
    return vertices + np.random.default_rng(3).uniform(-width, width, vertices.shape), faces


def needle(aspect):
    """A box of side 1 and length `aspect`, of slender triangles along it."""
    vertices, faces = voxel_surface(box(12, 1, 1))
    return vertices * [aspect / 12.0, 1.0, 1.0], faces


def test_a_gap_offers_the_weld_that_closes_it():
    with pytest.raises(MeshError, match=r"--weld \S+") as caught:
        repair_mesh(*gaping_sphere(1e-5))
    assert "\n" not in str(caught.value)
    mesh = repair_mesh(*gaping_sphere(1e-5), repairs=Repairs(weld=1e-4))
    assert mesh.volume == pytest.approx(Mesh(*shapes.icosphere(2)).volume, rel=1e-4)
    assert len(mesh.vertices) == 162


def test_a_needle_loads_with_its_volume():
    mesh = repair_mesh(*needle(1e4))
    assert mesh.volume == pytest.approx(1e4)
    assert eigenpairs(mesh, k=1).values[0] > 0.0


def test_points_in_a_void_are_outside_for_rays_and_weights():
    mesh = repair_mesh(*voxel_surface(emptied(box(3, 3, 3), (1, 1, 1))))
    inside = np.isfinite(mean_value_weights(mesh, [[1.5, 1.5, 1.5], [0.5, 1.5, 1.5]])).all(axis=1)
    assert inside.tolist() == [False, True]
    met = crossings(mesh, Ray((-1.0, 1.4, 1.6), (1.0, 0.0, 0.0)))
    np.testing.assert_allclose(met.distances, [1.0, 2.0, 3.0, 4.0], atol=1e-9)


@pytest.mark.slow
def test_the_barycentroid_of_a_hollow_body_lies_in_its_solid():
    mesh = repair_mesh(*shapes.subdivided(*voxel_surface(emptied(box(3, 3, 3), (1, 1, 1)))))
    solver = InteriorDistance(mesh)
    point = solver.barycentroid().point
    assert bool(solver.contains([point])[0])
    assert not np.all((point > 1.0) & (point < 2.0))
    assert np.isfinite(solver.distance([point], mesh.vertices[[0]])).all()
