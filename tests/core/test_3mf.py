"""3MF packages: items, components and transforms against products of matrices; bombs; refusals."""

from __future__ import annotations

import io
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from tests.core import meshfiles, shapes
from tests.core.meshfiles import refusal, write

from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.meshes import read_mesh
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.threemf import read_3mf

BODY = shapes.l_shape()
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PRODUCTION = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
RELATIONS = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Id="a" '
    'Target="/3D/parts/Body.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
    "</Relationships>"
)


def mesh_of(arrays=BODY) -> str:
    points = "".join(f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in arrays[0].tolist())
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}" p1="0"/>' for a, b, c in arrays[1].tolist())
    return f"<mesh><vertices>{points}</vertices><triangles>{faces}</triangles></mesh>"


def made_of(identity: int, content: str, **more: str) -> str:
    given = "".join(f' {key}="{value}"' for key, value in more.items())
    return f'<object id="{identity}"{given}>{content}</object>'


def model(objects: str, build: str, head: str = 'unit="inch"', before: str = "") -> str:
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>{before}<model xmlns="{CORE}" xmlns:p="{PRODUCTION}" {head}>'
        f"<metadata name='x'>y</metadata><resources>{objects}</resources><build>{build}</build></model>"
    )


def package(text: str, **files: str) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("_rels/.rels", RELATIONS)
        archive.writestr("3D/parts/body.model", text)
        for name, content in files.items():
            archive.writestr(f"3D/{name}.model", content)
    return stream.getvalue()


def contents(data: bytes, part: str | None = None) -> Contents:
    return read_3mf(FileSource(data, Path("a.3mf"), part))


def words(matrix: np.ndarray) -> str:
    return " ".join(map(repr, np.asarray(matrix)[:, :3].ravel().tolist()))


def matrices(rng, count: int) -> list[np.ndarray]:
    """(4, 4) for points as rows."""
    made = []
    for _ in range(count):
        matrix = np.eye(4)
        matrix[:, :3] += 0.3 * rng.standard_normal((4, 3))
        made.append(matrix)
    return made


SIMPLE = package(model(made_of(1, mesh_of()), '<item objectid="1"/>'))


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("micron", "um"),
        ("millimeter", "mm"),
        ("centimeter", "cm"),
        ("inch", "in"),
        ("foot", "ft"),
        ("meter", "m"),
    ],
)
def test_the_unit_is_the_model_s(tmp_path, name, unit):
    data = package(model(made_of(1, mesh_of()), '<item objectid="1"/>', f'unit="{name}"'))
    mesh = read_mesh(write(tmp_path, ".3mf", data))
    assert (mesh.unit, mesh.volume, mesh.notes) == (unit, pytest.approx(3.0), ())
    assert np.array_equal(mesh.vertices, BODY[0])
    assert contents(package(model(made_of(1, mesh_of()), '<item objectid="1"/>', ""))).unit == "mm"


def test_items_and_components_are_placed_and_mirrors_keep_their_outside(rng):
    outer, inner, deep, other = matrices(rng, 4)
    other[0] *= -1.0
    objects = (
        made_of(1, mesh_of())
        + made_of(2, f'<components><component objectid="1" transform="{words(deep)}"/></components>')
        + made_of(
            3,
            f'<components><component objectid="2" transform="{words(inner)}"/>'
            f'<component objectid="1"/></components>',
        )
    )
    build = f'<item objectid="3" transform="{words(outer)}"/><item objectid="1" transform="{words(other)}"/>'
    soup = contents(package(model(objects, build))).geometry
    count = len(BODY[0])
    rows = np.column_stack([BODY[0], np.ones(count)])
    for number, matrix in enumerate((deep @ inner @ outer, outer, other)):
        there = soup.vertices[number * count : (number + 1) * count]
        assert np.allclose(there, (rows @ matrix)[:, :3], rtol=0, atol=1e-12)
        faces = soup.corners.reshape(3, -1, 3)[number] - number * count
        turned = np.linalg.det(matrix[:3, :3]) < 0
        assert np.array_equal(faces, BODY[1][:, ::-1] if turned else BODY[1])
    assert np.linalg.det(other[:3, :3]) < 0


def test_objects_in_other_model_files(rng):
    (matrix,) = matrices(rng, 1)
    far = model(made_of(7, mesh_of()), "")
    far_off = f'<component p:path="/3D/far.model" objectid="7" transform="{words(matrix)}"/>'
    objects = made_of(2, f"<components>{far_off}</components>")
    head = 'unit="inch" requiredextensions="p"'
    soup = contents(package(model(objects, '<item objectid="2"/>', head), far=far)).geometry
    assert np.allclose(soup.vertices, BODY[0] @ matrix[:3, :3] + matrix[3, :3], rtol=0, atol=1e-12)
    with pytest.raises(UnreadableError, match="several units"):
        contents(package(model(objects, '<item objectid="2"/>', 'unit="foot"'), far=far))
    with pytest.raises(UnreadableError, match=r"its model '/3D/far\.model' is missing"):
        contents(package(model(objects, '<item objectid="2"/>')))


