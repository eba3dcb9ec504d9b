"""Result files: what is kept, what is done again, and what is left of a failure."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from tests.batch.works import calls_of, task_in, work

import idviewer
from idviewer.batch.carrying_out import carry_out
from idviewer.batch.result_files import content_key, remove_parts
from idviewer.batch.task import Outcome, Task


def carried(task: Task) -> Outcome:
    return carry_out(work, task, task.path.parent, lambda amount: None)


@pytest.fixture
def task(tmp_path: Path) -> Task:
    made = task_in(tmp_path, "cup", "content", colour="red")
    assert carried(made).status == "computed"
    return made


class TestKeeping:
    def test_the_same_is_kept(self, task: Task) -> None:
        again = carried(task)
        assert (again.status, again.content["result"]["size"]) == ("kept", 7)
        assert calls_of(task) == 1

    def test_another_file_of_the_same_name_is_not(self, task: Task) -> None:
        task.path.write_text("CONTENT")
        assert carried(task).status == "computed"

    def test_other_options_are_not(self, task: Task) -> None:
        assert carried(replace(task, options={"colour": "blue"})).status == "computed"

    def test_another_version_is_not(self, task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(idviewer, "__version__", "0.0.0")
        assert carried(task).status == "computed"

    def test_other_labels_are(self, task: Task) -> None:
        assert carried(replace(task, labels={"class": "cups"})).status == "kept"

    def test_another_input_is_not(self, task: Task, tmp_path: Path) -> None:
        points = tmp_path / "points.csv"
        points.write_text("1,2,3")
        with_points = replace(task, inputs=(points,))
        assert [carried(with_points).status for _ in range(2)] == ["computed", "kept"]
        points.write_text("1,2,4")
        assert carried(with_points).status == "computed"

    @pytest.mark.parametrize("size", [0, 1, 100])
    def test_half_a_result_file_is_not(self, task: Task, tmp_path: Path, size: int) -> None:
        path = tmp_path / "cup.json"
        path.write_bytes(path.read_bytes()[:size])
        assert carried(task).status == "computed"

    def test_a_result_without_its_other_file_is_not(self, task: Task, tmp_path: Path) -> None:
        (tmp_path / "cup.copy").unlink()
        assert carried(task).status == "computed"

    def test_half_of_the_other_file_is_not(self, task: Task, tmp_path: Path) -> None:
        (tmp_path / "cup.copy").write_text("cont")
        assert carried(task).status == "computed"

    def test_an_edited_number_is_not(self, task: Task, tmp_path: Path) -> None:
        path = tmp_path / "cup.json"
        path.write_text(path.read_text().replace('"size": 7', '"size": 8'))
        assert carried(task).status == "computed"

    @pytest.mark.parametrize("text", ["[]", "null", '{"key": 1}', '{"files": {"copy": 3}}'])
    def test_anything_else_is_not(self, task: Task, tmp_path: Path, text: str) -> None:
        (tmp_path / "cup.json").write_text(text)
        assert carried(task).status == "computed"


def test_the_digest_tells_results_apart_and_nothing_else(task: Task, tmp_path: Path) -> None:
    path = tmp_path / "cup.json"
    first = json.loads(path.read_text())
    path.unlink()
    carried(task)
    second = json.loads(path.read_text())
    assert first["digest"] == second["digest"]
    task.path.write_text("longer content")
    assert carried(task).content["digest"] != first["digest"]


def test_a_failure_leaves_nothing_of_what_was_there(task: Task, tmp_path: Path) -> None:
    assert carried(replace(task, options={"fails": True})).reason == "cup: no shape"
    stored = json.loads((tmp_path / "cup.json").read_text())
    assert (stored["error"], "result" in stored) == ("cup: no shape", False)
    assert not (tmp_path / "cup.copy").exists()


def test_a_failure_deletes_nothing_that_is_not_its_own(task: Task, tmp_path: Path) -> None:
    """The result file may be anybody's: names in it count for nothing outside the folder."""
    (tmp_path / "other").write_text("")
    outside = tmp_path.parent / "cup.precious"
    outside.write_text("")
    files = {"a": {"name": "../cup.precious"}, "b": {"name": "other"}, "c": "cup.txt"}
    (tmp_path / "cup.json").write_text(json.dumps({"files": files}))
    carried(replace(task, options={"fails": True}))
    assert outside.exists()
    assert (tmp_path / "other").exists()
    assert task.path.exists()


def test_files_beside_a_scene_count(tmp_path: Path) -> None:
    scene, buffer = tmp_path / "a.gltf", tmp_path / "a b.bin"
    scene.write_text('{"buffers": [{"uri": "a%20b.bin"}, {"uri": "data:,x"}, {"uri": "none.bin"}]}')
    buffer.write_text("1")
    task = Task("a", scene)
    before = content_key(task)
    buffer.write_text("2")
    assert content_key(task) != before


def test_parts_of_one_task_are_removed(tmp_path: Path) -> None:
    for name in (".cup.json.12.part", ".cup.png.12.part", ".cups.json.12.part", "cup.part"):
        (tmp_path / name).touch()
    remove_parts(tmp_path, "cup")
    remove_parts(tmp_path)  # those of others are new
    assert sorted(path.name for path in tmp_path.iterdir()) == [".cups.json.12.part", "cup.part"]
