"""Distances from a simplified mesh: near the final ones, and as near as they say."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core import GPS, Biharmonic, Diffusion, InteriorDistance, Mesh, read_mesh, sample_path
from idviewer.core.interior import extent, preview
from idviewer.core.interior.barycentroid import interior_samples
from idviewer.core.interior.preview import PreviewSettings, preview_cutoff, preview_steps
from idviewer.core.interior.preview_solver import preview_solver
from idviewer.core.spectrum.eigen_solver import eigenpairs
from idviewer.core.steps import finish

PAIRS = 5000


@pytest.fixture(autouse=True)
def _small(monkeypatch):
    settings = PreviewSettings(least_vertices=1000, vertices=1200, coarser_vertices=300)
    monkeypatch.setattr(preview, "PREVIEW_SETTINGS", settings)


def lump(seed: int) -> Mesh:
    """A smooth body with bumps at random."""
    rng = np.random.default_rng(seed)
    vertices, faces = shapes.icosphere(4)
    waves, phases = rng.normal(0.0, 2.0, (5, 3)), rng.uniform(0.0, 6.0, 5)
    bumps = 1.0 + 0.08 * np.sin(vertices @ waves.T + phases).sum(axis=1)
    return Mesh(vertices * bumps[:, None] * rng.uniform(0.5, 2.0, 3), faces)


def apart(rows: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    return np.linalg.norm(rows[pairs[0]] - rows[pairs[1]], axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["hand_2k", "octopus_2k", 1, 2])
def test_the_true_error_is_within_the_estimate_and_not_far_below(shape, rng):
    mesh = read_mesh(sample_path(shape)) if isinstance(shape, str) else lump(shape)
    spectrum, inner = eigenpairs(mesh), interior_samples(mesh)
    for distance in (Diffusion(), GPS(), Biharmonic()):
        made = finish(preview_steps(mesh, preview_cutoff(distance)))
        exact, near = InteriorDistance(mesh, distance, spectrum=spectrum), preview_solver(made, distance)
        rows = exact.boundary.embedding
        transferred = made.transfer_matrix() @ near.boundary.embedding
        pairs, inner_pairs = (rng.integers(0, len(some), (2, PAIRS)) for some in (rows, inner))
        errors = np.abs(apart(rows, pairs) - apart(transferred, pairs)).max()
        inside = np.abs(apart(exact.embed(inner), inner_pairs) - apart(near.embed(inner), inner_pairs)).max()
        estimate = made.error(distance) * extent(rows)
        assert max(errors, inside) <= estimate <= 10.0 * errors


def test_only_modes_that_count_in_a_picture_are_computed():
    diffusion, time = preview_cutoff(Diffusion()), 1.0 / 8.0
    weight = np.exp(-diffusion(1.0) * time) / np.exp(-time)
    assert (
        0.5 * preview.PREVIEW_SETTINGS.negligible_weight
        < weight
        <= preview.PREVIEW_SETTINGS.negligible_weight
    )
    assert preview_cutoff(GPS())(1.0) == pytest.approx(GPS().cutoff(1.0))


@pytest.mark.slow
def test_a_preview_made_for_one_distance_serves_those_without_further_modes():
    made = finish(preview_steps(lump(1), preview_cutoff(Diffusion())))
    assert made.serves(Diffusion())
    assert not made.serves(GPS())


@pytest.mark.slow
def test_points_between_the_two_surfaces_have_values_and_those_outside_have_none():
    mesh = lump(1)
    made = finish(preview_steps(mesh, preview_cutoff(Diffusion())))
    near = preview_solver(made, Diffusion())
    assert np.isfinite(near.embed(mesh.vertices[::7])).all()
    assert np.isnan(near.embed(1.5 * mesh.vertices[:3])).all()
    assert made.keeps_inside(near.barycentroid().point)
    assert not made.keeps_inside(near.shape.vertices[0])


def test_small_meshes_have_no_preview(monkeypatch):
    assert finish(preview_steps(read_mesh(sample_path("hand_2k")), preview_cutoff(Diffusion()))) is not None
    monkeypatch.setattr(preview, "PREVIEW_SETTINGS", PreviewSettings(least_vertices=10_000))
    assert finish(preview_steps(read_mesh(sample_path("hand_2k")), preview_cutoff(Diffusion()))) is None
