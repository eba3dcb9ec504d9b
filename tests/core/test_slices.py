"""Planes, sections, slice meshes and rays."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes, slices_twin
from tests.core.test_mean_value import BODIES, winding_numbers

from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.plane import Plane
from idviewer.core.shapes.rays import Ray, crossings, middle_of_first_chord
from idviewer.core.slices.mesh_sections import Section, section
from idviewer.core.slices.triangulation import edges_of, slice_mesh, spacing_for, split


def random_plane(mesh: Mesh, rng: np.random.Generator) -> Plane:
    origin = mesh.bounds[0] + rng.uniform(0.2, 0.8, 3) * (mesh.bounds[1] - mesh.bounds[0])
    return Plane(tuple(origin), tuple(rng.standard_normal(3)))


def test_the_area_under_all_sections_is_the_volume():
    """Cavalieri: the section's area, integrated along an axis, with Gauss points on each smooth piece."""
    mesh = BODIES["L"]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    heights, shares = (nodes + 1) / 2, weights / 2
    areas = [section(mesh, Plane((0, 0, z), (0.0, 0.0, 1))).area for z in heights]
    assert shares @ areas == pytest.approx(mesh.volume, rel=1e-12)
    tilted = [section(mesh, Plane((0, y, 0), (0.0, 1.0, 0))).area for y in (0.5, 1.5)]
    assert tilted == pytest.approx([2.0, 1.0], rel=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_outline_points_lie_on_the_plane_and_carry_exact_values(name, rng):
    mesh = BODIES[name]
    for _ in range(10):
        plane = random_plane(mesh, rng)
        cut = section(mesh, plane)
        np.testing.assert_allclose(plane.height(cut.points), 0, atol=1e-13 * mesh.diagonal)
        np.testing.assert_allclose(cut.interpolate(mesh.vertices), cut.points, atol=1e-13 * mesh.diagonal)
        assert sum(map(len, cut.loops)) <= len(cut.points)


def awkward_planes(mesh: Mesh, rng: np.random.Generator) -> list[Plane]:
    """At random, near the sides of the bounding box, and through vertices, edges and faces."""
    planes = [random_plane(mesh, rng) for _ in range(5)]
    planes += [Plane.along(axis, share, mesh.bounds) for axis in "xyz" for share in (0.0, 0.01, 1 / 3, 1.0)]
    for vertex in mesh.vertices[rng.integers(len(mesh.vertices), size=4)]:
        planes += [Plane(tuple(vertex), (0, 1.0, 0)), Plane(tuple(vertex), tuple(rng.standard_normal(3)))]
    return planes


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", BODIES)
def test_outlines_equal_those_of_the_slow_twin(name, rng):
    mesh = BODIES[name]
    for plane in awkward_planes(mesh, rng):
        cut = section(mesh, plane)
        points, loops = slices_twin.outline(mesh, plane)
        assert {tuple(edge) for edge in cut.edges.tolist()} == set(points)
        for edge, point in zip(cut.edges.tolist(), cut.points, strict=True):
            np.testing.assert_allclose(point, points[tuple(edge)], atol=1e-14 * mesh.diagonal)
        ours = [list(map(tuple, cut.edges[loop].tolist())) for loop in cut.loops]
        where = {edge: at for at, edge in enumerate(map(tuple, cut.edges.tolist()))}
        theirs = [without_repeats(loop, cut.in_plane, where) for loop in loops]
        assert sorted(map(from_the_smallest, ours)) == sorted(
            from_the_smallest(loop) for loop in theirs if len(loop) >= 3
        )


def without_repeats(loop: list, flat: np.ndarray, where: dict) -> list:
    before = [loop[-1], *loop[:-1]]
    return [
        b for a, b in zip(before, loop, strict=True) if flat[where[a]].tolist() != flat[where[b]].tolist()
    ]


def from_the_smallest(loop: list) -> list:
    first = loop.index(min(loop))
    return loop[first:] + loop[:first]


@pytest.mark.slow
def test_large_and_distant_bodies_are_cut_like_small_ones(rng):
    """No tolerance depends on the unit; far from the origin the boxes allow for the coordinates' rounding."""
    mesh = BODIES["bumpy sphere"]
    for scale, shift in ((2.0**40, 0.0), (2.0**-40, 0.0), (1.0, 2.0**20)):
        moved = Mesh(mesh.vertices * scale + shift, mesh.faces)
        for plane in awkward_planes(moved, rng):
            points, _ = slices_twin.outline(moved, plane)
            assert {tuple(edge) for edge in section(moved, plane).edges.tolist()} == set(points)


@pytest.mark.parametrize("name", ["L", "torus", "bumpy sphere"])
@pytest.mark.parametrize("samples", [30, 300])
def test_nodes_equal_those_of_the_slow_twin(name, samples, rng):
    cut = section(BODIES[name], random_plane(BODIES[name], rng))
    filled = slice_mesh(cut, spacing_for(cut, samples))
    assert set(map(tuple, filled.nodes.tolist())) == slices_twin.lattice_nodes(cut, filled.spacing)


def test_a_plane_that_misses_gives_nothing():
    cut = section(BODIES["cube"], Plane((0, 0, 5.0), (0, 0, 1.0)))
    assert cut.loops == ()
    assert cut.area == 0
    assert len(slice_mesh(cut, 0.1).triangles) == 0


@pytest.mark.parametrize("height", [0.0, 0.5, 1.0])
def test_planes_through_vertices_and_faces_still_close(height):
    """The plane of a face itself counts as touching from outside or as cutting just inside; never half."""
    vertices, faces = shapes.subdivided(*shapes.cube())
    cut = section(Mesh(vertices, faces), Plane((0, 0, height), (0, 0, 1.0)))
    assert cut.area == pytest.approx(1.0 if height < 1 else 0.0, abs=1e-14)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", ["L", "torus", "bumpy sphere"])
@pytest.mark.parametrize("samples", [10, 100, 1000])
def test_slice_meshes_fill_the_section_exactly(name, samples, rng):
    mesh = BODIES[name]
    for _ in range(5):
        cut = section(mesh, random_plane(mesh, rng))
        filled = slice_mesh(cut, spacing_for(cut, samples))
        corners = filled.points[filled.triangles]
        areas = (
            0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ cut.plane.normal
        )
        assert areas.min() >= -1e-15 * cut.area
        assert areas.sum() == pytest.approx(cut.area, rel=1e-9)
        np.testing.assert_allclose(filled.points[: len(cut.in_plane)], cut.points, atol=0)
        if len(filled.nodes):
            assert (winding_numbers(mesh, filled.node_points) > 0.5).all()


def drawn(*rectangles: tuple[float, float, float, float]) -> Section:
    """The section that consists of upright rectangles, (x, y, width, height) each."""
    corners = np.array([[(x, y), (x + w, y), (x + w, y + h), (x, y + h)] for x, y, w, h in rectangles])
    loops = tuple(np.arange(4 * len(corners)).reshape(-1, 4))
    count = 4 * len(corners)
    return Section(
        Plane((0, 0, 0), (0, 0, 1)),
        np.zeros((count, 2), dtype=np.int64),
        np.zeros(count),
        corners.reshape(-1, 2),
        loops,
    )


@pytest.mark.parametrize("size", [1e-2, 1e-5, 1e-10])
def test_specks_far_from_each_other_take_no_more_memory_than_near_ones(size):
    cut = drawn((0, 0, size, size), (1, 1, size, size), (0, 1, size, size))
    filled = slice_mesh(cut, spacing_for(cut, 1000))
    flat = np.concatenate([cut.in_plane, filled.nodes * filled.spacing])
    assert len(filled.nodes) == 0 if size < 1e-9 else 600 < len(filled.nodes) < 1200
    assert signed_areas(flat, filled.triangles).min() >= 0
    assert signed_areas(flat, filled.triangles).sum() == pytest.approx(cut.area, rel=1e-6)


@pytest.mark.parametrize("width", [1e-3, 1e-9, 1e-300])
def test_slivers_get_few_nodes(width):
    cut = drawn((0, 0, 1, width))
    spacing = spacing_for(cut, 1000)
    assert spacing >= 2 / 16 / 1000
    assert len(slice_mesh(cut, spacing).triangles) >= 2


def signed_areas(flat: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(flat[triangles], 1, 0)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def test_cutting_each_triangle_into_four_equals_its_slow_twin(rng):
    cut = section(BODIES["torus"], random_plane(BODIES["torus"], rng))
    triangles = slice_mesh(cut, spacing_for(cut, 100)).triangles
    count = int(triangles.max()) + 1
    ends, edges = edges_of(count, triangles)
    smaller = split(triangles, edges + count)
    sides = sorted(
        {(min(a, b), max(a, b)) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)}
    )
    assert list(map(tuple, ends.tolist())) == sides
    middle = {side: count + at for at, side in enumerate(sides)}
    expected = set()
    for a, b, c in triangles.tolist():
        ab, bc, ca = (middle[min(pair), max(pair)] for pair in ((a, b), (b, c), (c, a)))
        expected |= {(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)}
    assert set(map(tuple, smaller.tolist())) == expected


def test_every_side_but_the_outline_s_is_shared_by_two_triangles(rng):
    cut = section(BODIES["torus"], Plane((0, 0, 0.05), (0.1, 0.2, 1.0)))
    assert len(cut.loops) == 2
    triangles = slice_mesh(cut, spacing_for(cut, 200)).triangles
    sides = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    keys = {tuple(side) for side in sides.tolist()}
    lonely = {(a, b) for a, b in keys if (b, a) not in keys}
    outline = {
        (a, b) for loop in cut.loops for a, b in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)
    }
    assert lonely == outline


