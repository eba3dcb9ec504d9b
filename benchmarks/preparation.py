"""What comes before any distance: the check of a mesh, and the geodesics that an embedding is made of."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from bodies import Body, finer
from settings import Settings
from table import Bar, Row
from timing import seconds_of, take_turns

from idviewer.core import Geodesic, InteriorDistance, Mesh, read_mesh, sample_path
from idviewer.core.distances.geodesic_solvers import Geodesics

TITLE = "The check of a mesh, and the geodesic embedding"
NOTE = (
    "The bundled hand, for the check cut finer; 300 landmarks, by the heat method. The embedding's error is "
    "the mean difference of its distances from a vertex to the geodesics, as a share of their mean."
)
CHECKED_IN = Bar(10.0)
EMBEDDED_IN = Bar(60.0, error=0.2)
LANDMARKS = 300


def rows(settings: Settings) -> Iterator[Row]:
    large = read_mesh(sample_path("hand"))
    for _ in range(settings.doublings):
        large = finer(large)
    yield _check(large, settings)
    yield _embedding(read_mesh(sample_path("hand_27k" if settings.doublings else "hand_2k")))


def _check(mesh: Mesh, settings: Settings) -> Row:
    (spent,) = take_turns(settings.turns, lambda: Mesh(mesh.vertices, mesh.faces))
    return Row("mesh checked", Body(mesh).label, spent, "s", bar=CHECKED_IN)


def _embedding(mesh: Mesh) -> Row:
    made: list[InteriorDistance] = []
    geodesic = Geodesic(landmarks=LANDMARKS)
    spent = seconds_of(lambda: made.append(InteriorDistance(mesh, geodesic)))
    embedding = made[0].boundary.embedding
    found = np.linalg.norm(embedding - embedding[0], axis=1)
    exact = Geodesics(mesh, "heat").from_vertex(0)
    error = float(np.abs(found - exact).mean() / exact.mean())
    return Row("geodesic embedding", Body(mesh).label, spent, "s", error=error, bar=EMBEDDED_IN)
