"""The commands on slicing planes, without a screen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core import Mesh, Plane, Polygon
from idviewer.session.planes import (
    PlaneCommands,
    active_plane,
    additional_plane,
    axis_of,
    extent_over,
    with_normal,
)
from idviewer.session.state import Frame, Query, State

TILTED = Plane((0.3, 0.1, 0.0), (1.0, 1.0, 1.0))
SQUARE = Polygon(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))


class Owner:
    """Keeps a state as a session does, and notes each call."""

    def __init__(self, state: State) -> None:
        self.state = state
        self.frame: Frame | None = None
        self.calls: list[dict[str, object]] = []

    def set(self, **fields: object) -> None:
        self.calls.append(fields)
        self.state = self.state.with_(**fields)

    @property
    def fraction(self) -> float:
        assert self.state.shape is not None
        return PlaneCommands(self).fraction_of(self.state.shape, self.state.query.planes[0])


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    vertices, faces = shapes.icosphere(2)
    return Mesh(vertices * [2.0, 1.0, 0.5], faces)


@pytest.fixture
def owner(mesh: Mesh) -> Owner:
    return Owner(State(mesh, Query(planes=(Plane.along("z", 0.5, mesh.bounds),), source=(0.1, 0.2, 0.3))))


@pytest.fixture
def commands(owner: Owner) -> PlaneCommands:
    return PlaneCommands(owner)


def test_an_added_plane_is_the_active_one(owner: Owner, commands: PlaneCommands) -> None:
    commands.add()
    commands.add()
    assert sorted(axis_of(plane) or "" for plane in owner.state.query.planes) == ["x", "y", "z"]
    assert owner.state.display.active_plane == 2
    assert commands.active is owner.state.query.planes[2]


def test_the_active_plane_alone_is_removed_and_another_one_becomes_active(
    owner: Owner, commands: PlaneCommands
) -> None:
    commands.add()
    commands.add()
    first, _, third = owner.state.query.planes
    owner.set(active_plane=1)
    commands.remove()
    assert owner.state.query.planes == (first, third)
    assert owner.state.display.active_plane == 1
    commands.remove()
    commands.remove()
    assert owner.state.query.planes == ()
    assert owner.state.display.active_plane == 0
    assert commands.active is None


def test_the_active_plane_alone_is_replaced(owner: Owner, commands: PlaneCommands) -> None:
    commands.add()
    first, second = owner.state.query.planes
    owner.set(active_plane=0)
    commands.replace(TILTED)
    assert owner.state.query.planes == (TILTED, second) != (first, second)


def test_fractions_span_the_shape_along_the_normal(owner: Owner, commands: PlaneCommands, mesh: Mesh) -> None:
    owner.set(planes=(TILTED,))
    for fraction in (0.0, 0.25, 1.0):
        commands.move_to(fraction)
        assert owner.fraction == pytest.approx(fraction, abs=1e-12)
        low, high = extent_over(mesh, owner.state.query.planes[0])
        assert -low == pytest.approx(fraction * (high - low), abs=1e-12)
        assert owner.state.query.planes[0].normal == TILTED.normal


def test_a_nudge_is_a_share_of_the_extent_and_stops_at_the_ends(
    owner: Owner, commands: PlaneCommands
) -> None:
    commands.nudge(0.1)
    assert owner.fraction == pytest.approx(0.6)
    commands.nudge(-0.2)
    assert owner.fraction == pytest.approx(0.4)
    for step in (3.0, -3.0):
        commands.nudge(step)
        assert owner.fraction == pytest.approx(float(step > 0))


def test_a_turned_plane_keeps_its_origin(owner: Owner, commands: PlaneCommands) -> None:
    owner.set(planes=(TILTED,))
    commands.turn_to("y")
    assert owner.state.query.planes == (Plane(TILTED.origin, (0.0, 1.0, 0.0)),)


def test_a_turned_plane_that_would_miss_the_shape_goes_through_its_middle(mesh: Mesh) -> None:
    outside = Plane((5.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert with_normal(mesh, outside, (1.0, 0.0, 0.0)).origin[0] == pytest.approx(0.0)


def test_the_extent_follows_the_shape_and_the_normal(
    owner: Owner, commands: PlaneCommands, mesh: Mesh
) -> None:
    commands.move_to(1.0)
    assert owner.state.query.planes[0].origin[2] == pytest.approx(0.5)
    commands.turn_to("x")
    commands.move_to(1.0)
    assert owner.state.query.planes[0].origin[0] == pytest.approx(2.0)
    owner.state = replace(owner.state, shape=Mesh(3.0 * mesh.vertices, mesh.faces))
    commands.move_to(1.0)
    assert owner.state.query.planes[0].origin[0] == pytest.approx(6.0)


def test_the_next_plane_is_on_the_axis_least_used(mesh: Mesh) -> None:
    given = (Plane((0, 0, 0), (1, 0, 0.1)), Plane((0, 0, 0), (0, 0, 1)))
    assert additional_plane(mesh, given).normal == (0.0, 1.0, 0.0)


def test_the_plane_can_be_put_through_the_source(owner: Owner, commands: PlaneCommands) -> None:
    commands.move_through_source()
    assert owner.state.query.planes == (Plane((0.1, 0.2, 0.3), (0.0, 0.0, 1.0)),)


def test_or_through_the_barycentroid_that_a_frame_of_this_shape_shows(
    owner: Owner, commands: PlaneCommands, mesh: Mesh
) -> None:
    owner.set(source=None)
    before = owner.state.query.planes
    commands.move_through_source()
    assert owner.state.query.planes == before
    centre = np.array([0.4, 0.3, 0.2])
    other = Mesh(mesh.vertices, mesh.faces)
    for shape, origin in ((other, before[0].origin), (mesh, tuple(centre))):
        owner.frame = Frame(shape, owner.state.query, (), 0, True, 0.0, centre, centre, (0.0, 1.0), "")
        commands.move_through_source()
        assert owner.state.query.planes[0].origin == pytest.approx(origin)


def test_a_dragged_plane_cannot_lose_the_shape(owner: Owner, commands: PlaneCommands, mesh: Mesh) -> None:
    for origin, normal in (((0, 0, 9), (0, 0, 1)), ((0, 0, -9), (0, 0, 1)), ((7, 9, 0), (1, 1, 1))):
        commands.drag_to(Plane(origin, normal))
        (plane,) = owner.state.query.planes
        low, high = extent_over(mesh, plane)
        assert low < 0 < high
        assert np.all(np.abs(plane.origin) <= np.abs(mesh.bounds[1]) + 1)


@pytest.mark.parametrize("shape", [None, SQUARE])
def test_without_a_body_nothing_happens(shape: Polygon | None) -> None:
    owner = Owner(State(shape))
    commands = PlaneCommands(owner)
    for command in (commands.add, commands.move_through_source):
        command()
    commands.turn_to("x")
    commands.nudge(0.1)
    commands.move_to(0.5)
    commands.replace(TILTED)
    assert not owner.calls
    assert commands.active is active_plane(owner.state) is None
