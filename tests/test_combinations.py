"""Every distance with every kind of coordinates, in 2D and 3D: it runs, or one line says why not."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from tests.core.property_shapes import tells_points_apart
from tests.session.bodies import egg, few_samples  # noqa: F401
from tests.session.test_session import write_off

from idviewer.cli import main
from idviewer.core import (
    COORDINATES,
    DISTANCES,
    InteriorDistance,
    Mesh,
    Plane,
    Polygon,
    Shape,
    parameters_of,
    read_mesh,
    read_shape,
    sample_path,
    write_polygon,
)
from idviewer.core.distances import Integer, Number, distance_from
from idviewer.session.pipeline import Pipeline
from idviewer.session.state import Failure, Frame, FrameRequest, Query

ENDS = {2: ((0.0, 0.0), (0.05, 0.2)), 3: ((0.0, 0.3, 0.5), (0.1, -0.2, -0.4))}
GIVEN = ("matrix", "embedding")


@pytest.fixture(scope="module", params=[2, 3], ids=["2D", "3D"])
def file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A shape's file, with distances and an embedding of it beside."""
    folder = tmp_path_factory.mktemp("shapes")
    path = folder / ("star.csv" if request.param == 2 else "egg.off")
    shape: Shape
    if request.param == 2:
        star = read_shape(sample_path("star"))
        assert isinstance(star, Polygon)
        shape = star.resampled(30)
        write_polygon(shape, path)
    else:
        shape = egg(1)
        assert isinstance(shape, Mesh)
        write_off(path, shape)
    vertices = read_shape(path).vertices
    np.save(folder / "embedding.npy", vertices * np.arange(1.0, 1.0 + vertices.shape[1]))
    np.save(folder / "matrix.npy", np.linalg.norm(vertices[:, None] - vertices, axis=2))
    return path


def parameters(name: str, folder: Path) -> dict[str, str]:
    return {name: str(folder / f"{name}.npy")} if name in GIVEN else {}


@pytest.mark.slow
@pytest.mark.parametrize("coordinates", list(COORDINATES))
@pytest.mark.parametrize("name", list(DISTANCES))
def test_they_run_and_agree(
    file: Path, name: str, coordinates: str, capfd: pytest.CaptureFixture[str]
) -> None:
    shape = read_shape(file)
    source, other = ENDS[shape.dimension]
    given = parameters(name, file.parent)
    solver = InteriorDistance(shape, distance_from(name, given), coordinates)
    expected = float(solver.distance([source], [other])[0])
    assert np.isfinite(expected)
    assert expected > 0.0 or not tells_points_apart(coordinates)

    options = ["--distance", name, "--coordinates", coordinates, "--json"]
    options += [word for key, value in given.items() for word in ("--set", f"{key}={value}")]
    ends = ["--from", ",".join(map(str, source)), "--to", ",".join(map(str, other))]
    assert main(["distance", str(file), *ends, *options]) == 0
    out, err = capfd.readouterr()
    told = json.loads(out)
    assert (err, told["distance"], told["coordinates"]) == ("", name, coordinates)
    assert told["interior"] == pytest.approx(expected, rel=1e-9)
    assert main(["barycentroid", str(file), *options]) == 0
    out, err = capfd.readouterr()
    assert err == ""
    point = json.loads(out)["point"]
    assert solver.contains([point]).all()

    planes = () if shape.dimension == 2 else (_through(source),)
    query = Query(planes, (*source, 0.0)[:3], solver.boundary.distance, coordinates=coordinates)
    results = list(Pipeline().results(FrameRequest(shape, query)))
    assert not [one for one in results if isinstance(one, Failure)]
    frame = results[-1]
    assert isinstance(frame, Frame)
    assert frame.exact
    assert frame.remarks == ()
    np.testing.assert_allclose(frame.barycentroid[: shape.dimension], point, atol=1e-5 * shape.diagonal)
    (one,) = frame.slices
    inner = np.setdiff1d(np.arange(len(one.points)), np.concatenate(one.outline))[::20]
    field = solver.field(source, one.points[inner, : shape.dimension])
    np.testing.assert_allclose(one.values[inner], field, rtol=1e-6, atol=1e-7 * field.max())


def _through(point: tuple[float, ...]) -> Plane:
    x, y, z = point
    return Plane((x, y, z), (0.2, 1.0, 0.1))


@pytest.mark.slow
@pytest.mark.parametrize("coordinates", list(COORDINATES))
def test_what_would_not_fit_says_why_in_one_line(coordinates: str, tmp_path: Path) -> None:
    hand = read_mesh(sample_path("hand"))
    np.save(tmp_path / "matrix.npy", np.ones((3, 3)))
    kinds = (distance_from("commute", {}), distance_from("matrix", {"matrix": str(tmp_path / "matrix.npy")}))
    for kind in kinds:
        *_, failure = Pipeline().results(FrameRequest(hand, Query(distance=kind, coordinates=coordinates)))
        assert isinstance(failure, Failure)
        assert "\n" not in str(failure.error)
        assert "7,000 vertices" in str(failure.error)


NUMBERS = [
    (kind, name)
    for kind in DISTANCES
    for name, one in parameters_of(DISTANCES[kind]).items()
    if isinstance(one, Number | Integer)
]


@pytest.mark.parametrize(("kind", "parameter"), NUMBERS)
def test_numbers_that_mean_nothing_are_refused_in_one_line(
    kind: str, parameter: str, capfd: pytest.CaptureFixture[str]
) -> None:
    ends = ("--from", "0,0,0.05", "--to", "0,0,0.15")
    for value in ("-1", "0", "nan", "inf", "-inf", "1e999", "x", ""):
        option = f"{parameter}={value}"
        assert main(["distance", "hand_2k", *ends, "--distance", kind, "--set", option]) == 2
        out, err = capfd.readouterr()
        assert (out, err.count("\n")) == ("", 1)
        assert f"--set {option}: " in err
