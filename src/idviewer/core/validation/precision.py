"""Precision: to what step coordinates are rounded, far from the origin or in single precision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idviewer.core.arrays import Floats, Ints
from idviewer.core.validation.findings import Finding, stated

COARSE_SHARE = 1e-3
"""A step of more than this share of the median edge is told."""

FINEST_BIT_SHARE = 0.02
"""Rounded coordinates use the last bit in about half of all cases; whole numbers and grids hardly ever."""


@dataclass(frozen=True)
class Precision:
    """The step between neighbouring numbers at a mesh's coordinates.

    Attributes:
        bits: 32 where all coordinates are numbers of single precision, else 64.
        step: the largest of the three axes, in the mesh's unit.
        of_size: the same as a share of the bounding box's diagonal.
        of_edge: as a share of the median edge.
        rounded: whether coordinates were rounded to that step; whole numbers and grids were not.
    """

    bits: int
    step: float
    of_size: float
    of_edge: float
    rounded: bool

    @property
    def coarse(self) -> bool:
        """Whether rounding matters beside the length of edges."""
        return self.rounded and self.of_edge > COARSE_SHARE

    @property
    def finding(self) -> Finding:
        """What is left of the precision, in words."""
        kind = "single" if self.bits == 32 else "double"
        subject = (
            f"coordinates in {kind} precision, far from the origin and so rounded to {self.step:.2g} "
            f"({self.of_size:.1%} of the size, {self.of_edge:.1%} of a median edge),"
        )
        return stated("precision", subject, count=2)


def precision_of(vertices: Floats, edges: Ints) -> Precision:
    """Find out to what step coordinates are rounded.

    Args:
        vertices: (n, 3).
        edges: (e, 2).

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 0.1, 0]], dtype=np.float32) + np.float32(5e6)
    >>> found = precision_of(corners.astype(float), np.array([[0, 1], [0, 2]]))
    >>> found.bits, found.step, found.rounded
    (32, 0.5, False)
    """
    largest = np.abs(vertices).max(axis=0)
    with np.errstate(over="ignore", under="ignore"):  # what single precision cannot hold differs
        is_single = bool(np.array_equal(vertices.astype(np.float32), vertices))
    steps = np.spacing(largest.astype(np.float32)) if is_single else np.spacing(largest)
    steps = steps.astype(np.float64)
    axis = int(np.argmax(steps))
    step = float(steps[axis])
    # Only where the largest coordinates lie is the step so wide.
    upper = vertices[np.abs(vertices[:, axis]) >= 0.5 * largest[axis], axis]
    odd = np.mod(upper / step, 2.0) == 1.0
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    lengths = np.linalg.norm(vertices[edges[:, 1]] - vertices[edges[:, 0]], axis=1)
    edge = float(np.median(lengths[lengths > 0.0])) if np.any(lengths > 0.0) else size
    rounded = bool(odd.mean() > FINEST_BIT_SHARE)
    return Precision(32 if is_single else 64, step, step / size, step / edge, rounded)
