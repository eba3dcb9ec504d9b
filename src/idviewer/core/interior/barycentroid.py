"""The barycentroid: the point inside where the mean squared distance to the boundary is smallest."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.plane import AXES, Plane
from idviewer.core.shapes.polygon import Polygon, PolygonError
from idviewer.core.shapes.shape import Shape
from idviewer.core.slices.mesh_sections import Section, section
from idviewer.core.slices.polygon_sections import polygon_section
from idviewer.core.slices.triangulation import SliceMesh, slice_mesh, spacing_for
from idviewer.core.steps import finish

Evaluate = Callable[[Floats], Generator[float | None, None, Floats]]


@dataclass(frozen=True)
class SearchSettings:
    """Settings of the search for the barycentroid; lengths in diagonals of the shape.

    Attributes:
        layers: planes across the longest axis of a mesh on which its inside is sampled.
        samples_per_layer: points on each of them.
        starts: how many descents there are.
        start_radius: trust radius that a descent begins with.
        surrogate_radius: where descents by a surrogate end.
        surrogate_contrast: where the lowest U is a smaller share of the highest, a tolerance tells too little
            of where it is: after a long time U is a valley with a floor near 0.
        last_radius: where descents end.
        most_steps: of a descent.
        shrinking: the trust radius shrinks to no less than this share of itself.
        least_curvature: that a step trusts, as a share of the largest: after a long time one eigenvector
            dominates, and U^2 is a valley that is thousands of times as steep across as along.
        step_lengths: shares of a step that are tried beside it; with the stencil, points fill a block.
    """

    layers: int = 12
    samples_per_layer: int = 14
    starts: int = 3
    start_radius: float = 0.02
    surrogate_radius: float = 0.01
    surrogate_contrast: float = 0.02
    last_radius: float = 2.5e-7
    most_steps: int = 60
    shrinking: float = 0.25
    least_curvature: float = 1e-8
    step_lengths: tuple[float, ...] = (0.25, 0.5, 2.0)


SEARCH = SearchSettings()


@dataclass(frozen=True, eq=False)
class Barycentroid:
    """The point inside where the potential is smallest.

    Attributes:
        point: (dimension,) the barycentroid, inside the shape.
        potential: U there.
        path: (s, dimension) the descent that ended there, from its start on.
    """

    point: Floats
    potential: float
    path: Floats


def barycentroid_steps(
    shape: Shape,
    potential: Evaluate,
    last_radius: float = SEARCH.last_radius,
    surrogate: Evaluate | None = None,
) -> Generator[float | None, None, Barycentroid]:
    """Find the barycentroid; yields the share done, or None, every few milliseconds.

    U may have several local minima. The interior is sampled coarsely, descents start from the lowest
    samples that lie well apart, and the lowest end wins; it cannot be higher than any sample. Source:
    Rustamov et al. 2009, section 7.

    Args:
        shape: where to look.
        potential: U at (p, dimension) points, (p,), NaN outside, as a generator.
        last_radius: where a descent ends, in diagonals of the shape.
        surrogate: U within a tolerance, if that is to be had much sooner: it leads the descents as far as it
            can tell the way down, and U itself the rest of it.

    Raises:
        ShapeError: no point inside could be found (a MeshError or a PolygonError).

    >>> from idviewer.core import Euclidean, InteriorDistance, Polygon
    >>> square = InteriorDistance(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]), Euclidean())
    >>> found = finish(barycentroid_steps(square.shape, square.interpolation.potential_steps))
    >>> found.point.round(4).tolist()
    [2.0, 2.0]
    """
    samples = yield from interior_sample_steps(shape)
    values = yield from (surrogate or potential)(samples)
    inside = np.isfinite(values)
    if not inside.any():
        kind, error = ("polygon", PolygonError) if shape.dimension == 2 else ("mesh", MeshError)
        raise error(f"no point inside the {kind} was found; is it thinner than its coordinates' rounding?")
    exponent = int(np.frexp(values[inside].max())[1])
    potential = _scaled(potential, exponent)
    surrogate = None if surrogate is None else _scaled(surrogate, exponent)
    values = np.ldexp(values, -exponent)
    paths = [point[None] for point in _lowest_apart(samples[inside], values[inside], 0.1 * shape.diagonal)]
    radius = SEARCH.start_radius * shape.diagonal
    if surrogate is not None:
        led = yield from _descents(surrogate, paths, radius, SEARCH.surrogate_radius * shape.diagonal)
        if led[0].potential > SEARCH.surrogate_contrast * values[inside].max():
            paths, radius = [end.path for end in led], SEARCH.surrogate_radius * shape.diagonal
    best = (yield from _descents(potential, paths, radius, last_radius * shape.diagonal))[0]
    return replace(best, potential=float(np.ldexp(best.potential, exponent)))


def _scaled(evaluate: Evaluate, exponent: int) -> Evaluate:
    """Values divided by a power of two, which is exact: fourth powers of them then stay floats."""

    def steps(points: Floats) -> Generator[float | None, None, Floats]:
        return np.ldexp((yield from evaluate(points)), -exponent)

    return steps


def interior_samples(shape: Shape) -> Floats:
    """Points (p, dimension) spread evenly over the inside.

    A lattice fills a polygon, lattices on planes across the longest axis fill a mesh.

    >>> samples = interior_samples(Polygon([[0, 0], [4, 0], [4, 4], [0, 4]]))
    >>> bool(((samples > 0.0) & (samples < 4.0)).all())
    True
    """
    return finish(interior_sample_steps(shape))


def interior_sample_steps(shape: Shape) -> Generator[None, None, Floats]:
    """`interior_samples` as a generator that yields between the planes."""
    if isinstance(shape, Polygon):
        yield
        return _filling(polygon_section(shape), SEARCH.layers * SEARCH.samples_per_layer)[:, :2]
    assert isinstance(shape, Mesh)
    return (yield from _layers(shape))


def _layers(mesh: Mesh) -> Generator[None, None, Floats]:
    axis = list(AXES)[int(np.argmax(np.ptp(mesh.bounds, axis=0)))]
    layers = []
    for fraction in (np.arange(SEARCH.layers) + 0.5) / SEARCH.layers:
        cut = section(mesh, Plane.along(axis, float(fraction), mesh.bounds))
        if cut.area > 0.0:
            layers.append(_filling(cut, SEARCH.samples_per_layer))
        yield
    return np.concatenate(layers) if layers else np.empty((0, 3))


def _filling(cut: Section, samples: int) -> Floats:
    """Points (p, 3) inside a section, about so many."""
    filled = slice_mesh(cut, spacing_for(cut, samples))
    return filled.node_points if len(filled.nodes) else _largest_triangles(filled)


def _largest_triangles(filled: SliceMesh) -> Floats:
    """Middles of a section's largest triangles: inner points also where it is thinner than the lattice."""
    corners = filled.points[filled.triangles]
    sizes = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return corners[np.argsort(-sizes, kind="stable")[: SEARCH.samples_per_layer]].mean(axis=1)


