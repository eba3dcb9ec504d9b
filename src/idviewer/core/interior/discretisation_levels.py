"""The levels of a boundary that tell the error of its discretisation: coarser, finer, and curved."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import cast

from idviewer.core.distances import Distance, parameters_of
from idviewer.core.distances.parameters import Number
from idviewer.core.errors import ShapeError
from idviewer.core.interior.assembly import boundary_steps
from idviewer.core.interior.discretisation_error import (
    DISCRETISATION,
    Comparison,
    Discretisation,
    DiscretisationError,
)
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.interior.solver_steps import solver_steps
from idviewer.core.shapes.mesh import Mesh
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape
from idviewer.core.shapes.simplification import simplification_steps
from idviewer.core.shapes.subdivision import bends, subdivided
from idviewer.core.spectrum.eigen_solver import eigenpair_steps
from idviewer.core.spectrum.resolution import Refine, Resolved
from idviewer.core.steps import finish, without_shares

Steps = Generator[None, None, Discretisation]


def discretisation(solver: InteriorDistance) -> Discretisation:
    """Estimate a solver's errors by the discretisation of its boundary; takes about as long as it did itself.

    Args:
        solver: on a mesh or a polygon.

    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> found = discretisation(InteriorDistance(square)).summary
    >>> bool(0.0 < found.total_distances < 0.01), found.faces_distances
    (True, 0.0)
    """
    return finish(discretisation_steps(solver))


def discretisation_steps(solver: InteriorDistance) -> Steps:
    """`discretisation` as a generator that yields every few milliseconds.

    A refined boundary is compared with one of edges twice as long; others with one that is fine enough, or
    with edges half as long, or, where they have many vertices, with a simplified one.

    Args:
        solver: on a mesh or a polygon.

    Raises:
        ShapeError: no other level can be had.
    """
    shape = solver.shape
    if not solver.boundary.distance.needs_resolution or not isinstance(shape, Mesh | Polygon):
        return Discretisation(solver, None)
    yield
    solver = solver.with_coordinates(solver.coordinates.name)  # which count the points that have no weights
    solver.coordinates.warns = False
    resolved = solver.boundary.resolved
    given = cast(Mesh | Polygon, resolved.given)
    if resolved.added and resolved.edge_length is not None:
        for coarseness in DISCRETISATION.coarseness:
            length = coarseness * resolved.edge_length
            coarser = given.refined(length)
            if DISCRETISATION.least_ratio * len(coarser.vertices) > len(shape.vertices):
                break
            try:
                return (yield from _coarser_steps(solver, coarser, length))
            except ShapeError:
                pass  # too coarse for as many modes
    if isinstance(shape, Polygon) or len(shape.vertices) <= DISCRETISATION.finer_up_to:
        return (yield from _finer_steps(solver))
    return (yield from _simplified_steps(solver, shape))


def shape_discretisation_steps(
    shape: Shape, distance: Distance, refine: Refine = "auto"
) -> Generator[None, None, tuple[Resolved, DiscretisationError]]:
    """Refine a shape as a distance needs it, and estimate the errors that are left, in seconds at most.

    Those of a large mesh are told by a simplified one, and fall with the number of vertices.

    Args:
        shape: a mesh or a polygon.
        distance: on its boundary.
        refine: as of `InteriorDistance`.

    Raises:
        ShapeError: the distance cannot be had on this shape.

    >>> from idviewer.core import Diffusion
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> resolved, error = finish(shape_discretisation_steps(square, Diffusion()))
    >>> resolved.added, error.serious
    (80, False)
    """
    resolved = yield from without_shares(boundary_steps(shape, distance, refine))
    large, computed = DISCRETISATION.most_simplified, resolved.shape
    if not isinstance(computed, Mesh) or len(computed.vertices) <= 2 * large:
        steps = solver_steps(shape, distance, refine=resolved)
        solver = yield from without_shares(steps)
        return resolved, (yield from discretisation_steps(solver)).summary
    simple = (yield from without_shares(simplification_steps(computed, large))).mesh
    solver = yield from without_shares(solver_steps(simple, distance, refine="no"))
    found = (yield from discretisation_steps(solver)).summary
    return resolved, found.scaled(len(simple.vertices) / len(computed.vertices))


def _coarser_steps(solver: InteriorDistance, coarser: Shape, length: float) -> Steps:
    """Compare with longer edges; and these on the given boundary with those on a curved one."""
    given = solver.boundary.full_shape
    other = yield from _solver_steps(solver, coarser)
    yield
    edges = Comparison(other, solver, DISCRETISATION.safety / (_error_ratio(coarser, solver.shape) - 1.0))
    if not bends(given):
        return Discretisation(solver, edges)
    return (yield from _with_faces_steps(solver, edges, other, length))


def _finer_steps(solver: InteriorDistance) -> Steps:
    """Compare with a boundary that is fine enough for the modes, or else with edges half as long."""
    shape, distance = solver.shape, solver.boundary.distance
    fine = yield from without_shares(boundary_steps(shape, distance, "auto"))
    finer, length = fine.shape, fine.edge_length
    if len(finer.vertices) < 3 * len(shape.vertices):
        finer, length = subdivided(shape), None
    other = yield from _solver_steps(solver, finer)
    ratio = _error_ratio(shape, finer)
    edges = Comparison(other, solver, DISCRETISATION.finer_safety * ratio / (ratio - 1.0))
    if not bends(solver.boundary.full_shape):
        return Discretisation(solver, edges)
    return (yield from _with_faces_steps(solver, edges, other, length))


def _with_faces_steps(
    solver: InteriorDistance, edges: Comparison, flat: InteriorDistance, length: float | None
) -> Steps:
    """Add the comparison of a flat level with the same of a curved boundary.

    Args:
        solver: whose errors are asked for.
        edges: the other comparison.
        flat: the solver on the flat level.
        length: of its longest edges; None where they are those of the boundary, halved.
    """
    given = solver.boundary.full_shape
    curved = _as_fine(subdivided(given, curved=True), length)
    yield
    if abs(len(flat.shape.vertices) / len(curved.vertices) - 1.0) > DISCRETISATION.same_fineness:
        flat = yield from _solver_steps(solver, _as_fine(subdivided(given), length))
    other = yield from _solver_steps(solver, curved)
    # A curved level has a quarter of the chords' error left.
    return Discretisation(solver, edges, Comparison(other, flat, 4.0 / 3.0 * DISCRETISATION.finer_safety))


def _simplified_steps(solver: InteriorDistance, mesh: Mesh) -> Steps:
    """Compare with a simplified mesh, which tells of both causes at once."""
    wanted = min(int(DISCRETISATION.simplified * len(mesh.vertices)), DISCRETISATION.most_simplified)
    simple = (yield from without_shares(simplification_steps(mesh, wanted))).mesh
    if DISCRETISATION.least_ratio * len(simple.vertices) > len(mesh.vertices):
        return (yield from _finer_steps(solver))
    try:
        other = yield from _solver_steps(solver, simple)
    except ShapeError:
        return (yield from _finer_steps(solver))
    return Discretisation(
        solver, Comparison(other, solver, DISCRETISATION.safety / (_error_ratio(simple, mesh) - 1.0))
    )


def _as_fine(shape: Shape, length: float | None) -> Shape:
    """The shape, refined to edges of a length, where there is one."""
    return shape if length is None else cast(Mesh | Polygon, shape).refined(length)


def _error_ratio(coarse: Shape, fine: Shape) -> float:
    """How many times as large errors are on the coarse one: they go with the square of the length."""
    return float((len(fine.vertices) / len(coarse.vertices)) ** (2 if fine.dimension == 2 else 1))


def _solver_steps(solver: InteriorDistance, shape: Shape) -> Generator[None, None, InteriorDistance]:
    """The same distance, with the same modes, on another level."""
    distance, spectrum = solver.boundary.distance, None
    if distance.spectral:
        known = solver.spectrum
        lambda_2 = float(known.values[0])
        bound = min(known.bound, distance.cutoff(lambda_2))
        distance = _with_values(distance, lambda_2)
        steps = eigenpair_steps(shape, lambda _: bound, lambda_2)
        spectrum = yield from without_shares(steps)
    name = solver.coordinates.name
    made = yield from without_shares(solver_steps(shape, distance, name, spectrum, "no"))
    made.coordinates.warns = False  # of a level that nobody sees
    return made


def _with_values(distance: Distance, lambda_2: float) -> Distance:
    """The distance with its defaults worked out, so that they are the same on all levels."""
    defaults = {
        name: parameter.default(lambda_2)
        for name, parameter in parameters_of(distance).items()
        if isinstance(parameter, Number) and getattr(distance, name) is None
    }
    return replace(distance, **defaults) if defaults else distance
