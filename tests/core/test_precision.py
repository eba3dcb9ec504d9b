"""What is left of the precision of coordinates far from the origin."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes
from tests.core.voxels import box, voxel_surface

from idviewer.core import diagnose, repair_mesh


def moved_sphere(*offset: float, size: float = 5.0):
    vertices, faces = shapes.icosphere(2)
    return vertices * size + np.array(offset), faces


def test_single_precision_far_from_the_origin_is_told():
    vertices, faces = moved_sphere(450_000.0, 5_200_000.0, 120.0)
    single = vertices.astype(np.float32).astype(float)
    mesh = repair_mesh(single, faces)
    (note,) = mesh.notes
    assert note.startswith("Coordinates in single precision, far from the origin and so rounded to 0.5 (")
    found = diagnose(single, faces)
    assert (found.precision.bits, found.precision.step) == (32, 0.5)
    # What rounding did is what is told.
    assert np.abs(single - vertices).max() == pytest.approx(0.25, rel=0.1)
    assert found.precision.of_size == pytest.approx(0.5 / (10.0 * 3**0.5), rel=0.05)
    assert found.as_dict()["precision"]["rounded"]
    assert repair_mesh(vertices, faces).notes == ()


def test_double_precision_has_its_end_too():
    mesh = repair_mesh(*moved_sphere(3e14, 0.0, 0.0))
    assert "Coordinates in double precision" in mesh.notes[0]


@pytest.mark.parametrize(
    "arrays",
    [
        moved_sphere(0.0, 0.0, 0.0),
        moved_sphere(0.0, 0.0, 0.0, size=1e-9),
        (np.float32(moved_sphere(0, 0, 0)[0]).astype(float), moved_sphere(0, 0, 0)[1]),
        (voxel_surface(box(3, 3, 3))[0] + 2.0**22, voxel_surface(box(3, 3, 3))[1]),  # whole numbers
    ],
)
def test_what_is_precise_enough_is_not_mentioned(arrays):
    assert diagnose(*arrays).findings == ()