def _lowest_apart(points: Floats, values: Floats, apart: float) -> list[Floats]:
    """The lowest points, of those that lie apart from each other by at least so much."""
    chosen: list[Floats] = []
    for point in points[np.argsort(values, kind="stable")]:
        if all(np.linalg.norm(point - other) >= apart for other in chosen):
            chosen.append(point)
        if len(chosen) == SEARCH.starts:
            break
    return chosen


def _descents(
    potential: Evaluate, paths: list[Floats], radius: float, last_radius: float
) -> Generator[float | None, None, list[Barycentroid]]:
    """Ends of descents that go on from the ends of paths (s, d); the lowest first."""
    ends: list[Barycentroid] = []
    for path in paths:
        yield from _descend(potential, path, radius, last_radius, ends)
    return sorted(ends, key=lambda end: end.potential)


def _descend(
    potential: Evaluate, path: Floats, radius: float, last_radius: float, ends: list[Barycentroid]
) -> Generator[float | None, None, None]:
    """Follow U^2 downhill by quadratic models fitted within a trust radius, and add where that ends.

    Evaluating a block of points costs little more than one, so the model is fitted to a whole stencil,
    whose step is tried together with the stencil to follow and with steps of other lengths. A descent that
    comes to an end that is known already, and lower, is given up.
    """
    model = _Model.of(path.shape[1])
    around = len(model.stencil)
    point, steps = path[-1], list(path)
    heights = yield from potential(point + radius * model.stencil)
    for _ in range(SEARCH.most_steps):
        if radius < last_radius or _joins(point, heights[0], radius, ends):
            break
        if not np.isfinite(heights).all():
            if not np.isfinite(heights[0]):
                break
            radius *= 0.5
            heights = yield from potential(point + radius * model.stencil)
            continue
        step = model.step(heights**2) * radius
        length = float(np.linalg.norm(step))
        closer = min(max(2.0 * length, SEARCH.shrinking * radius), 2.0 * radius)
        tried = np.concatenate(
            [point + step + closer * model.stencil, point + np.outer(SEARCH.step_lengths, step)]
        )
        found = yield from potential(tried)
        if found[0] < heights[0] and not found[around:].min() < found[0]:
            point, radius, heights = tried[0], closer, found[:around]
            steps.append(point)
            continue
        candidates = np.concatenate([point + radius * model.stencil, tried])
        lowest = int(np.nanargmin(np.concatenate([heights, found])))
        moved = float(np.linalg.norm(candidates[lowest] - point))
        if lowest > 0:
            point = candidates[lowest]
            steps.append(point)
        radius = min(max(2.0 * moved, SEARCH.shrinking * radius), radius if moved < radius else 2.0 * radius)
        heights = yield from potential(point + radius * model.stencil)
    if not _joins(point, heights[0], radius, ends):
        ends.append(Barycentroid(point, float(heights[0]), np.array(steps)))


