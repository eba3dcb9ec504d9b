"""The pipeline with distances of every kind: bases are made in steps and kept, failures lose nothing."""

from __future__ import annotations

import numpy as np
import pytest
from tests.session.bodies import egg, few_samples  # noqa: F401

from idviewer.core import (
    CommuteTime,
    Diffusion,
    Distance,
    Geodesic,
    GivenDistances,
    GivenEmbedding,
    InteriorDistance,
    Plane,
    SpectralFilter,
)
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import Failure, Frame, FrameRequest, Progress, Query

MESH = egg(2)
PLANE = Plane((0.1, 0.0, 0.0), (1.0, 0.2, 0.1))
SOURCE = (0.0, 0.3, 0.5)


def query(distance: Distance, source: tuple[float, float, float] | None = SOURCE) -> FrameRequest:
    return FrameRequest(MESH, Query((PLANE,), source, distance))


def run(pipeline: Pipeline, request: FrameRequest) -> list:
    return [one for one in pipeline.results(request) if one is not None]


@pytest.fixture(scope="module")
def pipeline() -> Pipeline:
    made = Pipeline()
    run(made, query(Diffusion()))
    return made


@pytest.mark.slow
@pytest.mark.parametrize(
    "distance",
    [
        CommuteTime(),
        Geodesic(),
        Geodesic(landmarks=40),
        SpectralFilter("1 / (1 + lambda)"),
        GivenEmbedding(MESH.vertices * [1.0, 2.0, 3.0]),
        GivenDistances(np.linalg.norm(MESH.vertices[:, None] - MESH.vertices, axis=2)),
    ],
)
def test_the_last_frame_is_the_library_s_field(pipeline, distance):
    for made in (pipeline, Pipeline()):
        frame = run(made, query(distance))[-1]
        assert isinstance(frame, Frame)
        assert frame.exact
        (one,) = frame.slices
        inner = np.ones(len(one.points), dtype=bool)
        inner[np.concatenate(one.outline)] = False
        expected = InteriorDistance(MESH, distance).field(SOURCE, one.points[inner])
        np.testing.assert_allclose(one.values[inner], expected, rtol=1e-6, atol=1e-9 * expected.max())
        assert frame.title.startswith(distance.title)


@pytest.mark.slow
def test_progress_is_told_and_a_basis_is_made_once(pipeline):
    request = query(Geodesic(landmarks=60))
    stages = [one for one in run(pipeline, request) if isinstance(one, Progress)]
    shares = [one.share for one in stages if one.stage == "Preparing the geodesic distance" and one.share]
    assert len(shares) >= 60
    assert shares == sorted(shares)
    run(pipeline, query(Diffusion(time=0.3)))
    moved = run(pipeline, query(Geodesic(landmarks=60), (0.0, 0.1, 0.2)))
    assert not [one for one in moved if isinstance(one, Progress) and one.stage.startswith("Preparing")]


def test_a_half_made_basis_goes_on_where_a_newer_query_left_it(pipeline):
    first = pipeline.results(query(Geodesic(landmarks=70)))
    for _ in range(40):
        last = next(first)
    first.close()
    following = next(iter(pipeline.results(query(Geodesic(landmarks=70), (0.0, 0.1, 0.2)))))
    assert following.stage == last.stage
    assert following.share > last.share


@pytest.mark.parametrize(
    ("distance", "part"),
    [
        (GivenDistances(np.ones((3, 3))), "its shape is (3, 3)"),
        (GivenEmbedding("nowhere.npy"), "nowhere.npy"),
        (SpectralFilter("lambda - 100"), "is -"),
        (SpectralFilter("1e-200 / lambda"), "is too small"),
        (Diffusion(time=1e300), "the diffusion time 1e+300 is too long for this shape"),
    ],
)
def test_failures_are_told_and_what_was_there_stays(pipeline, distance, part):
    (failure,) = (one for one in run(pipeline, query(distance)) if isinstance(one, Failure))
    assert part in str(failure.error)
    again = run(pipeline, query(Diffusion()))
    assert not [one for one in again if isinstance(one, Progress)]
    assert again[-1].exact
