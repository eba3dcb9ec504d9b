"""A mesh that does not fit into memory is refused before the work, with the figures."""

from __future__ import annotations

import numpy as np
import pytest
from tests.core import shapes

from idviewer.core import InteriorDistance, Mesh, MeshError, Polygon, eigenpairs
from idviewer.core.spectrum import eigen_solver, memory_estimate
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import Failure, OpenRequest

LINE = (
    r"^ball has 2,562 vertices and would need about 51 MB; this machine has 9 MB: "
    r"simplify it to about 450 vertices$"
)


@pytest.fixture(scope="module")
def ball() -> Mesh:
    return Mesh(*shapes.icosphere(4), name="ball")


@pytest.fixture
def small_machine(monkeypatch):
    monkeypatch.setattr(memory_estimate, "available_bytes", lambda: 9e6)


@pytest.mark.parametrize("work", [eigenpairs, InteriorDistance])
def test_the_library_refuses_before_it_factors_anything(ball, small_machine, monkeypatch, work):
    monkeypatch.setattr(eigen_solver, "masses_of", lambda shape: pytest.fail("work was begun"))
    with pytest.raises(MeshError, match=LINE):
        work(ball)


def test_what_is_open_stays_when_a_file_is_too_large(small_machine, tmp_path):
    vertices, faces = shapes.icosphere(4)
    path = tmp_path / "ball.off"
    with path.open("w") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        np.savetxt(file, vertices)
        np.savetxt(file, np.column_stack([np.full(len(faces), 3), faces]), fmt="%d")
    *_, last = Pipeline().results(OpenRequest(path))
    assert isinstance(last, Failure), "no Opened: the session keeps its shape"
    with pytest.raises(MeshError, match=LINE):
        raise last.error


def test_polygons_and_small_meshes_pass(ball):
    memory_estimate.check_memory(Polygon(shapes.star(60)), available=1.0)
    memory_estimate.check_memory(ball, available=memory_estimate.needed_bytes(2562))


@pytest.mark.parametrize("bytes_there", [1e7, 3.1e9, 2.5e10, 1e13])
def test_the_size_that_is_recommended_fits_and_is_not_timid(bytes_there):
    count = memory_estimate.vertices_for(bytes_there)
    assert 0.85 * bytes_there < memory_estimate.needed_bytes(count) <= bytes_there


def test_need_grows_with_size_and_half_a_million_vertices_fit_into_six_gigabytes():
    needs = [memory_estimate.needed_bytes(count) for count in (4, 27_000, 134_000, 537_000, 12_000_000)]
    assert needs == sorted(needs)
    assert needs[3] < 6e9
    assert needs[4] > 6e10


def test_a_container_s_limit_counts(tmp_path):
    limits = (tmp_path / "memory.max", tmp_path / "missing")
    limits[0].write_text("max\n")
    assert memory_estimate.available_bytes(limits) > 1e6
    limits[0].write_text("1000000\n")
    memory_estimate.available_bytes.cache_clear()
    assert memory_estimate.available_bytes(limits) == 1e6
