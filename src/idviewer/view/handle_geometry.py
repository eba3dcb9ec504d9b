"""The plane handle without any window: where its parts are on the screen, and what dragging them does.

An arrow along the plane's normal pushes the plane, a ring in the plane turns it, and the small ring in the
middle moves the handle within the plane. It keeps its size on the screen. Pixels are device-independent.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from idviewer.core import Plane
from idviewer.view.camera import Projection, cross, rotate, unit

RING_RADIUS_PX = 64.0
"""The ring's, in pixels."""
ARROW_HALF_LENGTH = 1.6
"""The arrow's half length, in ring radii."""
MOVE_RING_RADIUS, ARROW_START = 0.22, 0.42
"""The small ring's radius and where the arrow begins, in ring radii; the middle is free for the source."""
MAX_PART_DISTANCE = 2.2
"""No part is farther from the middle on the screen, in ring radii, also where it comes near to the eye."""
GRAB_DISTANCE_PX = 7.0
"""Largest distance, in pixels, at which the mouse hits a part."""
MIN_ARROW_SINE = 0.2
"""Below this sine between the line of sight and the normal, the arrow would be a dot, and there is none."""

_RING_ANGLES = np.linspace(0.0, 2 * np.pi, 73)
_SNAP_NORMALS = np.array(
    [[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)], float
)
_SNAP_NORMALS /= np.linalg.norm(_SNAP_NORMALS, axis=1, keepdims=True)


class Part(Enum):
    """Parts of the handle that can be grabbed."""

    PUSH = "push"
    TURN = "turn"
    MOVE = "move"


@dataclass(frozen=True)
class Handle:
    """The handle of a plane as one projection shows it; eye (3,) is where it is looked from."""

    plane: Plane
    projection: Projection
    eye: NDArray[np.float64]
    up: NDArray[np.float64]

    @cached_property
    def origin(self) -> NDArray[np.float64]:
        """(3,) of the plane."""
        return np.array(self.plane.origin)

    @cached_property
    def normal(self) -> NDArray[np.float64]:
        """(3,) of the plane."""
        return np.array(self.plane.normal)

    @cached_property
    def radius(self) -> float:
        """The ring's, in the mesh's unit."""
        return RING_RADIUS_PX * self.projection.pixel_size(self.origin)

    @cached_property
    def ring(self) -> NDArray[np.float64]:
        """Positions (73, 3) around the ring; the last is the first."""
        circle = np.column_stack([np.cos(_RING_ANGLES), np.sin(_RING_ANGLES)]) @ np.asarray(self.plane.basis)
        return self.origin + self.radius * circle

    @cached_property
    def arrow(self) -> NDArray[np.float64]:
        """Positions (2, 3) of the arrow's ends; the normal points to the second."""
        return self.origin + np.outer([-1.0, 1.0], ARROW_HALF_LENGTH * self.radius * self.normal)

    @cached_property
    def sight(self) -> NDArray[np.float64]:
        """Unit vectors (3, 3) at the origin: to the right, upwards, towards the eye."""
        back = unit(self.eye - self.origin)
        right = unit(cross(self.up, back))
        return np.array([right, cross(back, right), back])

    @cached_property
    def foreshortened(self) -> bool:
        """Whether the arrow would point so much to the eye that it hid the middle."""
        return float(np.linalg.norm(cross(self.sight[2], self.normal))) < MIN_ARROW_SINE

    def part_at(self, x: float, y: float) -> Part | None:
        """The part under the mouse."""
        mouse = np.array([x, y])
        middle = self.projection.project([self.origin])[0]
        away = np.linalg.norm(mouse - middle)
        if away < MOVE_RING_RADIUS * RING_RADIUS_PX + 1:
            return Part.MOVE
        if away > MAX_PART_DISTANCE * RING_RADIUS_PX:
            return None
        if (
            not self.foreshortened
            and _to_polyline(mouse, self.projection.project(self.arrow))[0] < GRAB_DISTANCE_PX
        ):
            return Part.PUSH
        if _to_polyline(mouse, self.projection.project(self.ring))[0] < GRAB_DISTANCE_PX:
            return Part.TURN
        return None

    def grab(self, part: Part, x: float, y: float) -> Drag:
        """Begin a drag of the part that was grabbed at (x, y)."""
        moves = {Part.PUSH: self._push, Part.MOVE: self._move, Part.TURN: self._turn}
        return moves[part](np.array([x, y]))

    def _push(self, start: NDArray[np.float64]) -> Drag:
        grabbed = self._height_under(start)

        def push(x: float, y: float, snap: bool = False) -> Plane:
            return self._moved((self._height_under(np.array([x, y])) - grabbed) * self.normal)

        return push

    def _height_under(self, mouse: NDArray[np.float64]) -> float:
        """Height over the origin of the point on the normal's line that is closest to the mouse's ray."""
        ray = self.projection.ray(*mouse)
        direction, apart = np.array(ray.direction), self.origin - np.array(ray.origin)
        cosine = direction @ self.normal
        return float((cosine * (direction @ apart) - self.normal @ apart) / (1 - cosine**2))

    def _move(self, start: NDArray[np.float64]) -> Drag:
        edge_on = abs(self.sight[2] @ self.normal) < MIN_ARROW_SINE
        facing = self.sight[2] if edge_on else self.normal

        def shift(x: float, y: float, snap: bool = False) -> Plane:
            way = self._on(facing, np.array([x, y])) - self._on(facing, start)
            return self._moved(way - (way @ self.normal) * self.normal)

        return shift

    def _on(self, facing: NDArray[np.float64], mouse: NDArray[np.float64]) -> NDArray[np.float64]:
        """The point where the mouse's ray meets the plane through the origin that faces that way."""
        ray = self.projection.ray(*mouse)
        start, direction = np.array(ray.origin), np.array(ray.direction)
        # A ray that (almost) misses the plane would send the handle to the horizon.
        slope = float(direction @ facing)
        slope = math.copysign(max(abs(slope), MIN_ARROW_SINE / 4), slope)
        return start + (facing @ (self.origin - start)) / slope * direction

    def _turn(self, start: NDArray[np.float64]) -> Drag:
        """The grabbed point of the ring moves on a sphere around the origin, laid on_disc on the screen.

        The map is the azimuthal equidistant one: a ring radius on the screen is a right angle everywhere, so
        the plane turns at one speed, and past the sphere's rim it goes on behind.
        """
        _, nearest = _to_polyline(start, self.projection.project(self.ring))
        grabbed = self.sight @ unit(self.ring[nearest] - self.origin)
        side = 1.0 if grabbed[2] >= 0 else -1.0
        on_disc = _to_disc(grabbed, side)

        def turn(x: float, y: float, snap: bool = False) -> Plane:
            moved = on_disc + (np.array([x, y]) - start) * [1, -1] / RING_RADIUS_PX
            to = _from_disc(moved, side)
            axis = cross(grabbed, to)
            angle = np.arctan2(np.linalg.norm(axis), grabbed @ to)
            if np.linalg.norm(axis) < 1e-9:  # not moved at all, or to the opposite point, around whatever
                axis = np.array([-grabbed[1], grabbed[0], 1e-9])
            normal = rotate(self.normal, axis @ self.sight, float(angle))
            return Plane(self.plane.origin, tuple(_snapped(normal) if snap else normal))

        return turn

    def _moved(self, way: NDArray[np.float64]) -> Plane:
        return Plane(tuple(self.origin + way), self.plane.normal)


Drag = Callable[..., Plane]
"""From a mouse position (x, y) and whether to snap to the axes and their diagonals, to the plane it means."""


def _to_polyline(point: NDArray[np.float64], line: NDArray[np.float64]) -> tuple[float, int]:
    """Distance of point (2,) to a line (p, 2), and the index of the closest of its points."""
    start, way = line[:-1], np.diff(line, axis=0)
    length = np.maximum((way**2).sum(1), 1e-12)
    share = np.clip(((point - start) * way).sum(1) / length, 0, 1)
    apart = np.linalg.norm(start + share[:, None] * way - point, axis=1)
    return float(apart.min()), int(np.argmin(np.linalg.norm(line - point, axis=1)))


def _to_disc(vector: NDArray[np.float64], side: float) -> NDArray[np.float64]:
    """A unit vector to the disc around the line of sight, seen from the side that it is on."""
    angle = np.arctan2(np.linalg.norm(vector[:2]), side * vector[2])
    return vector[:2] / max(float(np.linalg.norm(vector[:2])), 1e-12) * angle / (np.pi / 2)


def _from_disc(on_disc: NDArray[np.float64], side: float) -> NDArray[np.float64]:
    """The inverse of `_to_disc`."""
    radius = float(np.linalg.norm(on_disc))
    angle = radius * np.pi / 2
    return np.array([*(on_disc / max(radius, 1e-12) * np.sin(angle)), side * np.cos(angle)])


def _snapped(normal: NDArray[np.float64]) -> NDArray[np.float64]:
    return _SNAP_NORMALS[np.argmax(_SNAP_NORMALS @ normal)]
