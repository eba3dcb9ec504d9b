"""Shapes of a collection: files, folders, patterns, manifests, names and shares."""

from __future__ import annotations

from pathlib import Path

import pytest

from idviewer.batch.inputs import Entry, entries_of, shard_of, share_of, with_names
from idviewer.batch.manifest import read_manifest

OPTIONS = ("component", "part", "time", "set", "landmarks")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of shapes, with other things among them, to be named from within."""
    for name in ("a.ply", "b.OFF", "notes.txt", "table.csv", "sub/a.ply", ".hidden/c.ply", "out/d.vtp.ply"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def unknown(name: str) -> Path:
    raise FileNotFoundError(name)


def listed(*texts: str) -> list[str]:
    entries = entries_of(texts, unknown, Path("out"))
    return [entry.path.relative_to(Path.cwd()).as_posix() for entry in entries]


class TestFiles:
    def test_a_folder_is_searched_for_shapes(self, folder: Path) -> None:
        assert listed(".") == ["a.ply", "b.OFF", "sub/a.ply"]

    def test_patterns(self, folder: Path) -> None:
        assert listed("**/a.*", "t*.csv") == ["a.ply", "sub/a.ply", "table.csv"]

    def test_what_is_not_there_is_an_entry(self, folder: Path) -> None:
        """Its row will tell; the others are computed."""
        assert listed("missing.ply", "a.ply") == ["missing.ply", "a.ply"]

    def test_a_name_is_resolved(self, folder: Path) -> None:
        entry = entries_of(["hand"], lambda name: folder / "a.ply", Path("out"))[0]
        assert entry.path == folder / "a.ply"

    @pytest.mark.parametrize("text", ["*.stl", "empty"])
    def test_nothing_is_refused(self, folder: Path, text: str) -> None:
        (folder / "empty").mkdir()
        with pytest.raises(ValueError, match=text.replace("*", r"\*")):
            listed(text)


class TestNames:
    def test_the_same_file_name_in_two_folders(self, folder: Path) -> None:
        names = [entry.name for entry in with_names(entries_of(["."], unknown, Path("out")))]
        assert len(set(names)) == 3
        assert [name.partition("-")[0] for name in names] == ["a", "b", "a"]
        assert names == [entry.name for entry in with_names(entries_of(["."], unknown, Path("out")))]

    def test_what_is_listed_twice_is_one(self, folder: Path) -> None:
        assert len(with_names(entries_of(["a.ply", "*.ply"], unknown, Path("out")))) == 1

    def test_capitals_are_no_difference(self) -> None:
        names = [entry.name for entry in with_names([Entry(Path("/x/A.ply")), Entry(Path("/y/a.ply"))])]
        assert len({name.lower() for name in names}) == 2

    def test_two_suffixes_and_odd_letters(self) -> None:
        entries = [Entry(Path("/x/brain.nii.gz")), Entry(Path("/x/a:b?.ply")), Entry(Path("/x/.ply"))]
        assert [entry.name for entry in with_names(entries)] == ["brain", "a_b_", "ply"]

    @pytest.mark.parametrize("name", ["a/b", "..", ".a", "a\\b", " a"])
    def test_a_name_that_leaves_the_folder(self, name: str) -> None:
        with pytest.raises(ValueError, match="cannot be that of a file"):
            with_names([Entry(Path("/x/a.ply"), name, where="list.csv, line 2")])

    def test_the_same_name_twice(self) -> None:
        entries = [Entry(Path(f"/x/{name}.ply"), "same", where=f"line {name}") for name in "ab"]
        with pytest.raises(ValueError, match=r"line b: .* as those of line a, 'same'"):
            with_names(entries)

    def test_two_options_of_one_file(self) -> None:
        entries = [Entry(Path("/x/a.ply"), options=(("component", one),), where=one) for one in "12"]
        with pytest.raises(ValueError, match="column `name`"):
            with_names(entries)


class TestShares:
    def test_each_shape_is_in_one(self) -> None:
        entries = [Entry(Path(f"/x/{name}.ply"), name) for name in "gfedcba"]
        shares = [share_of(entries, number, 3) for number in (1, 2, 3)]
        assert sorted(len(share) for share in shares) == [2, 2, 3]
        assert sorted(entry.name for share in shares for entry in share) == list("abcdefg")

    def test_the_order_of_the_list_does_not_count(self) -> None:
        entries = [Entry(Path(f"/x/{name}.ply"), name) for name in "gfedcba"]
        assert set(share_of(entries, 2, 3)) == set(share_of(entries[::-1], 2, 3))

    @pytest.mark.parametrize("text", ["0/3", "4/3", "3", "1/0", "a/b", "-1/3", ""])
    def test_no_share(self, text: str) -> None:
        with pytest.raises(ValueError, match="--shard"):
            shard_of(text)


class TestManifest:
    def test_columns(self, tmp_path: Path) -> None:
        path = tmp_path / "list.csv"
        path.write_text('\ufeffName;Path;time;"Class, said by";set\nx;a.ply;;cup;a=1\n\n;/y/b.off;0.5;;\n')
        first, second = read_manifest(path, OPTIONS)
        assert (first.path, first.name, first.options) == (tmp_path / "a.ply", "x", (("set", "a=1"),))
        assert first.labels == {"Class, said by": "cup"}
        assert (second.path, second.name, second.options) == (Path("/y/b.off"), "", (("time", "0.5"),))
        assert second.where == f"{path}, line 4"

    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("", "no column is called `path`"),
            ("a.ply\nb.ply\n", "no column is called `path`"),
            ("path\n", "lists no shapes"),
            ("path,componet\na.ply,1\n", "'componet'; is 'component' meant"),
            ("path,time,time\na.ply,1,2\n", "two columns"),
            ("path,name\n,x\n", "line 2: it names no file"),
            ("path,name\na,b,c\n", "line 2: 3 cells under 2 columns"),
        ],
    )
    def test_what_is_unclear_is_refused(self, tmp_path: Path, text: str, complaint: str) -> None:
        path = tmp_path / "list.csv"
        path.write_text(text)
        with pytest.raises(ValueError, match=complaint):
            read_manifest(path, OPTIONS)

    def test_another_encoding(self, tmp_path: Path) -> None:
        path = tmp_path / "list.csv"
        path.write_bytes("path\nä.ply\n".encode("latin-1"))
        with pytest.raises(ValueError, match="UTF-8"):
            read_manifest(path, OPTIONS)