def test_finer_lattices_contain_the_coarser_ones(rng):
    for _ in range(10):
        cut = section(BODIES["bumpy sphere"], random_plane(BODIES["bumpy sphere"], rng))
        spacing = spacing_for(cut, 60)
        coarse = {tuple(node) for node in (2 * slice_mesh(cut, spacing).nodes).tolist()}
        fine = {tuple(node) for node in slice_mesh(cut, spacing / 2).nodes.tolist()}
        assert coarse <= fine


def test_refining_keeps_the_area():
    points = np.array([[0.0, 0], [2, 0], [0, 1], [2, 1]])
    triangles = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
    ends, edges = edges_of(len(points), triangles)
    triangles = split(triangles, edges + len(points))
    points = np.concatenate([points, points[ends].mean(axis=1)])
    sides = points[triangles][:, 1:] - points[triangles][:, :1]
    areas = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    np.testing.assert_allclose(areas, 0.5)
    assert len(points) == 9


def test_planes_read_and_write_themselves():
    bounds = np.array([[0.0, 0, 0], [2, 4, 8]])
    assert Plane.parse("y=0.25", bounds) == Plane((1.0, 1.0, 4.0), (0, 1.0, 0))
    plane = Plane.parse("1,2,3/0,3,4", bounds)
    assert plane.normal == (0.0, 0.6, 0.8)
    assert Plane.parse(str(plane), bounds) == plane
    assert plane.moved(5.0).origin == pytest.approx((1, 5, 7))
    np.testing.assert_allclose(plane.basis @ plane.basis.T, np.eye(2), atol=1e-15)
    np.testing.assert_allclose(np.cross(*plane.basis), plane.normal, atol=1e-15)
    assert Plane((0, 0, 0), (0, 0, 1e-200)).normal == (0, 0, 1)


