"""The scale bar: true labels, and the colours of the slices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.view.frames import disc, frame, shown, sphere
from tests.view.stage import SIDE, apart, color_of, stage

from idviewer.view.scale_bar import MAX_LABELS, ROUND_STEPS, nice_labels

WHITE = (255, 255, 255)
NO_SOURCE = {"source": np.array([50.0, 0.0, 0.0])}
"""Out of the picture, so that the dot does not cover what is looked at."""


@pytest.fixture(scope="module")
def ball():
    return sphere()


@given(st.floats(-100.0, 100.0), st.floats(1e-9, 1e6))
def test_labels_are_round_evenly_spaced_and_true(start, span):
    low, high = start * span, (start + 1) * span
    ticks, texts, factor = nice_labels(low, high)
    power = float(factor.replace("×", "").replace("−", "-")) if factor else 1.0
    assert 2 <= len(ticks) <= MAX_LABELS
    step = np.diff(ticks)
    assert np.allclose(step, step[0], rtol=1e-6, atol=1e-15 * np.abs(ticks).max())
    digits = step[0] / 10 ** np.floor(np.log10(step[0]) + 1e-6)
    assert np.abs(np.array(ROUND_STEPS) - digits).min() < 1e-5
    assert len(texts) == len(ticks) == len(set(texts))
    assert np.all((ticks >= low - 1e-6 * span) & (ticks <= high + 1e-6 * span))
    read = np.array([float(text.replace("−", "-")) for text in texts]) * power
    assert np.allclose(read, ticks, atol=1e-6 * span, rtol=1e-9)


def test_the_scale_bar_shows_the_colors_and_can_be_switched_off(ball):
    with stage() as on:
        on.scene.show_frame(frame(ball, disc(radius=0.3), **NO_SOURCE))
        on.scene.show(shown(ball, scale_bar=True))
        picture = on.picture()
        on.scene.show(shown(ball))
        assert apart(on.picture()[:, SIDE // 2 + 60 :].reshape(-1, 3), WHITE) == 0
    column = next(c for c in range(SIDE - 1, 0, -1) if apart(picture[SIDE // 2, c], color_of(0.5)) <= 8) - 4
    rows = [SIDE / 2 + 125 - 250 * level for level in (0.02, 0.25, 0.5, 0.75, 0.98)]
    for row, level in zip(rows, (0.02, 0.25, 0.5, 0.75, 0.98), strict=True):
        assert apart(picture[round(row), column], color_of(level)) <= 10
