"""Whole files that mutants are made of: at least one of every suffix that is read."""

from __future__ import annotations

import json

from tests.core import meshfiles, shapes
from tests.core.polygonfiles import CSV, HOLED, RING, drawing, path

from idviewer.core.io import readable_suffixes
from idviewer.view.vtk_files import register_vtk_reader

SLOW_SUFFIXES = (".vtp", ".vtu", ".vtk")
"""Of files that a process of its own reads: one trial in twenty is of these."""


def seeds() -> dict[str, list[bytes]]:
    """Files by their suffix.

    Raises:
        AssertionError: a suffix that is read has none.
    """
    register_vtk_reader()
    made: dict[str, list[bytes]] = {}
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
    for suffix in readable_suffixes():
        assert made.get(suffix), f"no seed for {suffix}"
    return made


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