@pytest.mark.parametrize(
    "text", ["", "w=0.5", "x=", "x=nan", "1,2,3", "1,2/0,0,1", "0,0,0/0,0,0", "a,b,c/0,0,1"]
)
def test_planes_that_cannot_be_read_say_how_to_write_them(text):
    with pytest.raises(ValueError, match=r"write x=0\.5") as caught:
        Plane.parse(text, np.array([[0.0, 0, 0], [1, 1, 1]]))
    assert "\n" not in str(caught.value)


def test_rays_cross_a_cube_twice_and_a_shared_edge_once():
    cube = BODIES["cube"]
    met = crossings(cube, Ray((0.3, 0.4, -2.0), (0, 0, 2.0)))
    np.testing.assert_allclose(met.distances, [1.0, 1.5])
    np.testing.assert_allclose(met.points, [[0.3, 0.4, 0], [0.3, 0.4, 1]])
    # Through the middle of a face, where its two triangles meet.
    assert len(crossings(cube, Ray((0.5, 0.5, -2.0), (0, 0, 1.0))).distances) == 2
    assert len(crossings(cube, Ray((5.0, 0.5, -2.0), (0, 0, 1.0))).distances) == 0
    np.testing.assert_allclose(
        middle_of_first_chord(cube, Ray((0.3, 0.4, -2.0), (0, 0, 1.0))), [0.3, 0.4, 0.5]
    )
    np.testing.assert_allclose(
        middle_of_first_chord(cube, Ray((0.3, 0.4, 0.5), (0, 0, 1.0))), [0.3, 0.4, 0.75]
    )
    assert middle_of_first_chord(cube, Ray((5, 5, 5.0), (0, 0, 1.0))) is None


def test_rays_meet_planes():
    plane = Plane((0, 0, 1.0), (0, 0, 1.0))
    assert Ray((0, 0, 3.0), (0, 0, -2.0)).meets(plane) == 1.0
    assert Ray((0, 0, 3.0), (0, 0, 2.0)).meets(plane) is None
    assert Ray((0, 0, 3.0), (1.0, 0, 0)).meets(plane) is None
