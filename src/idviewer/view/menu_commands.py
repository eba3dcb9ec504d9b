"""Commands of the menus that need no more than the session and the picture, by their names in `menus`."""

from __future__ import annotations

from collections.abc import Callable

from idviewer.session import PlaneCommands, Session
from idviewer.view.viewport import Viewport

NUDGE_SHARE, FAR_NUDGE_SHARE = 0.01, 0.1
"""Shares of the shape's extent that the keys push a plane by."""


def menu_commands(
    session: Session, viewport: Viewport, planes: PlaneCommands
) -> dict[str, Callable[[], object]]:
    """Callables by the names of their entries in `menus.MENUS`.

    Args:
        session: what is shown and computed.
        viewport: whose camera is moved.
        planes: moves the slicing planes.
    """
    views = ("front", "back", "left", "right", "top", "bottom")
    return {
        "reset": viewport.reset_view,
        **{view: lambda view=view: viewport.look_from(view) for view in views},  # type: ignore[misc]
        "face": viewport.look_at_plane,
        "upright": viewport.turn_upright,
        **{f"plane_{axis}": lambda axis=axis: planes.turn_to(axis) for axis in "xyz"},  # type: ignore[misc]
        "through": planes.move_through_source,
        "forward": lambda: planes.nudge(NUDGE_SHARE),
        "backward": lambda: planes.nudge(-NUDGE_SHARE),
        "far_forward": lambda: planes.nudge(FAR_NUDGE_SHARE),
        "far_backward": lambda: planes.nudge(-FAR_NUDGE_SHARE),
        "add_plane": planes.add,
        "remove_plane": planes.remove,
        "handle": lambda: session.set(handle=not session.state.display.handle),
        "at_barycentroid": lambda: session.set(source=None),
        "barycentroid": lambda: session.set(barycentroid=not session.state.display.barycentroid),
        "quantity": lambda: _switch_quantity(session),
        "resume": session.resume,
    }


def _switch_quantity(session: Session) -> None:
    other = {"distance": "potential", "potential": "distance"}
    session.set(quantity=other[session.state.query.quantity])
