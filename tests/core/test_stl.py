"""STL files, binary and text."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from tests.core import meshfiles, shapes

from idviewer.core.io.stl import read_stl
from idviewer.core.io.text import UnreadableError

TETRAHEDRON = shapes.tetrahedron()


def uncounted(count: int) -> bytes:
    data = meshfiles.stl(*TETRAHEDRON)
    return data[:80] + struct.pack("<I", count) + data[84:]


def test_stl_text_variants():
    plain = meshfiles.stl_text(*TETRAHEDRON)
    whole = read_stl(plain).geometry.vertices
    assert np.array_equal(whole, TETRAHEDRON[0][TETRAHEDRON[1]].reshape(-1, 3))
    facets = plain.split(b"endfacet")
    two = (
        b"endfacet".join(facets[:2])
        + b"endfacet\nendsolid\n\nsolid two facet\n"
        + b"endfacet".join(facets[2:])
    )
    for variant in (
        plain.upper(),
        plain.replace(b"\n", b"\r\n"),
        plain.replace(b"\n", b"\r"),
        b" \n" + plain,
        two,
    ):
        assert np.array_equal(read_stl(variant).geometry.vertices, whole)


def test_stl_binary_may_begin_with_solid():
    data = meshfiles.stl(*TETRAHEDRON)
    assert data.startswith(b"solid")
    assert np.array_equal(read_stl(data).geometry.vertices, TETRAHEDRON[0][TETRAHEDRON[1]].reshape(-1, 3))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (meshfiles.stl(*TETRAHEDRON)[:60], "a facet is not|shorter than the header|solids begin"),
        (meshfiles.stl(*TETRAHEDRON)[:-50], "truncated: it announces 4 triangles and holds 3"),
        (meshfiles.stl(*TETRAHEDRON)[:-1], "truncated: it announces 4 triangles and holds 3"),
        (meshfiles.stl(*TETRAHEDRON) + bytes(50), "wrong counts: it announces 4 triangles and holds more"),
        (uncounted(0xFFFFFFFF) + b"x", "nor does its length"),
        (uncounted(0) + b"x", "wrong counts: it announces 0 triangles"),
        (meshfiles.stl_text(*TETRAHEDRON).replace(b"vertex 0", b"vertex", 1), "a facet is not"),
        (meshfiles.stl_text(*TETRAHEDRON).replace(b"vertex 0.0", b"vertex zero", 1), "'zero' stands where"),
    ],
)
def test_stl_refusals(data, message):
    with pytest.raises(UnreadableError, match=message):
        read_stl(data)
