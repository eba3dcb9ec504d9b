"""Commands on the slicing planes: what panel, menus, keys and the handle do with the active one."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from idviewer.core import Plane, Shape
from idviewer.core.shapes import AXES
from idviewer.session.state import Frame, State

DRAG_MARGIN_SHARE = 0.002
"""The share of the shape's extent that a dragged plane keeps from either end, so that it cuts something."""


class PlaneOwner(Protocol):
    """Owner of the planes; a `Session` is one."""

    state: State
    frame: Frame | None

    def set(self, **fields: object) -> None:
        """Change fields of the query or the display, by name."""


def active_plane(state: State) -> Plane | None:
    """The plane that the handle and the controls move; None if there is none, and for a polygon."""
    planes, active = state.query.planes, state.display.active_plane
    sliced = state.shape is not None and state.shape.dimension == 3
    return planes[active] if sliced and active < len(planes) else None


def axis_of(plane: Plane) -> str | None:
    """The axis that the plane's normal lies on, None for a tilted plane.

    >>> axis_of(Plane((1, 2, 3), (0, -1, 0))), axis_of(Plane((1, 2, 3), (0, 1, 1)))
    ('y', None)
    """
    aligned = (name for name, axis in AXES.items() if abs(np.dot(axis, plane.normal)) > 1 - 1e-9)
    return next(aligned, None)


def extent_over(shape: Shape, plane: Plane) -> tuple[float, float]:
    """Heights of the shape's lowest and highest point over the plane, in the shape's unit."""
    heights = plane.height(shape.vertices)
    return float(heights.min()), float(heights.max())


def with_normal(shape: Shape, plane: Plane, normal: tuple[float, float, float]) -> Plane:
    """The plane with another normal through its origin, or through the middle if that misses the shape."""
    new = Plane(plane.origin, normal)
    low, high = extent_over(shape, new)
    return new if low < 0 < high else new.moved((low + high) / 2)


def additional_plane(shape: Shape, planes: tuple[Plane, ...]) -> Plane:
    """A plane through the middle, on the axis that the given planes are least aligned with."""
    alignment = np.sum([np.abs(plane.normal) for plane in planes], axis=0) if planes else np.zeros(3)
    return Plane.along("xyz"[int(np.argmin(alignment))], 0.5, shape.bounds)


class PlaneCommands:
    """Adds, removes, moves and turns planes; without a plane, or for a polygon, its methods do nothing.

    Args:
        owner: whose state says which planes there are, and which is active.
    """

    def __init__(self, owner: PlaneOwner) -> None:
        self._owner = owner
        self._measured: tuple[Shape | None, tuple[float, ...] | None] = (None, None)
        self._range = (0.0, 0.0)

    @property
    def active(self) -> Plane | None:
        """The plane that is moved."""
        return active_plane(self._owner.state)

    def replace(self, plane: Plane) -> None:
        """Put the active plane somewhere else."""
        planes, active = self._owner.state.query.planes, self._owner.state.display.active_plane
        if active < len(planes):
            self._owner.set(planes=(*planes[:active], plane, *planes[active + 1 :]))

    def drag_to(self, plane: Plane) -> None:
        """Put the active plane where the handle was dragged, but never so far that it loses the shape."""
        shape = self._owner.state.shape
        if shape is None:
            return
        inside = np.clip(plane.origin, *shape.bounds)
        plane = Plane(tuple(inside - plane.height(inside) * np.array(plane.normal)), plane.normal)
        low, high = self._extent(shape, plane)
        margin = DRAG_MARGIN_SHARE * (high - low)
        self.replace(plane.moved(float(np.clip(0.0, low + margin, high - margin))))

    def fraction_of(self, shape: Shape, plane: Plane) -> float:
        """Position of the plane along its normal: 0 at the shape's lowest point, 1 at its highest.

        Less than 0 or more than 1 where it misses the shape.
        """
        low, high = self._extent(shape, plane)
        return -low / (high - low) if high > low else 0.5

    def move_to(self, fraction: float) -> None:
        """Move the active plane along its normal: 0 is the shape's lowest point, 1 its highest."""
        shape, plane = self._owner.state.shape, self.active
        if shape is not None and plane is not None:
            low, high = self._extent(shape, plane)
            self.replace(plane.moved(low + fraction * (high - low)))

    def nudge(self, step: float) -> None:
        """Move the active plane along its normal by a share of the shape's extent."""
        shape, plane = self._owner.state.shape, self.active
        if shape is not None and plane is not None:
            self.move_to(min(1.0, max(0.0, self.fraction_of(shape, plane) + step)))

    def turn_to(self, axis: str) -> None:
        """Turn the active plane's normal to an axis, "x", "y" or "z"."""
        shape, plane = self._owner.state.shape, self.active
        if shape is not None and plane is not None:
            self.replace(with_normal(shape, plane, AXES[axis]))

    def move_through_source(self) -> None:
        """Move the active plane's origin to the source, which may be the barycentroid that a frame shows."""
        state, frame, plane = self._owner.state, self._owner.frame, self.active
        source = state.query.source
        if source is None and frame is not None and frame.shape is state.shape:
            source = tuple(frame.source.tolist())
        if source is not None and plane is not None:
            self.replace(Plane(source, plane.normal))

    def add(self) -> None:
        """Add a plane, which becomes the active one."""
        shape, planes = self._owner.state.shape, self._owner.state.query.planes
        if shape is not None and shape.dimension == 3:
            self._owner.set(planes=(*planes, additional_plane(shape, planes)), active_plane=len(planes))

    def remove(self) -> None:
        """Remove the active plane."""
        planes, active = self._owner.state.query.planes, self._owner.state.display.active_plane
        rest = (*planes[:active], *planes[active + 1 :])
        self._owner.set(planes=rest, active_plane=max(0, min(active, len(rest) - 1)))

    def _extent(self, shape: Shape, plane: Plane) -> tuple[float, float]:
        """`extent_over`, computed once for each normal: a push asks for it at every move of the mouse."""
        height = float(np.dot(plane.origin, plane.normal))
        if self._measured[0] is not shape or self._measured[1] != plane.normal:
            low, high = extent_over(shape, plane)
            self._measured, self._range = (shape, plane.normal), (low + height, high + height)
        return self._range[0] - height, self._range[1] - height
