"""Descriptors of shapes: closed forms, what they do not depend on, and the random points inside."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
import scipy.stats
from tests.core import shapes

from idviewer.core import CommuteTime, Diffusion, Distance, Euclidean, InteriorDistance, Mesh, Polygon, Shape
from idviewer.core.interior import (
    DESCRIPTORS,
    ShapeDescriptors,
    descriptor_differences,
    random_interior_points,
    shape_descriptors,
)

pytestmark = pytest.mark.slow

L_SHAPE = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
RING = [[[0, 0], [4, 0], [4, 4], [0, 4]], [[1, 1], [3, 1], [3, 3], [1, 3]]]


def l_prism() -> Mesh:
    """An L of height 1: its volume is 3."""
    base = np.array(L_SHAPE, float)
    vertices = np.concatenate([np.column_stack([base, np.full(6, height)]) for height in (0.0, 1.0)])
    flat = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    sides = [[i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6] for i in range(6)]
    quads = np.array(sides)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return Mesh(vertices, np.concatenate([flat[:, ::-1], flat + 6, quads]))


def moved(shape: Shape, rng: np.random.Generator, scale: float = 3.0) -> Shape:
    """Turned, scaled and moved far away."""
    d = shape.dimension
    turn = np.linalg.qr(rng.standard_normal((d, d)))[0]
    turn[0] *= np.sign(np.linalg.det(turn))
    vertices = scale * shape.vertices @ turn.T + 100.0 * scale * rng.standard_normal(d)
    return Mesh(vertices, shape.faces) if isinstance(shape, Mesh) else Polygon(vertices, shape.loops)


def described(shape: Shape, distance: Distance) -> ShapeDescriptors:
    """Descriptors on the boundary as it is given, which takes less time."""
    return shape_descriptors(InteriorDistance(shape, distance, refine="no"))


class TestRandomPoints:
    @pytest.mark.parametrize(
        ("shape", "halves"),
        [
            (l_prism(), [(0, 1.0, 2 / 3), (1, 0.5, 1 / 3), (2, 0.25, 0.25)]),
            (Polygon(L_SHAPE), [(0, 1.0, 2 / 3), (1, 1.5, 5 / 6)]),
            (Polygon.of_loops(RING), [(0, 1.0, 1 / 3), (1, 2.0, 0.5), (0, 3.0, 2 / 3)]),
        ],
        ids=["prism", "polygon", "ring"],
    )
    def test_they_are_even_by_volume(self, shape: Shape, halves: list[tuple[int, float, float]]) -> None:
        """Shares of volume below planes, within four standard deviations of independent draws."""
        points = random_interior_points(shape, 2000, seed=5)
        assert InteriorDistance(shape, Euclidean()).contains(points).all()
        for axis, height, share in halves:
            found = np.mean(points[:, axis] < height)
            assert abs(found - share) < 4.0 * math.sqrt(share * (1.0 - share) / 2000)

    @pytest.mark.parametrize("shape", [l_prism(), Polygon.of_loops(RING)], ids=["mesh", "polygon"])
    def test_they_go_with_the_shape(self, shape: Shape, rng: np.random.Generator) -> None:
        other = moved(shape, rng)
        corners = [random_interior_points(one, 50) for one in (shape, other)]
        lengths = [np.linalg.norm(points[:, None] - points, axis=2) for points in corners]
        assert np.allclose(lengths[1], 3.0 * lengths[0], atol=1e-9)

    def test_the_seed_counts(self) -> None:
        square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
        one, same, other = (random_interior_points(square, 9, seed) for seed in (1, 1, 2))
        assert np.array_equal(one, same)
        assert not np.array_equal(one, other)


class TestDescriptors:
    def test_the_mean_distance_in_a_square(self) -> None:
        """It is (2 + sqrt 2 + 5 ln(1 + sqrt 2)) / 15."""
        found = described(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]), Euclidean())
        assert found.mean_distance == pytest.approx(
            (2 + math.sqrt(2) + 5 * math.log(1 + math.sqrt(2))) / 15, rel=0.02
        )

    def test_the_mean_distance_in_a_cube(self) -> None:
        """It is Robbins' constant."""
        found = described(Mesh(*shapes.cube()), Euclidean())
        assert found.mean_distance == pytest.approx(0.6617071822, rel=0.02)

    @pytest.mark.refined
    def test_a_square_of_four_points(self) -> None:
        """Its boundary is refined for the eigenvalues, also where the distance needs none."""
        square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
        found = shape_descriptors(InteriorDistance(square, Euclidean()))
        assert np.allclose(found.eigenvalues, (2 * np.pi * np.repeat(np.arange(1, 11), 2)) ** 2, rtol=0.02)

    def test_a_circle(self) -> None:
        """Eigenvalues (2 pi j)^2 of a closed curve of length 1, twice each; U of the disc's potential r."""
        angles = 2 * np.pi * np.arange(400) / 400
        circle = Polygon(np.stack([np.cos(angles), np.sin(angles)], axis=1))
        found = shape_descriptors(InteriorDistance(circle, Euclidean()))
        exact = (2 * np.pi * np.repeat(np.arange(1, 11), 2)) ** 2
        assert np.allclose(found.eigenvalues, exact, rtol=3e-3)
        # r has the distribution r^2, and the mean distance is 128 / (45 pi).
        quantiles = np.sqrt(np.arange(1, 10) / 10) / (128 / (45 * np.pi))
        assert np.allclose(found.potential, quantiles, rtol=0.05)

    def test_histogram_of_a_disc(self) -> None:
        """The distribution of distances in a disc, in closed form, within the error that is stated."""
        angles = 2 * np.pi * np.arange(200) / 200
        disc = Polygon(np.stack([np.cos(angles), np.sin(angles)], axis=1))
        found = shape_descriptors(InteriorDistance(disc, Euclidean()))
        s = np.linspace(0.0, 2.0, 200_001)
        density = 4 * s / np.pi * np.arccos(s / 2) - s**2 / np.pi * np.sqrt(4 - s**2)
        below = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2 * (s[1] - s[0]))])
        edges = np.arange(1, DESCRIPTORS.bins + 1) * DESCRIPTORS.widest / DESCRIPTORS.bins
        exact = np.interp(edges * 128 / (45 * np.pi), s, below)
        moved_by = np.abs(np.cumsum(found.distances) - exact).sum() * DESCRIPTORS.widest / DESCRIPTORS.bins
        assert moved_by < found.distances_error < 0.03

    @pytest.mark.parametrize("shape", [l_prism(), Polygon(L_SHAPE)], ids=["mesh", "polygon"])
    def test_moving_turning_and_scaling_change_nothing(self, shape: Shape, rng: np.random.Generator) -> None:
        made = [described(one, Diffusion()) for one in (shape, moved(shape, rng))]
        assert max(between[0, 1] for between in descriptor_differences(made).values()) < 1e-3
        with_size = descriptor_differences(made, with_size=True)
        assert with_size["eigenvalues"][0, 1] == pytest.approx(2 * math.log(3.0), rel=1e-6)

    def test_another_mesh_of_the_same_body(self) -> None:
        made = [described(Mesh(*shapes.icosphere(level)), Diffusion(0.1)) for level in (3, 2)]
        long = Mesh(shapes.icosphere(2)[0] * [1, 1, 4], shapes.icosphere(2)[1])
        other = described(long, Diffusion(0.1))
        for between in descriptor_differences([*made, other]).values():
            assert between[0, 1] < 0.4 * between[0, 2]

    def test_it_is_a_metric(self) -> None:
        bodies = [Polygon(L_SHAPE), Polygon([[0, 0], [3, 0], [3, 1], [0, 1]]), Polygon.of_loops(RING)]
        made = [shape_descriptors(InteriorDistance(body, Euclidean())) for body in bodies]
        for part, d in descriptor_differences(made).items():
            assert np.array_equal(d, d.T)
            assert np.all((d > 0.0) == ~np.eye(3, dtype=bool))
            assert all(d[i, k] <= d[i, j] + d[j, k] for i, j, k in permutations(range(3))), part

    def test_differences_are_those_of_the_definition(self) -> None:
        """Earth mover's distance by scipy, and the others by hand."""
        bodies = [Polygon.of_loops(RING), Polygon(np.array(L_SHAPE) * [1.0, 2.5])]
        one, other = (shape_descriptors(InteriorDistance(body, Euclidean())) for body in bodies)
        found = descriptor_differences([one, other])
        middles = (np.arange(DESCRIPTORS.bins) + 0.5) * DESCRIPTORS.widest / DESCRIPTORS.bins
        moved_by = scipy.stats.wasserstein_distance(middles, middles, one.distances, other.distances)
        assert found["distances"][0, 1] == pytest.approx(moved_by)
        both = np.isfinite(one.eigenvalues) & np.isfinite(other.eigenvalues)
        ratios = one.eigenvalues[both] / other.eigenvalues[both]
        assert found["eigenvalues"][0, 1] == pytest.approx(np.abs(np.log(ratios)).mean())
        assert found["potential"][0, 1] == pytest.approx(np.abs(one.potential - other.potential).mean())

    def test_a_distance_without_an_embedding(self) -> None:
        """Those of the commute time are drawn in pairs; they agree with a dense embedding of it."""
        solver = InteriorDistance(Mesh(*shapes.icosphere(1)), CommuteTime(), refine="no")
        found = shape_descriptors(solver)
        points = random_interior_points(solver.shape, DESCRIPTORS.costly_points)
        embedded = solver.embed(points)
        lengths = np.linalg.norm(embedded[:, None] - embedded, axis=2)
        every = lengths[np.triu_indices(len(points), 1)]
        assert found.mean_distance == pytest.approx(every.mean(), rel=0.02)

    @pytest.mark.parametrize("distance", [Euclidean(), CommuteTime()], ids=["euclidean", "commute"])
    def test_errors_cover_other_drawings(self, distance: Distance) -> None:
        """Of 28 pairs of drawings nearly all differ by less than is stated, and some by a third of it."""
        solver = InteriorDistance(l_prism(), distance, refine="no")
        few = replace(DESCRIPTORS, points=300, costly_points=100)
        made = [shape_descriptors(solver, replace(few, seed=seed)) for seed in range(8)]
        pairs = np.triu_indices(8, 1)
        for part, between in descriptor_differences(made).items():
            if part == "eigenvalues":
                assert not between.any()
                continue
            stated = np.array([getattr(one, f"{part}_error") for one in made])
            shares = between[pairs] / stated[pairs[0]]
            assert np.mean(shares < 1.0) > 0.85
            assert shares.max() > 1 / 3

    def test_there_and_back(self) -> None:
        """A square has three modes; what it lacks is NaN, and null in JSON."""
        square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
        found = described(square, Euclidean())
        assert np.count_nonzero(np.isfinite(found.eigenvalues)) == 3
        plain = found.as_dict()
        plain["eigenvalues"] = [None if math.isnan(one) else one for one in plain["eigenvalues"]]
        again = ShapeDescriptors.from_dict(plain)
        assert np.array_equal(again.eigenvalues, found.eigenvalues, equal_nan=True)
        assert not any(between.any() for between in descriptor_differences([found, again]).values())

    def test_what_cannot_be_compared(self) -> None:
        flat, solid = described(Polygon(L_SHAPE), Euclidean()), described(l_prism(), Euclidean())
        with pytest.raises(ValueError, match="a polygon and a mesh"):
            descriptor_differences([flat, solid])
        with pytest.raises(ValueError, match="no descriptors"):
            ShapeDescriptors.from_dict({"dimension": 3})
