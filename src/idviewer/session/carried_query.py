"""Carried query: what of a query still means something on another shape, and what it asks for there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from idviewer.core import Diffusion, Distance, Mesh, Plane, Polygon, Shape
from idviewer.core.distances import missing_parameters, with_defaults
from idviewer.core.shapes import Ray, crossings
from idviewer.session.state import Frame, FrameRequest, Point, Query, Ready, State, default_plane


def query_on_another(query: Query, shape: Shape) -> Query:
    """The query on a shape that has nothing to do with the one before.

    A plane, a source, a diffusion time and a length mean nothing there: they become the defaults.
    """
    planes = (default_plane(shape),) if shape.dimension == 3 else ()
    refine = query.refine if isinstance(query.refine, str) else "auto"
    distance = _known(with_defaults(query.distance))
    return replace(query, planes=planes, source=None, distance=distance, refine=refine)


def query_on_repaired(query: Query, shape: Shape) -> Query:
    """The query on a shape after its repair: what needs the former vertices becomes the default.

    So does a source that the repair leaves outside.
    """
    given = missing_parameters(with_defaults(query.distance))
    distance = _known(with_defaults(query.distance)) if given else query.distance
    source = query.source
    if source is not None and isinstance(shape, Mesh) and not _is_inside(shape, source):
        source = None
    return replace(query, source=source, distance=distance)


def state_reshaped(state: State, vertices: ArrayLike) -> State:
    """The state with the polygon's vertices moved; a source that this leaves outside is the barycentroid.

    Args:
        state: shows a polygon.
        vertices: (n, 2), as many as there are.

    Raises:
        PolygonError: they make no simple polygon.
        ValueError: what is shown is no polygon.
    """
    shape, source = state.shape, state.query.source
    if not isinstance(shape, Polygon):
        raise ValueError("only the vertices of a polygon can be moved; open one first")
    polygon = shape.with_vertices(vertices)
    if np.array_equal(polygon.vertices, shape.vertices):
        return state
    if source is not None and not polygon.contains([source[:2]])[0]:
        source = None
    return replace(state, shape=polygon, query=replace(state.query, source=source))


def state_through_centre(state: State, ready: Ready) -> State:
    """The state with the plane through the shape's centre, where the user has not chosen one."""
    if ready.shape.dimension == 2 or state.query.planes != (default_plane(ready.shape),):
        return state
    x, y, z = ready.barycentroid.tolist()
    return state.with_(planes=(ready.plane or Plane((x, y, z), state.query.planes[0].normal),))


def frames_of(state: State, last: Frame | None) -> FrameRequest:
    """The request for the frames of a state, whose shape is the last frame's, moved perhaps."""
    assert state.shape is not None
    if last is None or last.shape is state.shape:
        return FrameRequest(state.shape, state.query)
    x, y, z = last.barycentroid.tolist()
    return FrameRequest(state.shape, state.query, (x, y, z))


def is_complete(frame: Frame | None, state: State) -> bool:
    """Whether a frame is all that a state asks for."""
    return frame is not None and frame.shape is state.shape and frame.exact and frame.query == state.query


def _known(distance: Distance) -> Distance:
    """The distance, or the first one where it lacks what only a user can give."""
    return Diffusion() if missing_parameters(distance) else distance


def _is_inside(mesh: Mesh, point: Point) -> bool:
    return len(crossings(mesh, Ray(point, (0.36, 0.58, 0.73))).distances) % 2 == 1
