"""`idviewer compare`: shapes and results, the matrix, the dendrogram, and what cannot be compared."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.cli.commands import Run

from idviewer.batch import Task
from idviewer.batch.result_files import write_result
from idviewer.batch.task import Made
from idviewer.core import Euclidean, InteriorDistance, Polygon
from idviewer.core.interior import descriptor_differences, shape_descriptors
from idviewer.view.dendrogram import groups_of

OUTLINES = {"square": (1.0, 1.0), "large": (5.0, 5.0), "oblong": (4.0, 1.0)}


def rectangle(width: float, height: float) -> Polygon:
    x, y = np.linspace(0.0, width, 9)[:-1], np.linspace(0.0, height, 9)[:-1]
    sides = [(x, 0 * x), (0 * y + width, y), (width - x, 0 * x + height), (0 * y, height - y)]
    return Polygon(np.concatenate([np.column_stack(side) for side in sides]))


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """A folder of results as `batch` writes them."""
    folder = tmp_path / "results"
    folder.mkdir()
    for name, sizes in OUTLINES.items():
        made = shape_descriptors(InteriorDistance(rectangle(*sizes), Euclidean())).as_dict()
        task = Task(name, tmp_path / f"{name}.csv", {"distance": {"distance": "euclidean"}})
        write_result(folder, task, "key", Made({"descriptors": made}, {}, {}), 0.0)
    (folder / "torn.json").write_text('{"name": "torn", "path": "/x/torn.ply", "error": "it is open"}')
    return folder


def matrix_in(text: str) -> tuple[list[str], np.ndarray]:
    header, *rows = csv.reader(io.StringIO(text))
    assert [row[0] for row in rows] == header[1:]
    return header[1:], np.array([[float(cell) for cell in row[1:]] for row in rows])


@pytest.mark.slow
def test_results_of_a_folder(run: Run, results: Path) -> None:
    answer = run("compare", "results", "--picture", "tree.png", "--with-size")
    assert answer.status == 1
    assert answer.err == "idviewer: results/torn.json: it is open; left out\n"
    names, found = matrix_in(answer.out)
    assert names == ["large", "oblong", "square"]
    described = [
        shape_descriptors(InteriorDistance(rectangle(*OUTLINES[name]), Euclidean())) for name in names
    ]
    assert np.allclose(found, sum(descriptor_differences(described, with_size=True).values()))
    assert found[0, 2] == pytest.approx(np.log(25.0))
    with Image.open("tree.png") as picture:
        pixels = np.asarray(picture.convert("L"))
    assert np.mean(pixels < 128) > 1e-3


@pytest.mark.slow
def test_one_part_and_all(run: Run, results: Path) -> None:
    files = [f"results/{name}.json" for name in ("square", "oblong")]
    told = json.loads(run("compare", *files, "--json").out)
    assert told["names"] == ["square", "oblong"]
    parts = [np.array(told["differences"][part]) for part in ("eigenvalues", "distances", "potential")]
    assert np.allclose(sum(parts), told["differences"]["all"])
    assert {part: len(errors) for part, errors in told["sampling_errors"].items()} == {
        "distances": 2,
        "potential": 2,
    }
    answer = run("compare", *files, "--by", "distances", "--matrix", "out.csv")
    assert (answer.status, answer.out) == (0, "")
    assert np.allclose(matrix_in(Path("out.csv").read_text())[1], parts[1])


@pytest.mark.slow
def test_shapes_are_described_first(run: Run, tmp_path: Path) -> None:
    """An L and the same, larger and turned, do not differ."""
    corners = np.array([[0.0, 0.0], [3, 0], [3, 1], [1, 1], [1, 2], [0, 2]])
    for name, points in (("here", corners), ("there", 7.0 * corners @ [[0.6, 0.8], [-0.8, 0.6]])):
        (tmp_path / f"{name}.csv").write_text("\n".join(f"{x!r},{y!r}" for x, y in points.tolist()))
    answer = run("compare", "here.csv", "there.csv", "none.csv", "--distance", "euclidean", "--jobs", "1")
    assert answer.status == 1
    assert answer.err == f"idviewer: {tmp_path / 'none.csv'}: No such file or directory; left out\n"
    names, found = matrix_in(answer.out)
    assert names == ["here", "there"]
    assert np.abs(found).max() < 1e-9


def test_groups_are_those_of_the_mean_difference() -> None:
    """Worked by hand: 0 and 1 at 2, then 2 with both at (6 + 10) / 2."""
    found = groups_of(np.array([[0.0, 2.0, 6.0], [2.0, 0.0, 10.0], [6.0, 10.0, 0.0]]))
    assert found[:, 2:].tolist() == [[2.0, 2.0], [8.0, 3.0]]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((), "not 0"),
        (("results/square.json",), "not 1"),
        (("results/square.json", "results/torn.json"), "results/torn.json: it is open"),
        (("results", "--picture", "tree.jpg"), "ends in .png"),
        (("results", "--matrix", "out.txt"), "ends in .csv"),
        (("results", "solid.json"), "large is a polygon and solid a mesh"),
        (("results", "bare.json"), "bare.json: it has no descriptors"),
        (("results/square.json", "half.json"), "half.json: not a whole result"),
        (("results", "other.json"), "other with distance=gps"),
        (("results", "--distance", "gps"), "compared as they are"),
    ],
)
def test_what_cannot_be_compared(
    run: Run, results: Path, tmp_path: Path, arguments: tuple[str, ...], complaint: str
) -> None:
    stored = json.loads((results / "square.json").read_text())
    described = stored["result"]["descriptors"]
    write = {
        "solid": {**stored, "name": "solid", "result": {"descriptors": {**described, "dimension": 3}}},
        "bare": {**stored, "name": "bare", "result": {}},
        "half": {"name": "half", "key": "x"},
        "other": {**stored, "name": "other", "options": {"distance": {"distance": "gps"}}},
    }
    for name, content in write.items():
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    answer = run("compare", *arguments)
    if "bare.json" in arguments:  # the others can be
        assert (answer.status, complaint in answer.err) == (1, True)
    else:
        assert complaint in answer.err
        assert answer.status == 2


@pytest.mark.slow
def test_same_names_are_told_apart(run: Run, results: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.json"
    copy.write_text((results / "square.json").read_text())
    names, found = matrix_in(run("compare", "results/square.json", "copy.json").out)
    assert names == ["square (results/square.json)", "square (copy.json)"]
    assert not found.any()
