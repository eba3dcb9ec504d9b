"""What the tests of the paper's properties run on: shapes bundled and random, with holes and without."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np
import pytest
import scipy.linalg
from tests.core import shapes

from idviewer.core import (
    COORDINATES,
    DISTANCES,
    GPS,
    Biharmonic,
    CommuteTime,
    Diffusion,
    Distance,
    Euclidean,
    GivenDistances,
    GivenEmbedding,
    InteriorDistance,
    MeanValueCoordinates,
    Mesh,
    Polygon,
    Property,
    SpectralFilter,
    laplacian_of,
    masses_of,
    read_shape,
    sample_path,
)
from idviewer.core.distances import missing_parameters

Body = Mesh | Polygon

RANDOM = ("random mesh", "random ring", "random polygon", "random polygon with a hole")
"""Of 96 to 162 vertices; the ring is a mesh with a hole."""

BUNDLED = ("hand_2k", "gingerbread", "plate")
"""The plate has three holes."""

EXACT = ("diffusion", "filter", "gps", "biharmonic", "commute", "euclidean", "matrix", "embedding")
"""Names of the distances that have an exact embedding (the paper's classes 1 and 2)."""


def thorough(quick: Iterable[str], everything: Iterable[str]) -> list[object]:
    """Parameters of which all but the quick ones are left to the slow tests: together they are many."""
    slow = pytest.mark.slow
    return [name if name in quick else pytest.param(name, marks=slow) for name in everything]


EVERYWHERE = pytest.mark.parametrize("name", thorough(("random mesh", "random polygon with a hole"), RANDOM))
BY_ALL_COORDINATES = pytest.mark.parametrize("coordinates", thorough(("mean_value",), COORDINATES))


def tells_points_apart(coordinates: str) -> bool:
    """Whether different points have different weights; piecewise constant ones have the same ones."""
    return not {Property.LINEAR_PRECISION, Property.SMOOTHNESS}.isdisjoint(
        COORDINATES[coordinates].properties
    )


@cache
def shape(name: str) -> Body:
    if not name.startswith("random"):
        return read_shape(sample_path(name))
    rng = np.random.default_rng(len(name))
    if name == "random mesh":
        vertices, faces = shapes.icosphere(2)
        waves = np.cos(vertices @ rng.normal(scale=2.0, size=(3, 8)) + rng.uniform(0, 6, 8))
        return Mesh(vertices * (1.0 + 0.25 * waves @ rng.uniform(-1, 1, 8))[:, None], faces)
    if name == "random ring":
        vertices, faces = shapes.torus(16, 8)
        return Mesh(vertices @ (np.eye(3) + 0.3 * rng.uniform(-1, 1, (3, 3))), faces)
    holes = [0.3 * loop(30, rng) + [0.1, 0.05]] if name.endswith("hole") else []
    return Polygon.of_loops([loop(96, rng), *holes])


def loop(count: int, rng: np.random.Generator) -> np.ndarray:
    """A random outline about a circle, concave as a rule, of uneven spacing."""
    angles = np.sort((np.arange(count) + rng.uniform(0.0, 0.7, count)) * (2.0 * np.pi / count))
    order = np.arange(1, 6)
    waves = np.cos(np.outer(angles, order) + rng.uniform(0, 6, 5)) @ (rng.uniform(-0.3, 0.3, 5) / order**0.5)
    return (1.0 + waves)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])


