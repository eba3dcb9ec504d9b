"""Picking: points of slices and of the body under the mouse, and the values there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from idviewer.core import Mesh, Polygon, Shape
from idviewer.core.arrays import Floats
from idviewer.core.sampling import POLYGON_PLANE, SliceValues
from idviewer.core.shapes import Ray, crossings, middle_of_first_chord
from idviewer.session.state import Frame

_LEFT, _RIGHT, _BELOW, _ABOVE = np.array([1, 2, 4, 8], np.uint8)
Target = Literal["slice-or-body", "surface", "chord"]


@dataclass(frozen=True)
class Probe:
    """A point of a slice and the value shown there."""

    point: Floats
    value: float


class FramePicker:
    """Finds points of one frame's slices under rays."""

    def __init__(self, frame: Frame) -> None:
        self._locators = [_Locator(one) for one in frame.slices]

    def probe(self, ray: Ray) -> Probe | None:
        """The nearest point of any slice along the ray, with the value shown there."""
        found: list[tuple[float, Probe]] = []
        for locator in self._locators:
            distance = ray.meets(locator.slice.plane)
            if distance is not None:
                value = locator.value_at(point := ray.at(distance))
                if value is not None:
                    found.append((distance, Probe(point, value)))
        return min(found, key=lambda pair: pair[0])[1] if found else None


def pick(shape: Shape, picker: FramePicker | None, ray: Ray, target: Target) -> Floats | None:
    """The point (3,) that a click means.

    "slice-or-body" is the point of a slice, or of the body's near surface where no slice lies under the
    ray; "surface" is the near surface in any case; "chord" the middle of the first stretch inside. In a
    polygon it is the point under the mouse, whatever the target; None outside.
    """
    if isinstance(shape, Polygon):
        distance = ray.meets(POLYGON_PLANE)
        if distance is None or not shape.contains((point := ray.at(distance))[None, :2])[0]:
            return None
        return point * [1.0, 1.0, 0.0]
    assert isinstance(shape, Mesh)
    if target == "chord":
        return middle_of_first_chord(shape, ray)
    if target == "slice-or-body" and picker is not None:
        probe = picker.probe(ray)
        if probe is not None:
            return probe.point
    met = crossings(shape, ray)
    return met.points[0] if len(met.points) else None


class _Locator:
    """Interpolates a slice's values at points of its plane."""

    def __init__(self, slice_: SliceValues) -> None:
        self.slice = slice_

    @cached_property
    def _in_plane(self) -> Floats:
        """The slice's points (2, p) in the plane's basis."""
        return self.slice.plane.basis @ self.slice.points.T

    def value_at(self, point: Floats) -> float | None:
        """The value at a point of the plane; None outside the section."""
        at = self.slice.plane.basis @ point
        triangles = _around(at, self._in_plane, self.slice.triangles)
        (ax, bx, cx), (ay, by, cy) = self._in_plane[:, triangles.T] - at[:, None, None]
        weights = np.stack([bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx])
        total = weights.sum(axis=0)
        inside = np.flatnonzero((weights >= 0.0).all(axis=0) & (total > 0.0))
        if len(inside) == 0:
            return None
        first = inside[0]
        return float(weights[:, first] / total[first] @ self.slice.values[triangles[first]])


def _around(at: Floats, points: Floats, triangles: NDArray[np.int32]) -> NDArray[np.int32]:
    """Those triangles of points (2, p) whose bounding boxes hold a position (2,): a few of very many."""
    (x, y), (xs, ys) = at, points
    sides = (xs < x) * _LEFT | (xs > x) * _RIGHT | (ys < y) * _BELOW | (ys > y) * _ABOVE
    a, b, c = (sides[triangles[:, corner]] for corner in range(3))
    return triangles[(a & b & c) == 0]
