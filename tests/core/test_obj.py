"""OBJ files as they are found in the wild, and as they must not be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.core import meshfiles, shapes

from idviewer.core.io.contents import FileSource
from idviewer.core.io.obj import read_obj
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.mesh_repair import repair_mesh
from idviewer.core.validation.polygon_soup import PolygonSoup

OBJ_POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
OBJ_FACES = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
EXTRAS = "vt 0 0\nvt 1 1\nvn 0 0 1\n"

OBJ_VARIANTS = {
    "plain": OBJ_POINTS + OBJ_FACES,
    "no last newline": (OBJ_POINTS + OBJ_FACES)[:-1],
    "materials, groups, smoothing": "mtllib nowhere.mtl\no thing\n"
    + OBJ_POINTS
    + "usemtl red\ng a b\ns 1\n"
    + OBJ_FACES,
    "texture indices": OBJ_POINTS + EXTRAS + "f 1/1 3/2 2/1\nf 1/2 2/2 4/1\nf 1/1 4/1 3/1\nf 2/1 3/2 4/2\n",
    "normal indices": OBJ_POINTS
    + EXTRAS
    + "f 1//1 3//1 2//1\nf 1//1 2//1 4//1\nf 1//1 4//1 3//1\nf 2//1 3//1 4//1\n",
    "all indices": OBJ_POINTS
    + EXTRAS
    + "f 1/1/1 3/2/1 2/1/1\nf 1/1/1 2/1/1 4/1/1\nf 1/1/1 4/1/1 3/1/1\nf 2/1/1 3/1/1 4/2/1\n",
    "mixed indices": OBJ_POINTS + EXTRAS + "f 1/1/1 3//1 2/1\nf 1 2 4\nf 1/ 4/ 3/\nf 2/1/ 3 4\n",
    "negative indices": OBJ_POINTS + "f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n",
    "indices counting back": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf 1 2 -1\nf 1 4 -2\nf 2 3 4\n",
    "faces first": OBJ_FACES + OBJ_POINTS,
    "objects": OBJ_POINTS + "o one\nf 1 3 2\nf 1 2 4\no two\nf 1 4 3\ng three\nf 2 3 4\n",
    "colours": OBJ_POINTS.replace("\n", " 0.5 0.5 0.5\n") + OBJ_FACES,
    "some colours": OBJ_POINTS.replace("v 1 0 0", "v 1 0 0 0.5 0.5 0.5") + OBJ_FACES,
    "weights": OBJ_POINTS.replace("\n", " 1.0\n") + OBJ_FACES,
    "comments": "# v 9 9 9\n" + OBJ_POINTS.replace("\n", " # a vertex\n") + "#f 1 2 3\n" + OBJ_FACES,
    "a comment in another alphabet": "# \u00c5 \u2026\x85f 1 2 3\n" + OBJ_POINTS + OBJ_FACES,
    "continued lines": OBJ_POINTS.replace("v 1 0 0", "v 1 \\\n 0 0")
    + OBJ_FACES.replace("f 1 4 3", "f 1 \\\n 4 \\\n 3"),
    "Windows": (OBJ_POINTS + OBJ_FACES).replace("\n", "\r\n"),
    "tabs and spaces": (" " + OBJ_POINTS + OBJ_FACES)
    .replace("v ", "v\t ")
    .replace("f ", "f\t")
    .replace("\n", " \n  "),
    "lines and points too": OBJ_POINTS + "l 1 2 3\np 4\n" + OBJ_FACES,
    "curves too": OBJ_POINTS + "vp 0.1 0.2\ncstype bezier\ndeg 3\n" + OBJ_FACES,
    "exponents": OBJ_POINTS.replace("1", "+1.0E+00") + OBJ_FACES,
}


def read(text: str) -> PolygonSoup:
    return read_obj(FileSource(text.encode(), Path("thing.obj"))).geometry


@pytest.mark.parametrize("text", OBJ_VARIANTS.values(), ids=list(OBJ_VARIANTS))
def test_obj_variants(text):
    assert meshfiles.is_tetrahedron(read(text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f 1 2 3\n", "it holds no vertices"),
        (OBJ_POINTS.replace("v 1 0 0", "v 1 0") + OBJ_FACES, "fewer than three coordinates"),
        (OBJ_POINTS.replace("v 1 0 0", "v 1 0 zero") + OBJ_FACES, "'zero' stands where a number"),
        (OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", "f 1 4 c"), "'c' stands where a vertex number"),
        (OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", "f 1 4 3.5"), "'3.5' stands where a vertex number"),
        (OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", "f 1 4 /3"), "'' stands where a vertex number"),
        (OBJ_FACES + OBJ_POINTS[:-1], "ends in the middle of a vertex"),
        (OBJ_POINTS + "\0" + OBJ_FACES, "binary data"),
    ],
)
def test_obj_refusals(text, message):
    with pytest.raises(UnreadableError, match=message):
        read(text)


@pytest.mark.parametrize("index", ["0", "5", "-5", "-99"])
def test_obj_indices_out_of_range_stay_out_of_range(index):
    polygons = read(OBJ_POINTS + OBJ_FACES.replace("f 1 4 3", f"f 1 4 {index}"))
    assert np.count_nonzero((polygons.corners < 0) | (polygons.corners >= 4)) == 1


def test_obj_with_polygons_of_every_size():
    vertices, polygons = shapes.extruded(shapes.L_OUTLINE)
    mixed = [*polygons[:5], polygons[5][:3], [polygons[5][0], *polygons[5][2:]], *polygons[6:]]
    mesh = repair_mesh(*meshfiles.parts(read(meshfiles.obj(vertices, mixed).decode())))
    assert mesh.volume == pytest.approx(3.0)
