"""Every public entry that takes a shape takes its arrays too, through one door."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.core import shapes

import idviewer.core
from idviewer.core import (
    COORDINATES,
    Euclidean,
    InteriorDistance,
    Mesh,
    MeshError,
    Plane,
    Polygon,
    PolygonError,
    ShapeError,
    read_mesh,
    read_polygon,
)
from idviewer.core.shapes.shape import as_mesh, as_polygon, as_shape

MESH = Mesh(*shapes.icosphere(1))
LOOPS = ([0, 1, 2, 3], [4, 5, 6, 7])
POLYGON = Polygon([[0, 0], [4, 0], [4, 4], [0, 4], [1, 1], [2, 1], [2, 2], [1, 2]], LOOPS)
BLOB = Polygon([[0, 0], [4, 0], [5, 2], [4, 4], [0, 4]])

GIVEN: dict[str, tuple[Any, Any]] = {
    "mesh": (MESH, (MESH.vertices.tolist(), MESH.faces)),
    "polygon": (BLOB, BLOB.vertices),
    "polygon with a hole": (POLYGON, (POLYGON.vertices, LOOPS)),
}

INSIDE = {3: [[0.1, 0.2, 0.3], [0.0, -0.1, 0.2]], 2: [[0.5, 0.5], [3.0, 3.0]]}


def points_in(shape: Any) -> list[list[float]]:
    try:
        return INSIDE[as_shape(shape).dimension]
    except ShapeError:  # what is asked is to find that out for itself
        return INSIDE[3]


def distances(shape: Any) -> np.ndarray:
    p, q = points_in(shape)
    return InteriorDistance(shape, Euclidean()).distance([p], [q])


def read_back(polygon: Any, folder: Path) -> np.ndarray:
    idviewer.core.write_polygon(polygon, folder / "polygon.json")
    return read_polygon(folder / "polygon.json").vertices


def mesh_read_back(mesh: Any, folder: Path) -> np.ndarray:
    idviewer.core.write_mesh(mesh, folder / "mesh.ply")
    return read_mesh(folder / "mesh.ply").vertices


CALLS: dict[str, tuple[set[int], Callable[[Any, Path], Any]]] = {
    "InteriorDistance": ({2, 3}, lambda shape, _: distances(shape)),
    "MeanValueCoordinates": (
        {2, 3},
        lambda shape, _: idviewer.core.MeanValueCoordinates(shape).weights(points_in(shape)),
    ),
    "cotangent_laplacian": ({3}, lambda shape, _: idviewer.core.cotangent_laplacian(shape).toarray()),
    "diagnose": ({3}, lambda shape, _: idviewer.core.diagnose(shape).as_dict()),
    "eigenpairs": ({2, 3}, lambda shape, _: idviewer.core.eigenpairs(shape).values),
    "interior_distance": (
        {2, 3},
        lambda shape, _: idviewer.core.interior_distance(shape, *np.split(np.array(points_in(shape)), 2)),
    ),
    "laplacian_of": ({2, 3}, lambda shape, _: idviewer.core.laplacian_of(shape).toarray()),
    "masses_of": ({2, 3}, lambda shape, _: idviewer.core.masses_of(shape)),
    "mean_value_weights": (
        {2, 3},
        lambda shape, _: idviewer.core.mean_value_weights(shape, points_in(shape)),
    ),
    "polygon_laplacian": ({2}, lambda shape, _: idviewer.core.polygon_laplacian(shape).toarray()),
    "polygon_section": ({2}, lambda shape, _: idviewer.core.polygon_section(shape, 0.5).points),
    "section": (
        {3},
        lambda shape, _: idviewer.core.section(shape, Plane((0, 0, 0.1), (0, 0, 1))).points,
    ),
    "unite_mesh": ({3}, lambda shape, _: idviewer.core.unite_mesh(shape).mesh.vertices),
    "voronoi_areas": ({3}, lambda shape, _: idviewer.core.voronoi_areas(shape)),
    "voronoi_lengths": ({2}, lambda shape, _: idviewer.core.voronoi_lengths(shape)),
    "write_mesh": ({3}, mesh_read_back),
    "write_polygon": ({2}, read_back),
}
"""Of each entry: the dimensions in which it works, and a call."""

NO_ENTRIES = {"Coordinates", "Distance", "Union"}
"""Bases, what derives from which is asked below, or takes a shape from a solver; and a result."""


def takes_a_shape(name: str) -> bool:
    entry = getattr(idviewer.core, name)
    if not callable(entry) or name in NO_ENTRIES:
        return False
    try:
        parameters = inspect.signature(entry).parameters.values()
    except ValueError:
        return False
    return any(re.search(r"\b(Mesh|Polygon|Shape)(Like)?\b", str(one.annotation)) for one in parameters)


@pytest.mark.parametrize("name", [name for name in idviewer.core.__all__ if takes_a_shape(name)])
def test_arrays_give_what_the_shape_gives(name: str, tmp_path: Path) -> None:
    assert name in CALLS, "a new entry that takes a shape: let it take arrays, and say here how to call it"
    dimensions, call = CALLS[name]
    for shape, arrays in GIVEN.values():
        if shape.dimension in dimensions:
            np.testing.assert_array_equal(call(arrays, tmp_path), call(shape, tmp_path))


def test_no_entry_is_overlooked() -> None:
    assert {name for name in idviewer.core.__all__ if takes_a_shape(name)} == set(CALLS)


@pytest.mark.parametrize("name", COORDINATES)
@pytest.mark.parametrize("given", GIVEN)
def test_all_coordinates_take_arrays(name: str, given: str) -> None:
    shape, arrays = GIVEN[given]
    points = points_in(shape)
    if shape.dimension in COORDINATES[name].dimensions:
        found = COORDINATES[name](arrays).weights(points)
        np.testing.assert_array_equal(found, COORDINATES[name](shape).weights(points))


OPEN = (MESH.vertices, MESH.faces[1:])
BAD: dict[str, Any] = {
    "an open surface": OPEN,
    "no faces": (MESH.vertices, np.empty((0, 3), dtype=int)),
    "vertices alone": MESH.vertices,
    "points of four numbers": (np.ones((5, 4)), MESH.faces),
    "text": ("vertices", "faces"),
    "a number": 3.0,
    "nothing": None,
    "numbers that are not finite": (np.where(MESH.vertices > 0.8, np.nan, MESH.vertices), MESH.faces),
    "faces beyond the vertices": (MESH.vertices, MESH.faces + 100),
    "a ragged list": [[0.0, 1.0], [2.0]],
}


@pytest.mark.parametrize("name", sorted(CALLS))
@pytest.mark.parametrize("bad", BAD)
def test_bad_arrays_are_refused_in_one_line(name: str, bad: str, tmp_path: Path) -> None:
    dimensions, call = CALLS[name]
    if name == "diagnose":
        return  # it says what is wrong with them
    with pytest.raises(ShapeError if 2 in dimensions else MeshError) as error:
        call(BAD[bad], tmp_path)
    assert "\n" not in str(error.value)


def test_a_crossing_outline_is_refused_as_a_polygon() -> None:
    with pytest.raises(PolygonError, match="cross"):
        as_shape([[0, 0], [1, 1], [1, 0], [0, 1]])


def test_shapes_of_the_other_kind_are_refused() -> None:
    with pytest.raises(MeshError, match="a Mesh, or its"):
        as_mesh(POLYGON)  # type: ignore[arg-type]
    with pytest.raises(PolygonError, match="a Polygon, or its vertices"):
        as_polygon(MESH)
    assert as_shape(MESH) is MESH
