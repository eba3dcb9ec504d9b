"""Meshes as real programs write them: what is unmistakable is read, and what was passed over told."""

from __future__ import annotations

import re
import struct

import pytest
from tests.core import meshfiles, shapes
from tests.core.meshfiles import refusal, write

from idviewer.core import read_mesh
from idviewer.core.io.written_numbers import numbers

BODY = shapes.l_shape()
OFF, OBJ, PLY = (writer(*BODY).decode() for writer in (meshfiles.off, meshfiles.obj, meshfiles.ply))
TEXT, BINARY = meshfiles.stl_text(*BODY).decode(), meshfiles.stl(*BODY)
POINTS, FACES = len(BODY[0]), len(BODY[1])
ROWS = OFF.splitlines()[2:]
VERTICES, TRIANGLES = ROWS[:POINTS], ROWS[POINTS:]


def off(keyword: str, vertices: list[str], triangles: list[str], counts: str = f"{POINTS} {FACES} 0") -> str:
    return "\n".join([keyword, counts, *vertices, *triangles]) + "\n"


def commas(text: str) -> str:
    return text.replace(".", ",")


def ends(rows: list[str], end: str) -> list[str]:
    return [f"{row} {end}" for row in rows]


def ply(extra: str, property_of_vertices: str) -> str:
    """With one more property behind z."""
    head, _, body = PLY.partition("end_header\n")
    head = head.replace("double z\n", f"double z\nproperty {property_of_vertices}\n")
    rows = body.splitlines()
    return head + "end_header\n" + "\n".join(ends(rows[:POINTS], extra) + rows[POINTS:]) + "\n"


