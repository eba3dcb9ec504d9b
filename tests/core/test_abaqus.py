"""Abaqus input files: blocks, parts and instances, elements of all kinds, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.core import shapes
from tests.core.meshfiles import refusal, write

from idviewer.core.io.abaqus import read_abaqus
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.meshes import read_mesh
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.mesh_repair import repair_mesh

CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]


def contents(text: str, part: str | None = None) -> Contents:
    return read_abaqus(FileSource(text.encode(), Path("a.inp"), part))


def mesh_of(read: Contents):
    soup = read.geometry
    return repair_mesh(soup.vertices, np.split(soup.corners, np.cumsum(soup.sizes)[:-1]))


def nodes(points=CUBE, first: int = 1) -> str:
    return "*Node\n" + "".join(f"{n},  {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(points, first))


HEXAHEDRON = "*Element, type=C3D8R, elset=ALL\n7, 1, 2, 3, 4, 5, 6, 7, 8\n"
BODY = nodes() + HEXAHEDRON
ASSEMBLY = (
    f"*Heading\n cubes\n** a remark\n*Part, name=Cube\n{BODY}"
    "*Solid Section, elset=ALL, material=steel\n,\n*End Part\n"
    "*Assembly, name=Assembly\n*Instance, name=left, part=Cube\n*End Instance\n"
    "*Instance, name=right, part=CUBE\n5., 0., 0.\n5., 0., 0., 5., 0., 1., 30.\n*End Instance\n"
    "*Nset, nset=x\n1,\n"
    "*End Assembly\n*Step\n*Static\n1., 1.\n*End Step\n"
)


def test_a_cube(tmp_path):
    for text in (
        BODY,
        BODY.replace("\n", "\r\n"),
        BODY.upper(),
        "*HEADING\n3, 4\n" + BODY,
        BODY.replace("8R", "8R,\n"),
    ):
        mesh = mesh_of(contents(text))
        assert (mesh.volume, len(mesh.vertices)) == (pytest.approx(1.0), 8)
    mesh = read_mesh(write(tmp_path, ".inp", BODY.replace(".0", ".D+00").encode("utf-16")))
    assert (mesh.volume, mesh.unit) == (pytest.approx(1.0), "")


def test_nodes_in_several_blocks_with_any_numbers():
    """The first block must not be lost, nor elements that stand before the second."""
    far = [[x + 1, y, z] for x, y, z in CUBE]
    second = [far[i] for i in (1, 2, 5, 6)]
    text = nodes(first=101) + "*ELEMENT, TYPE=C3D8\n1, 101, 102, 103, 104,\n105, 106, 107, 108\n"
    text += nodes(second, 900) + "*ELEMENT, TYPE=C3D8\n2, 102, 900, 901, 103, 106, 902, 903, 107\n"
    mesh = mesh_of(contents(text))
    assert (mesh.volume, mesh.area) == (pytest.approx(2.0), pytest.approx(10.0))


def test_instances_are_placed(tmp_path):
    read = contents(ASSEMBLY)
    assert [part.name for part in read.parts] == ["left", "right"]
    left, right = read.geometry.vertices[:8], read.geometry.vertices[8:]
    assert np.array_equal(left, CUBE)
    turned = Rotation.from_rotvec([0, 0, np.radians(30)]).apply(CUBE) + np.array([5.0, 0, 0])
    assert np.allclose(right, turned, rtol=0, atol=1e-12)
    path = write(tmp_path, ".inp", ASSEMBLY.encode())
    assert "2 components with" in refusal(path)
    assert read_mesh(path, part="right").bounds[0, 0] == pytest.approx(turned[:, 0].min())
    assert "it has no 'x' among its instances; there are 'left', 'right'" in refusal(path, part="x")


def test_a_part_without_instances_is_taken_where_it_is():
    text = ASSEMBLY.partition("*Assembly")[0]
    assert mesh_of(contents(text)).volume == pytest.approx(1.0)


@pytest.mark.parametrize("kind", ["S3R", "STRI3", "R3D3", "M3D3"])
def test_shells_are_a_surface(kind):
    points, faces = shapes.l_shape()
    rows = "".join(f"{n}, {a + 1}, {b + 1}, {c + 1}\n" for n, (a, b, c) in enumerate(faces.tolist(), 1))
    read = contents(nodes(points.tolist()) + f"*Element, type={kind}\n{rows}*Element, type=B31\n99, 1, 2\n")
    assert np.array_equal(read.geometry.corners.reshape(-1, 3), faces)
    assert read.notes == ("Elements without a surface were passed over: B31.",)


@pytest.mark.parametrize(
    ("kind", "count"), [("C3D4", 4), ("C3D6", 5), ("SC6R", 5), ("C3D10M", 16), ("C3D20RH", 30), ("COH3D8", 6)]
)
def test_solids_of_other_kinds(kind, count, rng):
    number = int("".join(one for one in kind.replace("3D", "") if one.isdigit()))
    points = rng.standard_normal((number, 3)).tolist()
    row = "1, " + ",\n".join(str(n + 1) for n in range(number))
    assert len(contents(nodes(points) + f"*Element, type={kind}\n{row}\n").geometry.sizes) == count


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (nodes(), "no solid and no shell elements"),
        (BODY[:-4], "truncated: an element C3D8R does not have 8 nodes"),
        (BODY.replace("1, 1, 1\n", "1, 1\n"), "a number and three coordinates"),
        (BODY.replace("6, 7, 8", "6, 7, 9"), "refers to a missing node"),
        (BODY + nodes([[9, 9, 9]]), "two nodes with the number 1"),
        (ASSEMBLY.partition("*End Assembly")[0], r"truncated: its \*ASSEMBLY does not end"),
        (BODY + "*End Part\n", r"its \*END PART ends nothing"),
        ("*Include, input=/etc/passwd\n" + BODY, r"makes its mesh by \*INCLUDE, or elsewhere"),
        (BODY.replace("*Node", "*Node, input=nodes.txt"), r"by \*NODE, or elsewhere"),
        ("*Ngen\n1, 5\n" + BODY, r"makes its mesh by \*NGEN"),
        (BODY.replace("*Node", "*Node, system=C"), "cylindrical or spherical"),
        (BODY.replace("C3D8R", "C3D27"), "elements of the type 'C3D27', which are not known"),
        (BODY.replace("C3D8R", "CPS4"), "elements of the type 'CPS4'"),
        (ASSEMBLY.replace("5., 0., 0.\n", "5., 0.\n"), "the instance 'right' is placed by 2 numbers"),
        (
            ASSEMBLY.replace("*End Assembly", "*Instance, part=Cube\n*End Instance\n" * 40000),
            "what its instances describe would take",
        ),
        (ASSEMBLY.replace("5., 0., 1., 30", "5., 0., 0., 30"), "about no axis"),
    ],
    ids=lambda value: value[:20] if len(value) < 200 else "",
)
def test_refusals(text, message):
    with pytest.raises(UnreadableError, match=message):
        contents(text)
