"""Planes: where a body is sliced."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core.arrays import Floats

Triple = tuple[float, float, float]

AXES: dict[str, Triple] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True)
class Plane:
    """An oriented plane.

    Attributes:
        origin: a point on it.
        normal: its unit normal; any other length is normalised.

    >>> Plane((0, 0, 1), (0, 0, 2)).height([[5.0, 5.0, 4.0]]).tolist()
    [3.0]
    """

    origin: Triple
    normal: Triple

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", _triple(self.origin, "origin"))
        normal = _triple(self.normal, "normal")
        largest = max(map(abs, normal))
        if largest == 0.0:
            raise ValueError("a plane's normal must not be zero")
        # Divided by the largest first, so that neither tiny nor huge normals underflow or overflow.
        scaled = [value / largest for value in normal]
        length = math.hypot(*scaled)
        if abs(largest * length - 1.0) > 4e-16:
            object.__setattr__(self, "normal", tuple(value / length for value in scaled))

    @classmethod
    def along(cls, axis: str, fraction: float, bounds: ArrayLike) -> Plane:
        """The plane across an axis at a fraction of the way through a bounding box.

        Args:
            axis: "x", "y" or "z".
            fraction: 0 at the lower side, 1 at the upper.
            bounds: (2, 3) lower and upper corner.

        >>> Plane.along("y", 0.25, [[0, 0, 0], [1, 8, 1]]).origin
        (0.5, 2.0, 0.5)
        """
        lower, upper = np.asarray(bounds, dtype=np.float64)
        origin = 0.5 * (lower + upper)
        index = list(AXES).index(axis)
        origin[index] = lower[index] + fraction * (upper[index] - lower[index])
        return cls(tuple(origin), AXES[axis])

    @classmethod
    def parse(cls, text: str, bounds: ArrayLike) -> Plane:
        """Read a plane from "AXIS=FRACTION" or "OX,OY,OZ/NX,NY,NZ".

        Args:
            text: x=0.5 is half way along x; 0,0,0/0,0,1 is an origin and a normal.
            bounds: (2, 3) lowest and highest corner of the body, for the fraction.

        Raises:
            ValueError: what is wrong with the text, in one line.

        >>> Plane.parse("z=0.5", [[0, 0, 0], [1, 1, 1]])
        Plane(origin=(0.5, 0.5, 0.5), normal=(0.0, 0.0, 1.0))
        """
        hint = (
            f"cannot read the plane {text!r}: write x=0.5 (axis and fraction) or 0,0,0/0,0,1 (origin/normal)"
        )
        try:
            if "=" in text:
                axis, fraction = text.split("=")
                share = float(fraction)
                if axis.strip().lower() not in AXES or not math.isfinite(share):
                    raise ValueError(hint)
                return cls.along(axis.strip().lower(), share, bounds)
            origin, normal = (tuple(map(float, part.split(","))) for part in text.split("/"))
        except ValueError:
            raise ValueError(hint) from None
        try:
            return cls(origin, normal)  # type: ignore[arg-type]
        except ValueError as error:
            raise ValueError(f"{hint}; {error}") from None

    @cached_property
    def basis(self) -> Floats:
        """Orthonormal vectors (2, 3) in the plane, read-only; with the normal they are right-handed."""
        # Across the normal and the axis it is farthest from.
        across = min(range(3), key=lambda axis: abs(self.normal[axis]))
        after, before = (across + 1) % 3, (across + 2) % 3
        length = math.hypot(self.normal[after], self.normal[before])
        first = [0.0, 0.0, 0.0]
        first[after], first[before] = -self.normal[before] / length, self.normal[after] / length
        (a, b, c), (x, y, z) = self.normal, first
        basis = np.array([first, [b * z - c * y, c * x - a * z, a * y - b * x]])
        basis.setflags(write=False)
        return basis

    def height(self, points: ArrayLike) -> Floats:
        """Signed distances (p,) of points (p, 3), positive on the normal's side."""
        return (np.asarray(points, dtype=np.float64) - np.array(self.origin)) @ np.array(self.normal)

    def moved(self, distance: float) -> Plane:
        """The plane shifted along its normal."""
        return Plane(tuple(np.array(self.origin) + distance * np.array(self.normal)), self.normal)

    def __str__(self) -> str:
        return "/".join(",".join(f"{value:.6g}" for value in triple) for triple in (self.origin, self.normal))


def _triple(values: Triple, name: str) -> Triple:
    numbers = tuple(float(value) for value in values)
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise ValueError(f"a plane's {name} must be three finite numbers, not {values}")
    return numbers