def test_several_items_are_one_mesh_unless_one_is_chosen(tmp_path):
    objects = (
        made_of(1, mesh_of(), name="left") + made_of(2, mesh_of()) + made_of(3, mesh_of(), type="support")
    )
    build = '<item objectid="1"/><item objectid="2" partnumber="P2" transform="1 0 0 0 1 0 0 0 1 9 0 0"/>'
    data = package(model(objects, build + '<item objectid="3"/>'))
    path = write(tmp_path, ".3mf", data)
    assert "2 components with 20, 20 faces" in refusal(path)
    assert refusal(path).endswith("or one of its parts by name, part='left'")
    mesh = read_mesh(path, part="P2")
    assert mesh.bounds[0, 0] == 9.0
    assert mesh.notes == ("1 supports were passed over.",)
    assert "it has no 'x' among its items; there are 'left', 'P2'" in refusal(path, part="x")


def test_without_items_all_objects_that_are_no_components_are_taken():
    objects = made_of(1, mesh_of()) + made_of(2, '<components><component objectid="1"/></components>')
    read = contents(package(model(objects, "")))
    assert len(read.geometry.sizes) == len(BODY[1])
    assert read.notes == ("It has no items to build; all its objects were taken.",)


def test_shapes_that_are_not_read_are_told():
    lattice = '<b:beamlattice xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"/>'
    text = model(made_of(1, mesh_of().replace("</mesh>", f"{lattice}</mesh>")), '<item objectid="1"/>')
    assert contents(package(text)).notes == ("Beam lattices in it were passed over.",)
    head = 'requiredextensions="b" xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"'
    with pytest.raises(UnreadableError, match=r"needs the extension .*beamlattice/2017/02, which is not"):
        contents(package(model(made_of(1, mesh_of()), '<item objectid="1"/>', head)))


ENTITIES = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>'
NESTED = "".join(
    made_of(n, f'<components><component objectid="{n - 1}"/><component objectid="{n - 1}"/></components>')
    for n in range(2, 40)
)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (SIMPLE[:-30], "truncated or damaged"),
        (SIMPLE[:200], "truncated or damaged"),
        (SIMPLE.replace(b"3D/parts", b"3D/party"), "it holds no model"),
        (package(model(made_of(1, mesh_of()), '<item objectid="1"/>')[:-20]), "truncated or damaged: line 1"),
        (package(model(made_of(1, mesh_of()), '<item objectid="1"/>', before=ENTITIES)), "a document type"),
        (package(model(made_of(1, mesh_of()), '<item objectid="2"/>')), "its object '2' is missing"),
        (package(model(made_of(1, mesh_of()), '<item objectid="1" transform="1 2"/>')), "twelve numbers"),
        (
            package(model(made_of(1, mesh_of().replace("0.0", "O.0")), '<item objectid="1"/>')),
            "belongs .*O.0",
        ),
        (package(model(made_of(1, mesh_of().replace(" v3", " w3")), '<item objectid="1"/>')), "has no v3"),
        (
            package(model(made_of(1, mesh_of()), '<item objectid="1"/>', 'unit="ell"')),
            "unit 'ell' is none of 3MF's",
        ),
        (
            package(
                model(
                    made_of(1, '<components><component objectid="1"/></components>'), '<item objectid="1"/>'
                )
            ),
            "made of each other",
        ),
        (
            package(model(made_of(1, mesh_of()) + NESTED, '<item objectid="39"/>')),
            "more than 20 times the file's",
        ),
        (package(model(made_of(1, mesh_of()) + " " * 60_000_000, "")), "more than 20 times the file's"),
    ],
    ids=lambda value: value[:20] if isinstance(value, str) else "",
)
def test_refusals(data, message):
    with pytest.raises(UnreadableError, match=message):
        contents(data)


def test_a_package_that_lies_about_a_member_s_size_is_damaged():
    lied = bytearray(SIMPLE)
    directory = lied.rindex(b"PK\1\2")
    size = struct.unpack_from("<I", lied, directory + 24)[0]
    struct.pack_into("<I", lied, directory + 24, size // 2)
    with pytest.raises(UnreadableError, match="truncated or damaged"):
        contents(bytes(lied))


def test_single_bytes_that_are_wrong_give_a_mesh_or_an_error(tmp_path, rng):
    for place in range(0, len(SIMPLE), 29):
        damaged = bytearray(SIMPLE)
        damaged[place] ^= int(rng.integers(1, 256))
        mesh, message = meshfiles.outcome(write(tmp_path, ".3mf", bytes(damaged)))
        assert (mesh is None) != (message is None)
