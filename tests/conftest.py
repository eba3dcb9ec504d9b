"""What all tests share: seeded random numbers, repeatable hypothesis, and no need of Qt without windows."""

from __future__ import annotations

import importlib.util

import hypothesis
import numpy as np
import pytest

hypothesis.settings.register_profile("repeatable", derandomize=True, deadline=None)
hypothesis.settings.load_profile("repeatable")

OPTIONS_OF = {
    "pytestqt": ["qt_api"],
    "pytest_xvfb": ["xvfb_width", "xvfb_height", "xvfb_colordepth"],
}
"""Settings in pyproject.toml that belong to the plugins which drive windows."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Lets the settings of the window plugins stand where these are not installed (`make test-core`)."""
    for plugin, names in OPTIONS_OF.items():
        if importlib.util.find_spec(plugin) is None:
            for name in names:
                parser.addini(name, f"of {plugin}, which is not installed")


@pytest.fixture
def rng() -> np.random.Generator:
    """Random numbers that are the same in every run and every test."""
    return np.random.default_rng(20090715)
