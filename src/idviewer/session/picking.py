"""What lies under the mouse: points of slices and of the body, and the values there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from idviewer.core import Mesh
from idviewer.core.rays import Ray, crossings, middle_of_first_chord
from idviewer.session.state import Frame, Slice

Floats = NDArray[np.float64]
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


def pick(mesh: Mesh, picker: FramePicker | None, ray: Ray, target: Target) -> Floats | None:
    """(3,) the point a click means.

    "slice-or-body" is the point of a slice, or of the body's near surface where no slice lies under the
    ray; "surface" is the near surface in any case; "chord" the middle of the first stretch inside.
    """
    if target == "chord":
        return middle_of_first_chord(mesh, ray)
    if target == "slice-or-body" and picker is not None:
        probe = picker.probe(ray)
        if probe is not None:
            return probe.point
    met = crossings(mesh, ray)
    return met.points[0] if len(met.points) else None


class _Locator:
    """Interpolates a slice's values at points of its plane."""

    def __init__(self, slice_: Slice) -> None:
        self.slice = slice_

    @cached_property
    def _corners(self) -> Floats:
        """(3, 2, t) the triangles' corners in the plane's basis."""
        flat = (self.slice.points - np.array(self.slice.plane.origin)) @ self.slice.plane.basis.T
        return np.ascontiguousarray(flat[self.slice.triangles].transpose(1, 2, 0))

    def value_at(self, point: Floats) -> float | None:
        """The value at a point of the plane; None outside the section."""
        if len(self.slice.triangles) == 0:
            return None
        x, y = self.slice.plane.basis @ (point - np.array(self.slice.plane.origin))
        (ax, ay), (bx, by), (cx, cy) = self._corners
        weights = np.stack(
            [
                (bx - x) * (cy - y) - (by - y) * (cx - x),
                (cx - x) * (ay - y) - (cy - y) * (ax - x),
                (ax - x) * (by - y) - (ay - y) * (bx - x),
            ]
        )
        total = weights.sum(axis=0)
        inside = np.flatnonzero((weights >= 0.0).all(axis=0) & (total > 0.0))
        if len(inside) == 0:
            return None
        first = inside[0]
        return float(weights[:, first] / total[first] @ self.slice.values[self.slice.triangles[first]])
