"""`idviewer batch`: every kind of result against the library, the table, manifests, and what is refused."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from PIL import Image
from tests.cli.commands import Run, refused
from tests.core import shapes

from idviewer.cli import batch_command
from idviewer.cli.batch_outputs import write_landmarks
from idviewer.cli.collection_options import OutputOptions
from idviewer.cli.options import DistanceOptions, ReadingOptions
from idviewer.core import Euclidean, InteriorDistance, Mesh, discretisation, read_shape, repair_mesh


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Shapes in the folder in which commands run: a soup of triangles, a polygon and something torn."""
    vertices, faces = shapes.icosphere(1)
    soup = (vertices * [1.0, 1.0, 2.0])[faces].reshape(-1, 3)
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in soup]
    lines += [f"f {i + 1} {i + 2} {i + 3}" for i in range(0, len(soup), 3)]
    (tmp_path / "egg.obj").write_text("\n".join(lines))
    (tmp_path / "flat.csv").write_text("0,0\n3,0\n3,1\n1,1\n1,2\n0,2\n")
    (tmp_path / "torn.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    (tmp_path / "egg.points.csv").write_text("x,y,z,id\n0,0,0,a\n0,0,1.5,b\n0,0,3,c\n0.2,0.1,-1,d\n")
    (tmp_path / "flat.points.csv").write_text("vertex\n3\n0\n")
    (tmp_path / "torn.points.csv").write_text("0,0,0\n")
    return tmp_path


def rows_in(path: Path) -> dict[str, dict[str, str]]:
    with path.open(newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


@pytest.mark.slow
@pytest.mark.refined  # as in the processes that compute them
def test_every_result_is_that_of_the_library(run: Run, folder: Path) -> None:
    files = ("egg.obj", "flat.csv", "torn.off", "missing.ply")
    wanted = ("--pictures", "--descriptors", "--fields", "--landmarks", "{stem}.points.csv", "--grids", "7")
    small = ("--size", "64x48", "--jobs", "1", "--parquet", "--refine", "no")
    answer = run("batch", *files, "--out", "out", *wanted, *small)
    assert answer.status == 1
    assert answer.out.split() == [str(folder / "out" / f"results.{kind}") for kind in ("csv", "parquet")]
    events = [json.loads(line) for line in answer.err.splitlines()]
    assert (events[0]["event"], events[-1]["event"]) == ("begun", "finished")
    assert (events[-1]["computed"], events[-1]["failed"]) == (2, 2)
    for name, file in (("egg", "egg.obj"), ("flat", "flat.csv")):
        solver = InteriorDistance(read_shape(folder / file), refine="no")
        stored = json.loads((folder / "out" / f"{name}.json").read_text())
        check_numbers(stored, solver)
        check_landmarks(folder / "out" / f"{name}.landmarks.csv", solver, folder / f"{name}.points.csv")
        check_fields(folder / "out" / f"{name}.vtp", solver, np.array(stored["result"]["barycentroid"]))
        check_grid(folder / "out" / f"{name}.grid.npz", solver, np.array(stored["result"]["barycentroid"]))
        with Image.open(folder / "out" / f"{name}.png") as picture:
            assert picture.size == (64, 48)
    check_tables(folder / "out")
    again = run("batch", *files[:2], "--out", "out", *wanted, *small)  # for which no process is started
    assert again.err.count('"event": "kept"') == 2
    assert again.err.count('"event": "computed"') == 0


def check_numbers(stored: dict, solver: InteriorDistance) -> None:
    result, found = stored["result"], solver.barycentroid()
    assert np.allclose(result["eigenvalues"], solver.spectrum.values, rtol=1e-9)
    assert result["lambda_2"] == result["eigenvalues"][0]
    assert result["distance"]["time"] == pytest.approx(1 / (8 * result["lambda_2"]))
    assert solver.potential([result["barycentroid"]]) == pytest.approx(found.potential, rel=1e-6)
    embedded = solver.boundary.embedding
    largest = np.linalg.norm(embedded[:, None] - embedded, axis=2).max()
    assert 0.9 * largest < result["largest_distance"] <= largest * (1 + 1e-12)
    stated = discretisation(solver).summary
    assert result["discretisation"]["distances"] == pytest.approx(stated.total_distances, rel=1e-6)
    assert result["info"]["usable"] is True
    assert len(result["descriptors"]["eigenvalues"]) == 20
    assert set(stored["made_by"]["seconds"]) >= {"reading", "distance", "picture", "all"}


def check_landmarks(path: Path, solver: InteriorDistance, points_file: Path) -> None:
    if isinstance(solver.shape, Mesh):
        names, points = list("abcd"), np.loadtxt(points_file, delimiter=",", skiprows=1, usecols=(0, 1, 2))
    else:
        names, points = ["3", "0"], np.array([[1.0, 1.0], [0.0, 0.0]])
    with path.open() as file:
        header, *rows = csv.reader(file)
    assert header == ["landmark", *names]
    found = np.array([[float(cell or "nan") for cell in row[1:]] for row in rows])
    exact = [solver.distance(points, point[None]) for point in points]
    assert np.allclose(found, exact, rtol=1e-9, equal_nan=True)
    assert np.array_equal(found, found.T, equal_nan=True)


def check_fields(path: Path, solver: InteriorDistance, centre: np.ndarray) -> None:
    """At the vertices of the file, whose order they have, though the mesh has fewer."""
    data = pv.read(path)
    shape = solver.shape
    if isinstance(shape, Mesh):
        assert (data.n_points, len(shape.vertices)) == (240, 42)
        assert np.array_equal(data["file_vertex"], np.arange(240))
        assert data.n_cells == 80
        volume = abs(data.volume)
        assert volume == pytest.approx(shape.volume)
    points = np.asarray(data.points)[:, : shape.dimension]
    assert np.allclose(data["potential"], solver.potential(points), rtol=1e-6)
    assert np.allclose(data["distance_from_barycentroid"], solver.field(centre, points), rtol=1e-5)


def check_grid(path: Path, solver: InteriorDistance, centre: np.ndarray) -> None:
    stored = np.load(path)
    nodes = np.stack(np.indices(stored["potential"].shape), axis=-1) * stored["spacing"] + stored["origin"]
    flat = nodes.reshape(-1, solver.shape.dimension)
    lower, upper = solver.shape.bounds
    assert np.all(flat.min(axis=0) <= lower + 1e-9)
    assert np.all(flat.max(axis=0) >= upper - 1e-9)
    assert max(stored["potential"].shape) == 7
    inside = np.isfinite(stored["potential"].ravel())
    assert inside.any()
    assert not inside.all()
    assert np.allclose(stored["potential"].ravel(), solver.potential(flat), rtol=1e-9, equal_nan=True)
    distances = stored["distance_from_barycentroid"].ravel()
    assert np.allclose(distances, solver.field(centre, flat), rtol=1e-9, equal_nan=True)


def check_tables(folder: Path) -> None:
    from pyarrow import parquet

    rows = rows_in(folder / "results.csv")
    assert [row["status"] for row in rows.values()] == ["done", "done", "failed", "failed"]
    assert "boundary edges" in rows["torn"]["reason"]
    assert "No such file" in rows["missing"]["reason"]
    table = parquet.read_table(folder / "results.parquet").to_pylist()
    assert [row["name"] for row in table] == list(rows)
    for row in table:
        for name, value in row.items():
            text = rows[row["name"]][name]
            assert text == ("" if value is None else repr(value) if isinstance(value, float) else str(value))


def test_rows_of_a_manifest_have_options_of_their_own(run: Run, folder: Path) -> None:
    (folder / "list.csv").write_text(
        "path,name,time,coordinates,distance,component,landmarks,fill-holes,drop-walls,kind\n"
        "flat.csv,short,0.01,,,,{stem}.points.csv,,,a\nflat.csv,long,,shepard,gps,,,,,b\n"
        "egg.obj,,,,,2,,7,yes,a\n"
    )
    listed = batch_command.listed((), Path("list.csv"), Path("out"))
    given = ReadingOptions(fill_holes=3, part="x"), DistanceOptions(coordinates="maximum_entropy")
    short, long, usual = batch_command.tasks_of(listed, OutputOptions(), *given)
    assert [task.name for task in (short, long, usual)] == ["short", "long", "egg"]
    assert [task.labels for task in (short, long, usual)] == [{"kind": "a"}, {"kind": "b"}, {"kind": "a"}]
    own = {key: long.options["distance"][key] for key in ("distance", "time", "coordinates")}
    assert own == {"distance": "gps", "time": None, "coordinates": "shepard"}
    assert short.options["distance"]["time"] == 0.01
    assert short.options["distance"]["coordinates"] == "maximum_entropy"
    assert short.inputs == (folder / "flat.points.csv",)
    assert long.inputs == ()
    own = {key: usual.options["reading"][key] for key in ("component", "fill_holes", "drop_walls", "part")}
    assert own == {"component": "2", "fill_holes": 7, "drop_walls": True, "part": "x"}
    assert (short.options["reading"]["fill_holes"], short.options["reading"]["component"]) == (3, None)
    answer = run("batch", "--manifest", "list.csv", "--out", "out", "--time", "0.5")
    assert "line 3: --time 0.5: gps has no time" in refused(answer)


def test_vertices_that_were_dropped_are_outside(tmp_path: Path) -> None:
    corners, faces = shapes.tetrahedron()
    mesh = repair_mesh(np.concatenate([[[9.0, 9.0, 9.0]], corners]), faces + 1)
    (tmp_path / "marks.csv").write_text('"Vertex"\n4\n0\n1\n')
    solver = InteriorDistance(mesh, Euclidean())
    told = write_landmarks(tmp_path / "out.csv", solver, tmp_path / "marks.csv")
    assert told["outside"] == ["0"]
    assert (tmp_path / "out.csv").read_text() == "landmark,4,0,1\n4,0.0,,1.0\n0,,,\n1,1.0,,0.0\n"
    (tmp_path / "marks.csv").write_text("vertex\n5\n")
    with pytest.raises(
        ValueError, match=r"line 2: '5' is no vertex of the shape's file, where they are 0 to 4"
    ):
        write_landmarks(tmp_path / "out.csv", solver, tmp_path / "marks.csv")


def test_files_of_a_distance_are_inputs(run: Run, folder: Path) -> None:
    np.save(folder / "d.npy", np.zeros((3, 3)))
    options = DistanceOptions(distance="matrix", set=("matrix=d.npy", "fit=approximate"))
    listed = batch_command.listed(("flat.csv",), None, Path("out"))
    (task,) = batch_command.tasks_of(listed, OutputOptions(), ReadingOptions(), options)
    assert task.inputs == (folder / "d.npy",)
    assert task.options["distance"]["set"] == [f"matrix={folder / 'd.npy'}", "fit=approximate"]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((), "no shapes are named"),
        (("*.xyz",), "no file has such a name"),
        (("star", "--shard", "3/2"), "--shard 3/2"),
        (("star", "--jobs", "0"), "at least one process"),
        (("star", "--memory", "nan"), "--memory nan"),
        (("star", "--grids", "1"), "--grids 1"),
        (("star", "--plane", "z=0.5"), "add --pictures"),
        (("star", "--opacity", "0.5"), "add --pictures"),
        (("star", "--grid-format", "vti"), "add --grids N"),
        (("star", "--distance", "none"), "there is no such distance"),
        (("star", "--pictures", "--size", "1"), "--size 1"),
        (("star", "--scheduler", "tcp://127.0.0.1:9", "--jobs", "2"), "leave --jobs and --memory out"),
        (("--manifest", "none.csv"), "none.csv"),
    ],
)
def test_what_cannot_start_is_refused(run: Run, arguments: tuple[str, ...], complaint: str) -> None:
    assert complaint in refused(run("batch", *arguments, "--out", "out"))
    assert not Path("out").exists()


def test_packages_that_are_missing_are_named(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    from idviewer.batch import dask_cluster, result_table

    for module in (dask_cluster, result_table):
        monkeypatch.setattr(module, "find_spec", lambda name: None)
    for option in (("--parquet",), ("--scheduler", "tcp://127.0.0.1:9")):
        assert "pip install 'idviewer[batch]'" in refused(run("batch", "star", "--out", "out", *option))


def test_a_share_without_shapes(run: Run, tmp_path: Path) -> None:
    """An array job may have more tasks than there are shapes."""
    answer = run("batch", "star", "--out", "out", "--shard", "2/2", "--quiet")
    assert answer.status == 0
    assert (tmp_path / "out" / "results-2-of-2.csv").read_text().startswith("name,path,status,reason")
