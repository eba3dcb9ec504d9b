"""Files of numbers: every kind gives the same array, and every fault has a line of its own."""

from __future__ import annotations

import io
import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse

from idviewer.core.io.array_files import read_array, split_name
from idviewer.core.io.text import UnreadableError

VALUES = np.array([[0.0, 1.5, -2.25], [1.5, 1e-9, 3.0], [7.0, 8.0, 1e12], [4.0, 5.0, 6.5]])


def read(path: Path | str, rows: int | None = None) -> np.ndarray:
    return read_array(str(path), lambda size: None, lambda count: rows is not None and count == rows)


def as_text(mark: str, decimal: str = ".", heading: str = "", index: bool = False) -> str:
    rows = [mark.join(f"{value:.17g}".replace(".", decimal) for value in row) for row in VALUES]
    if index:
        rows = [f"{number}{mark}{row}" for number, row in enumerate(rows)]
    return heading + "\n".join(rows) + "\n"


TEXTS = {
    "commas": as_text(","),
    "commas and blanks": as_text(", "),
    "blanks": as_text(" "),
    "tabs": as_text("\t"),
    "semicolons": as_text(";"),
    "semicolons and decimal commas": as_text(";", ","),
    "tabs and decimal commas": as_text("\t", ","),
    "blanks and decimal commas": as_text(" ", ","),
    "a heading": as_text(",", heading="a,b,c\n"),
    "a remark": as_text(" ", heading="# made by hand\n"),
    "another remark": as_text(" ", heading="% made by hand\n"),
    "numbered rows": as_text(",", heading="id,a,b,c\n", index=True),
    "pandas": as_text(",", heading=",0,1,2\n", index=True),
    "pandas without index": as_text(",", heading="0,1,2\n"),
    "quoted": as_text(",", heading='"a","b","c"\n'),
    "windows": as_text(";", ",", heading="sep=;\r\n").replace("\n", "\r\n"),
    "old mac": as_text(",").replace("\n", "\r"),
}


@pytest.mark.parametrize("kind", TEXTS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be"])
def test_texts_of_every_style_give_the_same_numbers(kind, encoding, tmp_path):
    path = tmp_path / "numbers.csv"
    path.write_bytes(TEXTS[kind].encode(encoding))
    np.testing.assert_array_equal(read(path, rows=4), VALUES)


def test_what_numpy_and_scipy_write_is_read_back(tmp_path):
    np.save(tmp_path / "a.npy", VALUES)
    np.save(tmp_path / "fortran.npy", np.asfortranarray(VALUES))
    np.savez(tmp_path / "one.npz", whatever=VALUES)
    np.savez_compressed(tmp_path / "two.npz", first=VALUES + 1, second=VALUES)
    np.savetxt(tmp_path / "a.txt", VALUES)
    np.savetxt(tmp_path / "a.csv", VALUES, delimiter=",", header="x,y,z")
    scipy.io.mmwrite(tmp_path / "dense.mtx", VALUES)
    scipy.io.mmwrite(tmp_path / "sparse.mtx", scipy.sparse.coo_array(VALUES))
    (tmp_path / "numbers").write_bytes((tmp_path / "a.npy").read_bytes())
    names = ["a.npy", "fortran.npy", "one.npz", "one.npz:whatever", "two.npz:second", "a.txt", "a.csv"]
    for name in [*names, "dense.mtx", "sparse.mtx", "numbers"]:
        np.testing.assert_allclose(read(tmp_path / name), VALUES, rtol=1e-15)
    symmetric = VALUES[:3] + VALUES[:3].T
    scipy.io.mmwrite(tmp_path / "symmetric.mtx", symmetric, symmetry="symmetric")
    np.testing.assert_allclose(read(tmp_path / "symmetric.mtx"), symmetric, rtol=1e-15)


def test_an_array_of_a_wrong_shape_is_refused_before_it_is_read(tmp_path):
    def refuse(size):
        raise LookupError(size)

    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": "<f8", "fortran_order": False, "shape": (10**7, 10**7)}
    )
    (tmp_path / "huge.npy").write_bytes(header.getvalue())
    with zipfile.ZipFile(tmp_path / "huge.npz", "w") as archive:
        archive.writestr("a.npy", header.getvalue())
    (tmp_path / "huge.mtx").write_text("%%MatrixMarket matrix coordinate real general\n10000000 10000000 0\n")
    for name in ("huge.npy", "huge.npz", "huge.mtx"):
        with pytest.raises(LookupError, match="10000000, 10000000"):
            read_array(str(tmp_path / name), refuse, lambda count: False)


class Runs:
    def __reduce__(self):
        return (open, ("never", "w"))


