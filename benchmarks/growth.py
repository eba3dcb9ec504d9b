"""How the cost of a sample grows with the number of faces: one shape, made finer and finer."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from bodies import SEED, Body, Floats, bumpy, finer, inner_points, slice_points
from settings import Settings
from table import Bar, Row
from timing import seconds_of, take_turns
from truth import embedding_error

from idviewer.core import MeanValueCoordinates, Mesh, read_mesh, sample_path
from idviewer.core.coordinates import Approximation
from idviewer.core.interior import extent
from idviewer.core.steps import finish

TITLE = "Growth: a sample within 1e-3 on finer and finer meshes"
NOTE = (
    "The bundled hand, cut finer by midpoints, smoothed and with small waves; 64 smooth values a vertex. "
    "One size against another is the ratio of their times. Errors are checked at 200 points."
)
RTOL = 1e-3
INNER, ON_SLICE, CHECKED = 8000, 500, 200
COLUMNS = 64
FACTOR, ENOUGH = Bar(2.5), 3
"""Wanted of 1M faces against 10K; three doublings, 896K against 14K, come near it."""


def rows(settings: Settings) -> Iterator[Row]:
    mesh = read_mesh(sample_path("hand"))
    sized = []
    for doubling in range(settings.doublings + 1):
        mesh = finer(mesh) if doubling else mesh
        sized.append(_Sized(Body(bumpy(mesh))))
        yield Row("tree built", sized[-1].body.label, sized[-1].built, "s")
    for words, points in (("8,000 inner points", INNER), ("500 points of a slice", ON_SLICE)):
        spent = take_turns(settings.turns, *(one.sampling(points) for one in sized))
        a_point = [1e6 * s / one.count(points) for s, one in zip(spent, sized, strict=True)]
        for one, cost in zip(sized, a_point, strict=True):
            yield Row(f"a sample of {words}", one.body.label, cost, "µs", error=one.error(points))
        ends = f"{sized[-1].body.size} against {sized[0].body.size}"
        bar = FACTOR if settings.doublings >= ENOUGH else None
        yield Row(f"a sample of {words}", ends, a_point[-1] / a_point[0], "x", bar=bar, readme=True)


class _Sized:
    """A body of one size, with values at its vertices ready to be sampled."""

    def __init__(self, body: Body) -> None:
        self.body = body
        self._values = smooth_values(body.mesh)
        self._coordinates = MeanValueCoordinates(body.mesh)
        self._largest = extent(self._values)
        weights = np.full(COLUMNS, 1.0 / self._largest)
        self._approximation: Approximation = self._coordinates.approximation(self._values, weights)
        self.built = seconds_of(lambda: finish(self._approximation.prepare_steps(RTOL)))
        self._points = {INNER: inner_points(body.mesh, INNER), ON_SLICE: slice_points(body.mesh, ON_SLICE)}

    def count(self, points: int) -> int:
        return len(self._points[points])

    def sampling(self, points: int) -> Callable[[], Floats]:
        return partial(self._sample, self._points[points])

    def error(self, points: int) -> float:
        some = self._points[points][:CHECKED]
        exact = finish(self._coordinates.interpolate_steps(some, self._values))
        return embedding_error(self._sample(some), exact, self._largest)

    def _sample(self, points: Floats) -> Floats:
        return finish(self._approximation.interpolate_steps(points, RTOL))


def smooth_values(mesh: Mesh) -> Floats:
    """(n, 64) waves over space, the shorter the weaker, as the columns of a diffusion map are."""
    generator = np.random.default_rng(SEED)
    places = (mesh.vertices - mesh.bounds.mean(axis=0)) / mesh.diagonal
    lengths = np.linspace(2.0, 30.0, COLUMNS)
    directions = generator.standard_normal((COLUMNS, 3))
    directions *= (lengths / np.linalg.norm(directions, axis=1))[:, None]
    phases = generator.uniform(0.0, 2.0 * np.pi, COLUMNS)
    return np.exp(-((lengths / 12.0) ** 2)) * np.cos(places @ directions.T + phases)