@cache
def pairs(name: str, count: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Random points inside, two by two."""
    points = inside(shape(name), np.random.default_rng(3), 2 * count)
    return points[:count], points[count:]


def inside(body: Body, rng: np.random.Generator, count: int) -> np.ndarray:
    """Random points in the interior."""
    points = rng.uniform(*body.bounds, size=(40 * count, body.dimension))
    return points[MeanValueCoordinates(body).contains(points)][:count]


def with_vertices(body: Body, vertices: np.ndarray) -> Body:
    return body.with_vertices(vertices) if isinstance(body, Polygon) else Mesh(vertices, body.faces)


def complete(kind: str, vertices: np.ndarray) -> Distance:
    """A distance of that name that lacks nothing."""
    given = {"matrix": np.sqrt(apart(vertices)), "embedding": vertices}
    return DISTANCES[kind](**{one: given[one] for one in missing_parameters(DISTANCES[kind]())})


@cache
def exact_distance(name: str, body: Body) -> Distance:
    """A distance of that name; those whose numbers are given are given random ones."""
    random = np.random.default_rng(7).standard_normal((len(body.vertices), 5))
    made: dict[str, Distance] = {
        "diffusion": Diffusion(),
        "filter": SpectralFilter("1 / (1 + lambda / lambda_2)"),
        "gps": GPS(),
        "biharmonic": Biharmonic(),
        "commute": CommuteTime(),
        "euclidean": Euclidean(),
        "matrix": GivenDistances(np.sqrt(apart(random))),
        "embedding": GivenEmbedding(random),
    }
    return made[name]


@cache
def boundary(name: str, body: Body) -> InteriorDistance:
    """An interior whose embedding the kinds of coordinates share."""
    return InteriorDistance(body, exact_distance(name, body))


def solver_of(name: str, body: Body, coordinates: str) -> InteriorDistance:
    """With the embedding that was made before."""
    made = boundary(name, body)
    return made if coordinates == made.coordinates.name else made.with_coordinates(coordinates)


def apart(rows: np.ndarray) -> np.ndarray:
    """Squared distances between all rows, without any shortcut."""
    return ((rows[:, None] - rows) ** 2).sum(axis=2)


@cache
def dense_modes(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """All eigenpairs but the constant one, by LAPACK's generalised solver."""
    values, vectors = scipy.linalg.eigh(laplacian_of(body).toarray(), np.diag(masses_of(body)))
    return values[1:], vectors[:, 1:]


@cache
def boundary_squares(name: str, body: Body) -> np.ndarray:
    """Squared distances between the vertices from the definition of each distance, sharing no code."""
    if name == "euclidean":
        return apart(body.vertices)
    if name in ("matrix", "embedding"):
        return apart(np.random.default_rng(7).standard_normal((len(body.vertices), 5)))
    values, vectors = dense_modes(body)
    if name == "commute":
        return apart(vectors / np.sqrt(values))
    first = values[0]
    kept = np.exp(-values / (8.0 * first)) > 1e-6
    values, vectors = values[kept], vectors[:, kept]
    factors = {
        "diffusion": np.exp(-values / (8.0 * first)),
        "filter": 1.0 / (1.0 + values / first),
        "gps": values**-0.5,
        "biharmonic": 1.0 / values,
    }
    return apart(vectors * factors[name])


def full_rank(body: Body, name: str, coordinates: str) -> InteriorDistance:
    """A solver whose Gram matrix is conditionally positive definite: all modes are kept.

    Diffusion gets a short time, so that the last mode keeps a weight of exp(-5).
    """
    if name == "commute":
        return solver_of("commute", body, coordinates)
    values, vectors = dense_modes(body)
    return InteriorDistance(body, GivenEmbedding(vectors * np.exp(-5.0 * values / values[-1])), coordinates)


def stretch(solver: InteriorDistance) -> float:
    """The largest c with d(p, q) >= c |p - q| that the proof of the metric gives.

    d^2 = z^T A z >= a |z|^2 with z = w(p) - w(q), sum z = 0, and a the smallest eigenvalue of A on vectors
    with the sum 0; and |p - q| = |V^T z| <= s |z| by linear precision, s the largest singular value of the
    centred vertices.
    """
    rows = solver.boundary.embedding - solver.boundary.embedding.mean(axis=0)
    smallest = np.linalg.eigvalsh(rows @ rows.T)[1]
    vertices = solver.shape.vertices - solver.shape.vertices.mean(axis=0)
    return float(np.sqrt(max(smallest, 0.0)) / np.linalg.norm(vertices, 2))