FINE: dict[str, tuple[str, str | bytes, str]] = {
    "lower case": (".off", OFF.replace("OFF", "off"), ""),
    "no keyword": (".off", OFF.replace("OFF\n", ""), "keyword OFF is missing"),
    "counts on lines": (".off", OFF.replace(f"{POINTS} {FACES} 0", f"{POINTS}\n{FACES}\n0"), ""),
    "two counts on lines": (".off", OFF.replace(f"{POINTS} {FACES} 0", f"{POINTS}\n{FACES}"), ""),
    "all on one line": (".off", OFF.replace("\n", " "), ""),
    "numbers in free layout": (".off", off("OFF", [" ".join(VERTICES)], [" ".join(TRIANGLES)]), ""),
    "one number a line": (".off", OFF.replace(" ", "\n"), ""),
    "a tab between": (".off", OFF.replace(" ", "\t").replace("\n", "\r\n"), ""),
    "normals and colours": (".off", off("NCOFF", ends(VERTICES, "0 0 1 9 9 9 255"), TRIANGLES), ""),
    "the same in free layout": (
        ".off",
        off("NCOFF", [" ".join(ends(VERTICES, "0 0 1 9 9 9 255"))], TRIANGLES),
        "",
    ),
    "texture": (".off", off("STOFF", ends(VERTICES, "0.5 0.5"), TRIANGLES), ""),
    "colours of faces": (".off", off("OFF", VERTICES, ends(TRIANGLES, "1 0 0 0.5")), ""),
    "colours without a keyword": (".off", off("OFF", ends(VERTICES, "9 9 9"), TRIANGLES), ""),
    "edges after the faces": (".off", OFF + "\n# edges\n0 1\n1 2\n", "beginning with '0 1'"),
    "a remark at the end": (".off", OFF + "\n\n# made by hand", ""),
    "words at the end": (".off", OFF + "the end\n", "beginning with 'the end'"),
    "Fortran": (".off", off("OFF", [row.replace(".0", ".0D+00") for row in VERTICES], TRIANGLES), "with a D"),
    "commas in OFF": (".off", off("OFF", [commas(row) for row in VERTICES], TRIANGLES), "decimal commas"),
    "commas in OBJ": (".obj", commas(OBJ), "decimal commas"),
    "an old word for faces": (".obj", OBJ.replace("f ", "fo "), ""),
    "blanks behind the backslash": (".obj", OBJ.replace("f ", "f \\ \t\n"), ""),
    "backslashes and returns": (".obj", OBJ.replace("f ", "f \\\r\n").replace("v ", "v \\\r"), ""),
    "weights": (".obj", "\n".join(r + " 2" if r[0] == "v" else r for r in OBJ.splitlines()), "The weights"),
    "lines, curves and calls": (".obj", OBJ + "l 1 2\np 1\ncall /etc/passwd\ncsh ls\n", "l, p, call, csh."),
    "normals that are none": (".obj", "vn nan nan nan\n" + OBJ.replace("f ", "s off\nf "), ""),
    "an unknown line": (
        ".ply",
        PLY.replace("comment", "created_by scanner\ncomment"),
        "'created_by scanner'",
    ),
    "capitals": (".ply", re.sub("double ([xyz])", lambda found: found[0][:-1] + found[1].upper(), PLY), ""),
    "NaN by an old Windows": (".ply", ply("-1.#IND", "float quality"), "'-1.#IND'"),
    "NaN by Windows": (".ply", ply("-nan(ind)", "float quality"), "'-nan(ind)'"),
    "NaN": (".ply", ply("nan", "float quality"), ""),
    "a list before": (".ply", ply("2 7 8", "list uchar int tags"), ""),
    "commas in PLY": (
        ".ply",
        PLY.partition("end_header")[0] + "end_header" + commas(PLY.partition("end_header")[2]),
        "decimal commas",
    ),
    "a line of text behind": (".ply", PLY + "made by hand\n", "follows its last element"),
    "remarks among the data": (
        ".ply",
        PLY.replace("\n3 ", "\ncomment faces\n3 ", 1),
        "Remarks among its data",
    ),
    "Windows and a mark": (".ply", "\ufeff" + PLY.replace("\n", "\r\n"), ""),
    "bytes behind": (".ply", meshfiles.ply_binary(*BODY) + b"\0\0\0\0", "follows its last element"),
    "bytes behind the other order": (".ply", meshfiles.ply_binary(*BODY, order=">") + b"more", "follows its"),
    "two bytes behind": (".stl", BINARY + b"\r\n", "2 bytes after its last facet"),
    "colours in the header": (".stl", b"COLOR=\1\2\3\4,MATERIAL=".ljust(80) + BINARY[80:], ""),
    "two files in one": (".stl", b"", "2 binary STL files"),
    "count 0": (".stl", BINARY[:80] + bytes(4) + BINARY[84:], "by the file's length they are"),
    "count -1": (".stl", BINARY[:80] + b"\xff\xff\xff\xff" + BINARY[84:], "by the file's length they are"),
    "no endsolid": (".stl", TEXT.partition("endsolid")[0], "ends without endsolid"),
    "end solid": (".stl", TEXT.replace("endsolid", "end solid"), ""),
    "one line": (".stl", TEXT.replace("solid facet of a test", "solid part").replace("\n", " "), ""),
    "two solids in one line": (".stl", "", ""),
    "a remark before": (".stl", "; exported\n\n" + TEXT, "before its first solid"),
    "colours of facets": (
        ".stl",
        TEXT.replace("  facet", "  color 0.5 0. 1e-3\n  facet"),
        "beside their vertices",
    ),
    "no normals": (".stl", TEXT.replace(" normal 0 0 0", ""), "beside their vertices"),
    "normals that are no numbers": (".stl", TEXT.replace("normal 0 0 0", "normal -nan(ind) nan 1.#QNAN"), ""),
    "commas in STL": (".stl", commas(TEXT), "decimal commas"),
    "capitals in STL": (".stl", TEXT.upper(), ""),
}
_HALVES = [TEXT.replace("\n", " ").partition("endsolid")[0].replace("facet of a test", "x"), "endsolid x "]
_MIDDLE = len(_HALVES[0].split("endfacet")) // 2
_ONE, _TWO = (
    "endfacet".join(part)
    for part in (_HALVES[0].split("endfacet")[:_MIDDLE], _HALVES[0].split("endfacet")[_MIDDLE:])
)
FINE["two solids in one line"] = (".stl", f"{_ONE}endfacet endsolid x solid y{_TWO}endsolid y", "")
_HALF = 84 + 50 * (FACES // 2)
FINE["two files in one"] = (
    ".stl",
    BINARY[:80]
    + struct.pack("<I", FACES // 2)
    + BINARY[84:_HALF]
    + b"second".ljust(80)
    + struct.pack("<I", FACES - FACES // 2)
    + BINARY[_HALF:],
    "2 binary STL files",
)
TEXTS = [name for name, (_, data, _) in FINE.items() if isinstance(data, str)]


def check(folder, suffix: str, data: bytes, note: str) -> None:
    mesh = read_mesh(write(folder, suffix, data))
    assert (len(mesh.vertices), len(mesh.faces)) == (POINTS, FACES)
    assert mesh.volume == pytest.approx(3.0, rel=1e-12)
    notes = [one for one in mesh.notes if "duplicated" not in one]
    assert len(notes) == bool(note)
    assert note in " ".join(notes)


@pytest.mark.parametrize("name", FINE)
def test_what_is_unmistakable_is_read_and_what_was_passed_over_is_told(tmp_path, name):
    suffix, data, note = FINE[name]
    check(tmp_path, suffix, data.encode() if isinstance(data, str) else data, note)


@pytest.mark.one_is_quick
@pytest.mark.parametrize("name", TEXTS)
def test_texts_in_other_encodings_and_with_other_line_ends(tmp_path, name):
    suffix, text, note = FINE[name]
    for coding in ("utf-16", "utf-16-le", "utf-16-be", "utf-8-sig", "utf-32"):
        check(tmp_path, suffix, text.removeprefix("\ufeff").encode(coding), note)
    check(tmp_path, suffix, "\r\n".join(text.splitlines()).encode() + b"\r\n", note)


CUT: dict[str, tuple[str, str | bytes, str]] = {
    "half a letter": (".off", ("\ufeff" + OFF).encode("utf-16-le")[:-1], "no whole UTF-16"),
    "a coordinate less": (".off", OFF.replace(VERTICES[3], VERTICES[3][:-4]), "fewer than three coordinates"),
    "a face less": (
        ".off",
        "\n".join(OFF.splitlines()[:-1]),
        f"announces {FACES} faces and holds {FACES - 1}",
    ),
    "a face more": (".off", OFF + "3 0 1 2\n", f"announces {FACES} faces and holds more"),
    "free layout, cut": (".off", off("OFF", [" ".join(VERTICES)], [" ".join(TRIANGLES)])[:-3], "truncated"),
    "four dimensions": (".off", off("4OFF", ends(VERTICES, "1"), TRIANGLES), "three dimensions"),
    "one comma among points": (".obj", OBJ.replace("0.0", "0,0", 1), "'0,0' has a comma and '2.0' has none"),
    "thousands or commas": (
        ".obj",
        OBJ.replace("0.0", "1,000").replace("1.0", "2,000").replace("2.0", "3,000"),
        "a thousand",
    ),
    "NaN in a coordinate": (".obj", OBJ.replace("v 0.0", "v -nan(ind)", 1), "not finite numbers"),
    "NaN in a coordinate of PLY": (".ply", PLY.replace("\n0.0", "\n-1.#IND", 1), "not finite numbers"),
    "infinity for a corner": (
        ".ply",
        PLY[:-2].rstrip("0123456789") + "inf\n",
        "a corner that is no whole number",
    ),
    "a facet cut": (".stl", TEXT[: TEXT.rindex("endloop")], "truncated, or a facet is not"),
    "a facet cut before the next": (
        ".stl",
        TEXT.replace("    endloop\n  endfacet\n", "", 1),
        "a facet is not",
    ),
    "a binary facet cut": (".stl", BINARY[:-1], "truncated"),
    "count -1, cut": (".stl", BINARY[:80] + b"\xff\xff\xff\xff" + BINARY[84:-1], "nor does its length"),
    "only a beginning": (".stl", "solid thing\nendsolid thing\n", "no facet follows"),
}


@pytest.mark.parametrize("name", CUT)
def test_what_is_cut_or_means_two_things_is_refused(tmp_path, name):
    suffix, data, message = CUT[name]
    assert message in refusal(write(tmp_path, suffix, data.encode() if isinstance(data, str) else data))


OBJECTS = "".join(f"v {x + 5 * n} {y} {z}\n" for n in (0, 1) for x, y, z in shapes.tetrahedron()[0].tolist())
for _number, _name in enumerate(("left arm", "right")):
    OBJECTS += f"o {_name}\n" + "".join(
        "f " + " ".join(str(corner + 1 + 4 * _number) for corner in face) + "\n"
        for face in shapes.tetrahedron()[1].tolist()
    )


@pytest.mark.parametrize("keyword", ["o", "g"])
def test_objects_are_one_mesh_unless_one_is_chosen(tmp_path, keyword):
    path = write(tmp_path, ".obj", OBJECTS.replace("o ", f"{keyword} ").encode())
    assert "2 components with 4, 4 faces" in refusal(path)
    assert refusal(path).endswith("or one of its parts by name, part='left arm'")
    for part, left in (("left arm", 0.0), ("right", 5.0), ("2", 5.0)):
        mesh = read_mesh(path, part=part)
        assert (mesh.bounds[0, 0], mesh.volume) == (left, pytest.approx(1 / 6))
    assert "no 'legs' among its objects; there are 'left arm' (4 faces), 'right' (4 faces)" in refusal(
        path, part="legs"
    )


def test_numbers_are_read_to_the_last_digit_however_they_are_written():
    expected = [0.5, 1.25, 1e-3]
    for written in (b"0.5 1.25 1.0e-3", b"0,5 1,25 1,0e-3", b"0.5D0 1.25d+00 1D-3", b"+,5 1,25E0 0,001"):
        assert numbers(written.split())[0].tolist() == expected
