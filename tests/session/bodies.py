"""Meshes, planes and an owner's thread for the session's tests."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core import Mesh, Plane
from idviewer.core.sampling import settings
from idviewer.session.session import Session
from idviewer.session.spectrum_cache import SpectrumCache

WAIT = 300.0
"""Seconds after which a test that waits for the compute thread fails."""


def egg(level: int = 3) -> Mesh:
    """A smooth body whose shortest side is along x."""
    vertices, faces = shapes.icosphere(level)
    bump = 1 + 0.2 * np.sin(3 * vertices[:, 0] + 1) * vertices[:, 2]
    return Mesh(vertices * [1.0, 1.4, 2.2] * bump[:, None], faces, name="egg")


@pytest.fixture(scope="module", autouse=True)
def few_samples() -> Iterator[None]:
    """A module that imports this has a quarter of the samples on slices: each is computed like the others."""
    with pytest.MonkeyPatch.context() as patch:
        few = replace(settings.SAMPLING, coarsest_nodes=settings.SAMPLING.coarsest_nodes // 4)
        patch.setattr(settings, "SAMPLING", few)
        yield


class Owner:
    """Stands for the GUI thread: runs what is posted, when the test says so."""

    def __init__(self) -> None:
        self._posted: queue.Queue[Callable[[], None]] = queue.Queue()

    def post(self, call: Callable[[], None]) -> None:
        """From any thread."""
        self._posted.put(call)

    def run_until(self, done: Callable[[], bool]) -> None:
        """Run what is posted until done; raises queue.Empty if nothing comes any more."""
        while not done():
            self._posted.get(timeout=WAIT)()

    def run_all(self) -> None:
        """Run what has been posted up to now."""
        while not self._posted.empty():
            self._posted.get()()


class WatchedSession:
    """A session with its owner's thread, and a log of all that it tells; closed at the end of a `with`."""

    def __init__(self, cache: SpectrumCache | None = None) -> None:
        self.owner = Owner()
        self.session = Session(self.owner.post, cache=cache)
        self.log: list[tuple] = []
        for name in ("changed", "opened", "prepared", "frame_ready", "progressed", "failed"):
            getattr(self.session, name).connect(lambda *told, name=name: self.log.append((name, *told)))

    def __enter__(self) -> WatchedSession:
        return self

    def __exit__(self, *_: object) -> None:
        self.session.close()

    def settle(self) -> None:
        """Until nothing is computed or read any more."""
        self.owner.run_until(lambda: not self.session.busy)

    def told(self, name: str) -> list[tuple]:
        """What a signal told, in order."""
        return [entry[1:] for entry in self.log if entry[0] == name]


def random_planes(mesh: Mesh, count: int, rng: np.random.Generator) -> list[Plane]:
    """Planes at random angles that cut the body not too near its ends."""
    planes = []
    for _ in range(count):
        normal = rng.standard_normal(3)
        normal /= np.linalg.norm(normal)
        heights = mesh.vertices @ normal
        height = heights.min() + rng.uniform(0.1, 0.9) * np.ptp(heights)
        planes.append(Plane(tuple((height * normal).tolist()), tuple(normal.tolist())))
    return planes