def _joins(point: Floats, height: float, radius: float, ends: list[Barycentroid]) -> bool:
    """Whether an end that is no higher lies within the trust radius."""
    return any(end.potential <= height and np.linalg.norm(end.point - point) < radius for end in ends)


@dataclass(frozen=True, eq=False)
class _Model:
    """Quadratic functions in so many dimensions, fitted to their values on a stencil.

    Attributes:
        stencil: (s, d) the middle, its neighbours along the axes and enough diagonals for a full quadratic.
        fit: (c, s) from values on the stencil to coefficients: constant, linear, squares, products.
    """

    stencil: Floats
    fit: Floats

    @classmethod
    @cache
    def of(cls, dimension: int) -> _Model:
        axes = np.concatenate([np.eye(dimension), -np.eye(dimension)])
        pairs = list(combinations(range(dimension), 2))
        diagonals = np.zeros((2 * len(pairs), dimension))
        for number, (first, second) in enumerate(pairs):
            diagonals[2 * number : 2 * number + 2, first] = np.sqrt(0.5)
            diagonals[2 * number : 2 * number + 2, second] = np.sqrt(0.5), -np.sqrt(0.5)
        stencil = np.concatenate([np.zeros((1, dimension)), axes, diagonals, -diagonals[::2]])
        products = [stencil[:, first] * stencil[:, second] for first, second in pairs]
        terms = np.column_stack([np.ones(len(stencil)), stencil, stencil**2, *products])
        return cls(stencil, np.linalg.pinv(terms))

    def step(self, squares: Floats) -> Floats:
        """The step, in trust radii, to the minimum of the quadratic fitted to the stencil's values."""
        d = self.stencil.shape[1]
        coefficients = self.fit @ squares
        gradient, hessian = coefficients[1 : 1 + d], np.diag(2.0 * coefficients[1 + d : 1 + 2 * d])
        for value, (first, second) in zip(coefficients[1 + 2 * d :], combinations(range(d), 2), strict=True):
            hessian[first, second] = hessian[second, first] = value
        curvatures, directions = np.linalg.eigh(hessian)
        steepest = max(float(np.abs(curvatures).max()), float(np.linalg.norm(gradient)))
        floor = SEARCH.least_curvature * max(steepest, np.finfo(float).tiny)
        step = -directions @ ((directions.T @ gradient) / np.maximum(np.abs(curvatures), floor))
        length = float(np.linalg.norm(step))
        return step if length <= 2.0 else step * (2.0 / length)
