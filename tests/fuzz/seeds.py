"""Whole files that mutants are made of: at least one of every format that is read."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from functools import cache
from pathlib import Path

from tests.core import meshfiles, shapes
from tests.core.polygonfiles import CSV, HOLED, RING, drawing, path
from tests.fuzz.volume_seeds import volume_seeds

from idviewer.core.io import readable_suffixes
from idviewer.core.io.formats import format_of
from idviewer.view.vtk_files import register_vtk_reader

SLOW_SUFFIXES = (".vtp", ".vtu", ".vtk", ".msh", ".gii", ".pial")
"""Of files that a process of its own reads: one trial in twenty is of these."""


@cache
def seeds() -> dict[str, list[bytes]]:
    """Files by their suffix.

    Raises:
        AssertionError: a format that is read has none.
    """
    register_vtk_reader()
    made = volume_seeds()
    for suffix, write in (*meshfiles.WRITERS.values(), (".vtp", meshfiles.vtp)):
        bodies = (shapes.tetrahedron(), shapes.cube(), shapes.soup(shapes.cube()))
        made.setdefault(suffix, []).extend(write(*body) for body in bodies)
    legacy = "# vtk DataFile Version 3.0\nthing\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n"
    legacy += "0 0 0 1 0 0 0 1 0 0 0 1\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
    made[".vtk"] = [legacy.encode()]
    made[".vtu"] = [_grid().encode()]
    made[".csv"] = [CSV.encode(), HOLED.format("\n").encode(), b"x;y\n0,5;1,5\n1,5;0,5\n0;0\n"]
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    ring = [*square, square[0]]
    feature = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
    made[".json"] = [json.dumps(one).encode() for one in (square, {"outer": square, "holes": []})]
    made[".geojson"] = [
        json.dumps(one).encode()
        for one in (feature, {"type": "FeatureCollection", "features": [feature] * 2})
    ]
    made[".wkt"] = [f"POLYGON (({RING}))".encode(), f"MULTIPOLYGON ((({RING})), (({RING})))".encode()]
    curve = path("M0 0 C 0 4 6 4 6 0 A 3 2 0 1 1 5 2 z").encode()
    made[".svg"] = [curve, drawing('<g transform="scale(2)"><rect width="4" height="3"/></g>').encode()]
    made[".3mf"] = [_package(*shapes.cube())]
    made[".inp"] = [(NODES + "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n").encode(), PLACED.encode()]
    made[".msh"] = [ELEMENTS.encode()]
    made[".gii"] = [_gifti().encode()]
    body = struct.pack(">2i12f12i", 4, 4, *shapes.tetrahedron()[0].ravel(), *shapes.tetrahedron()[1].ravel())
    made[".pial"] = [b"\xff\xff\xfemade by a test\n\n" + body]
    readers = {_reader(suffix) for suffix in made}
    for suffix in readable_suffixes():
        assert _reader(suffix) in readers, f"no seed for {suffix}"
    return made


NODES = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n"
PLACED = (
    f"*PART, NAME=a\n{NODES}*ELEMENT, TYPE=S3\n1, 1, 3, 2\n2, 1, 2, 4\n3, 1, 4, 3\n4, 2, 3, 4\n*END PART\n"
    "*ASSEMBLY, NAME=b\n*INSTANCE, NAME=c, PART=a\n1, 2, 3\n0, 0, 0, 0, 0, 1, 30\n*END INSTANCE\n"
    "*END ASSEMBLY\n"
)
ELEMENTS = (
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
    "$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n"
)


def _package(vertices, faces) -> bytes:
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in vertices.tolist())
    corners = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces.tolist())
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(
            "3D/3dmodel.model",
            '<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" unit="inch"><resources>'
            f'<object id="1"><mesh><vertices>{points}</vertices><triangles>{corners}</triangles></mesh>'
            '</object><object id="2"><components><component objectid="1" '
            'transform="1 0 0 0 1 0 0 0 1 0 0 5"/></components></object></resources>'
            '<build><item objectid="2"/></build></model>',
        )
    return stream.getvalue()


def _gifti() -> str:
    vertices, faces = shapes.tetrahedron()
    arrays = ""
    for kind, number, values in (("POINTSET", "FLOAT32", vertices), ("TRIANGLE", "INT32", faces)):
        rows = " ".join(map(str, values.ravel().tolist()))
        arrays += (
            f'<DataArray Intent="NIFTI_INTENT_{kind}" DataType="NIFTI_TYPE_{number}" Encoding="ASCII" '
            'ArrayIndexingOrder="RowMajorOrder" Dimensionality="2" Dim0="4" Dim1="3" Endian="LittleEndian" '
            f'ExternalFileName="" ExternalFileOffset=""><Data>{rows}</Data></DataArray>'
        )
    return f'<?xml version="1.0"?><GIFTI Version="1.0" NumberOfDataArrays="2">{arrays}</GIFTI>'


def _reader(suffix: str) -> object:
    known = format_of(Path(f"a{suffix}"))
    assert known is not None
    return known.read


def _grid() -> str:
    return (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n'
        '<UnstructuredGrid>\n<Piece NumberOfPoints="4" NumberOfCells="1">\n<Points>\n'
        '<DataArray type="Float64" NumberOfComponents="3" format="ascii">\n0 0 0 1 0 0 0 1 0 0 0 1\n'
        "</DataArray>\n</Points>\n<Cells>\n"
        '<DataArray type="Int64" Name="connectivity" format="ascii">\n0 1 2 3\n</DataArray>\n'
        '<DataArray type="Int64" Name="offsets" format="ascii">\n4\n</DataArray>\n'
        '<DataArray type="UInt8" Name="types" format="ascii">\n10\n</DataArray>\n'
        "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )
