"""Camera poses, the moves a mouse makes with them, and what a pixel sees. Only arithmetic."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idviewer.core.arrays import in_space
from idviewer.core.shapes import Ray

Vector = NDArray[np.float64]
View = Literal["front", "back", "left", "right", "top", "bottom"]

UNIT_VECTORS = np.eye(3)
FILL_MARGIN = 1.08
"""Free space around a shape that fills the window."""
VIEW_ANGLE_DEGREES = 30.0
"""Vertical field of view in degrees; in a parallel projection, that of the focal point's depth."""
NEAREST_IN_DIAGONALS, FARTHEST_IN_DIAGONALS = 0.02, 20.0
"""Smallest and largest distance of the camera, in lengths of the bounding box's diagonal."""


@dataclass(frozen=True)
class Pose:
    """A camera at `position` that looks at `focal`, with `up` towards the upper edge of the picture."""

    position: Vector
    focal: Vector
    up: Vector

    @property
    def distance(self) -> float:
        """Distance from the camera to the focal point."""
        return float(np.linalg.norm(self.position - self.focal))

    @property
    def half_height(self) -> float:
        """Half the height seen at the focal point's depth; in a parallel projection, at any depth."""
        return self.distance * float(np.tan(np.radians(VIEW_ANGLE_DEGREES / 2)))

    @property
    def axes(self) -> tuple[Vector, Vector, Vector]:
        """Unit vectors to the right, upwards, and backwards (towards the eye)."""
        back = unit(self.position - self.focal)
        right = unit(cross(self.up, back))
        return right, cross(back, right), back


@dataclass(frozen=True)
class Projection:
    """Projection of the window: world to pixels and back.

    Pixels are Qt's, device-independent, counted from the upper left corner; a mouse position names a pixel's
    corner in device pixels, and the ray goes through that pixel's middle.

    Attributes:
        matrix: (4, 4) from world to clip coordinates.
        width: of the picture in device pixels.
        height: of the picture in device pixels.
        scale: device pixels in one device-independent pixel.
    """

    matrix: NDArray[np.float64]
    width: int
    height: int
    scale: float = 1.0

    def ray(self, x: float, y: float) -> Ray:
        """The line of sight through the pixel at (x, y)."""
        near, far = self._unproject(np.array([[x, y, -1.0], [x, y, 1.0]]))
        return Ray(tuple(near), tuple(unit(far - near)))

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Project positions (p, 3) to pixels (p, 2)."""
        return self._to_pixels(points)[:, :2]

    def pixel_size(self, point: ArrayLike) -> float:
        """Length of a device-independent pixel's side at the depth of point (3,)."""
        depth = self.matrix[3, :3] @ np.asarray(point, float) + self.matrix[3, 3]
        return float(2 * self.scale * depth / (self.width * np.linalg.norm(self.matrix[0, :3])))

    def _to_pixels(self, points: ArrayLike) -> NDArray[np.float64]:
        points = np.asarray(points, float)
        clip = np.column_stack([points, np.ones(len(points))]) @ self.matrix.T
        ndc = clip[:, :3] / clip[:, 3:]
        x = ((ndc[:, 0] + 1) / 2 * self.width - 0.5) / self.scale
        y = ((1 - ndc[:, 1]) / 2 * self.height - 0.5) / self.scale
        return np.column_stack([x, y, ndc[:, 2]])

    def _unproject(self, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
        x = (pixels[:, 0] * self.scale + 0.5) / self.width * 2 - 1
        y = 1 - (pixels[:, 1] * self.scale + 0.5) / self.height * 2
        clip = np.column_stack([x, y, pixels[:, 2], np.ones(len(pixels))])
        world = np.linalg.solve(self.matrix, clip.T).T
        return world[:, :3] / world[:, 3:]


def unit(vector: ArrayLike) -> Vector:
    """The vector with length 1.

    >>> unit([0.0, 3.0, 4.0])
    array([0. , 0.6, 0.8])
    """
    vector = np.asarray(vector, float)
    return vector / np.linalg.norm(vector)


def cross(a: Vector, b: Vector) -> Vector:
    """The cross product of two vectors (3,): numpy's takes ten times as long, and each draw needs several.

    >>> cross(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]))
    array([-3.,  6., -3.])
    """
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def rotate(vectors: ArrayLike, axis: ArrayLike, angle: float) -> Vector:
    """Vectors (..., 3) turned around an axis by an angle in radians (Rodrigues' formula)."""
    vectors, axis = np.asarray(vectors, float), unit(axis)
    along = (vectors @ axis)[..., None] * axis
    return along + np.cos(angle) * (vectors - along) + np.sin(angle) * np.cross(axis, vectors)


def nearest_axis(vector: ArrayLike) -> Vector:
    """The one of the six coordinate directions that is closest.

    >>> nearest_axis([0.1, -0.9, 0.3])
    array([-0., -1., -0.])
    """
    vector = np.asarray(vector, float)
    largest = int(np.argmax(np.abs(vector)))
    return UNIT_VECTORS[largest] * np.sign(vector[largest])


def orbit(pose: Pose, pole: Vector, yaw: float, pitch: float) -> Pose:
    """The pose turned around its focal point like a globe on a stand: pole stays upright, nothing rolls."""
    arm, up = rotate([pose.position - pose.focal, pose.up], pole, yaw)
    turned = Pose(pose.focal + arm, pose.focal, up)
    right, up, back = turned.axes
    elevation = np.arctan2(back @ pole, up @ pole)
    pitch = float(np.clip(elevation + pitch, -np.pi / 2, np.pi / 2) - elevation)
    arm, up = rotate([arm, up], right, -pitch)
    return Pose(pose.focal + arm, pose.focal, up)


def pan(pose: Pose, right: float, up: float) -> Pose:
    """The pose shifted sideways by these lengths."""
    shift = right * pose.axes[0] + up * pose.axes[1]
    return replace(pose, position=pose.position + shift, focal=pose.focal + shift)


def zoom(pose: Pose, factor: float, fixed: Vector, size: float) -> Pose:
    """The pose brought nearer to a point that keeps its place in the picture.

    factor multiplies the distance; size is the shape's, and bounds how near and how far the camera may go.
    """
    factor = (
        float(np.clip(pose.distance * factor, NEAREST_IN_DIAGONALS * size, FARTHEST_IN_DIAGONALS * size))
        / pose.distance
    )
    position, focal = (fixed + factor * (point - fixed) for point in (pose.position, pose.focal))
    return Pose(position, focal, pose.up)


def upright(direction: Vector, pole: Vector) -> Vector:
    """The up vector of a view along direction that keeps pole upright, also when it looks along the pole."""
    direction = unit(direction)
    up = pole - (pole @ direction) * direction
    if np.linalg.norm(up) > 1e-6:
        return unit(up)
    # Seen from above, the shape's front is at the bottom of the picture; from below, at its top.
    return -np.sign(pole @ direction) * view_direction("front", pole)


def view_direction(view: View, pole: Vector) -> Vector:
    """The direction of an axis view, for shapes that stand along the pole: -z for front if y is up."""
    right = UNIT_VECTORS[1] if abs(pole[0]) > 0.5 else UNIT_VECTORS[0]
    front = cross(pole, right)  # from the shape's front into the picture
    ways = {"front": front, "right": -right, "top": -pole, "back": -front, "left": right, "bottom": pole}
    return ways[view]


def look(direction: Vector, up: Vector, points: Vector, angle: float, aspect: float) -> Pose:
    """The pose that looks along direction and has the points, (p, 3) or a polygon's (p, 2), fill the picture.

    angle is the vertical field of view in radians, aspect the picture's width over its height.
    """
    points = in_space(points)
    corner = points.min(0)
    axes = np.array(Pose(corner - unit(direction), corner, up).axes)
    extent = (points - corner) @ axes.T
    middle = (extent.min(0) + extent.max(0)) / 2
    wide, tall, near = (extent - middle).T
    tangent = np.tan(angle / 2)
    distance = near + FILL_MARGIN * np.maximum(np.abs(wide) / (tangent * aspect), np.abs(tall) / tangent)
    focal = corner + middle @ axes
    return Pose(focal + distance.max() * axes[2], focal, axes[1])