def test_pickles_are_named_and_never_opened(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for protocol in range(6):
        (tmp_path / "a.npy").write_bytes(pickle.dumps(Runs(), protocol))
        (tmp_path / "a.pkl").write_bytes(pickle.dumps(Runs(), protocol))
        for name in ("a.npy", "a.pkl"):
            with pytest.raises(
                UnreadableError, match=r"^a pickle, which can run any program and is not opened"
            ):
                read(tmp_path / name)
    np.save(tmp_path / "objects.npy", np.array([Runs()], dtype=object), allow_pickle=True)
    np.savez(tmp_path / "objects.npz", a=np.array([Runs()], dtype=object))
    for name in ("objects.npy", "objects.npz"):
        with pytest.raises(UnreadableError, match="pickled Python objects"):
            read(tmp_path / name)
    with zipfile.ZipFile(tmp_path / "model.zip", "w") as archive:
        archive.writestr("archive/data.pkl", pickle.dumps(Runs()))
    with pytest.raises(UnreadableError, match="it holds a pickle"):
        read(tmp_path / "model.zip")
    assert not (tmp_path / "never").exists()


FAULTS = {
    "cut.npy": "not a whole .npy file",
    "cut.npz": "not a whole .npz file",
    "flipped.npz:first": "not a whole .npy file (Bad CRC-32",
    "two.npz": "it holds 2 arrays: first, second; name one behind a colon, as two.npz:first",
    "two.npz:third": "no array named 'third'; there are: first, second",
    "a.csv:first": "it is no archive of arrays",
    "none.npz": "it holds no array",
    "blank.csv": "the file is empty",
    "remarks.csv": "it holds no numbers",
    "ragged.csv": "line 2: '4,5' has 2 columns, and line 1 has 3",
    "words.csv": "line 3: 'seven' is not a number",
    "hole.csv": "line 2: '' is not a number",
    "signs.csv": "line 2: '2.5' has a point where other numbers have a decimal comma",
    "counted.csv": "its first column counts the rows",
    "binary.csv": "binary data",
    "cut.mtx": "not a whole MatrixMarket file",
    "pattern.mtx": "not their values",
    "some.mtx": "it lists 2 of the 6 entries off the diagonal",
    "a.gz": "save it as one of these",
}


@pytest.mark.parametrize("name", FAULTS)
def test_every_fault_has_a_line(name, tmp_path):
    np.save(tmp_path / "whole.npy", VALUES)
    np.savez(tmp_path / "two.npz", first=VALUES, second=VALUES)
    whole, two = (tmp_path / "whole.npy").read_bytes(), (tmp_path / "two.npz").read_bytes()
    flipped = bytearray(two)
    flipped[200] ^= 0xFF
    contents = {
        "cut.npy": whole[:-20],
        "cut.npz": two[:-60],
        "flipped.npz": bytes(flipped),
        "none.npz": b"PK\x05\x06" + bytes(18),
        "a.csv": b"1,2\n",
        "blank.csv": b" \n",
        "remarks.csv": b"# a\n# b\n",
        "ragged.csv": b"1,2,3\n4,5\n6,7,8\n",
        "words.csv": b"1,2\n3,4\n5,seven\n",
        "hole.csv": b"1,2\n,4\n5,6\n",
        "signs.csv": b"1,5;2\n1;2.5\n",
        "counted.csv": b"0,5,6\n1,7,8\n2,9,9\n3,1,1\n",
        "binary.csv": b"1,2\n\x00\x01\x00\x00\x07",
        "cut.mtx": b"%%MatrixMarket matrix array real general\n2 2\n1\n2\n",
        "pattern.mtx": b"%%MatrixMarket matrix coordinate pattern general\n2 2 1\n1 2\n",
        "some.mtx": b"%%MatrixMarket matrix coordinate real symmetric\n3 3 1\n2 1 4\n",
        "a.gz": b"\x1f\x8b\x08\x00",
    }
    for file, data in contents.items():
        (tmp_path / file).write_bytes(data)
    if name == "none.npz":
        with zipfile.ZipFile(tmp_path / name, "w") as archive:
            archive.writestr("readme.txt", "nothing")
    with pytest.raises(UnreadableError) as error:
        read(tmp_path / name)
    assert FAULTS[name] in str(error.value)
    assert "\n" not in str(error.value)


def test_the_name_of_an_array_is_told_from_a_drive_and_from_a_file_with_a_colon(tmp_path):
    assert split_name("C:/data/d.npy") == ("C:/data/d.npy", None)
    assert split_name("C:/data/d.npz:d") == ("C:/data/d.npz", "d")
    odd = tmp_path / "a.b:c"
    odd.touch()
    assert split_name(str(odd)) == (str(odd), None)
