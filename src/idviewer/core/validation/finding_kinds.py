"""The kinds of findings, and the words for each."""

from __future__ import annotations

from typing import NamedTuple


class Kind(NamedTuple):
    """The words for one kind of finding; `repair` is empty where there is none."""

    one: str
    many: str
    repair: str = ""
    remedy: str = ""


_EXPORT_AGAIN = "export it again from the program that made it"
_CLEAN_UP = "clean it in a mesh editor such as MeshLab or Blender"
_CLOSE_HOLES = "close the holes in a mesh editor such as MeshLab or Blender"

KINDS = {
    "no_faces": Kind("", "", remedy="export the surface as triangles"),
    "index_out_of_range": Kind(
        "face that refers to a missing vertex", "faces that refer to missing vertices", remedy=_EXPORT_AGAIN
    ),
    "few_corners": Kind(
        "face with fewer than three corners", "faces with fewer than three corners", repair="left out"
    ),
    "isolated_vertices": Kind("isolated vertex", "isolated vertices", repair="dropped"),
    "not_finite": Kind(
        "vertex whose coordinates are not finite numbers",
        "vertices whose coordinates are not finite numbers",
        remedy=_EXPORT_AGAIN,
    ),
    "extent": Kind("", "", remedy="scale it to another unit"),
    "polygons": Kind(
        "polygon with more than three corners", "polygons with more than three corners", repair="triangulated"
    ),
    "repeated_vertices": Kind("face that repeats a vertex", "faces that repeat a vertex", repair="left out"),
    "duplicated_vertices": Kind("duplicated vertex", "duplicated vertices", repair="merged"),
    "touching_vertices": Kind(
        "vertex that coincides with another", "vertices that coincide with others", repair="kept apart"
    ),
    "duplicate_faces": Kind("duplicate face", "duplicate faces", repair="left out"),
    "double_sided": Kind(
        "face that is there a second time, from behind,",
        "faces that are there a second time, from behind,",
        repair="taken once",
    ),
    "inner_walls": Kind(
        "face inside the body (an inner wall)",
        "faces inside the body (inner walls)",
        remedy="have inner walls left out, with drop_walls=True",
    ),
    "fins": Kind(
        "face that bounds no solid (a fin)",
        "faces that bound no solid (fins)",
        remedy="have fins left out, with drop_walls=True",
    ),
    "cut_edges": Kind(
        "edge with more than two faces, where the body touches itself,",
        "edges with more than two faces, where the body touches itself,",
        repair="cut into copies with two faces each",
    ),
    "cut_vertices": Kind(
        "vertex in which parts of the surface meet",
        "vertices in which parts of the surface meet",
        repair="cut into copies, one for each part",
    ),
    "crossing_shells": Kind("", "", remedy="unite them"),
    "voids": Kind(
        "shell inside the body",
        "shells inside the body",
        repair="taken for the boundary of a void",
    ),
    "precision": Kind("", "", repair="kept"),
    "turned_shells": Kind("", "", repair="turned"),
    "nearby_vertices": Kind(
        "boundary vertex",
        "boundary vertices",
        repair="merged with a neighbour within a millionth of the size",
    ),
    "several_components": Kind("", "components"),
    "no_such_component": Kind("", ""),
    "chosen_component": Kind("", "", repair="taken"),
    "non_manifold_edges": Kind(
        "edge with more than two faces", "edges with more than two faces", remedy=_CLEAN_UP
    ),
    "boundary_edges": Kind("boundary edge", "boundary edges", remedy=_CLOSE_HOLES),
    "not_orientable": Kind("", "", remedy="only a closed, two-sided surface has an inside"),
    "inconsistent_winding": Kind(
        "face wound against its neighbours", "faces wound against their neighbours", repair="turned"
    ),
    "flat_faces": Kind(
        "face without area",
        "faces without area",
        repair="removed by flipping or collapsing edges, which keeps the shape",
        remedy=_CLEAN_UP,
    ),
    "no_volume": Kind("", "", remedy="a solid body is needed; give the sheet a thickness"),
    "inside_out": Kind("", "", repair="turned"),
    "pinched_vertices": Kind(
        "pinched vertex, where the surface touches itself,",
        "pinched vertices, where the surface touches itself,",
        repair="kept",
    ),
    "self_intersections": Kind("", "", repair="kept"),
    "uneven_triangles": Kind("", "", repair="bridged by an intrinsic Delaunay triangulation"),
}

HARMLESS_KINDS = (
    "touching_vertices",
    "pinched_vertices",
    "self_intersections",
    "uneven_triangles",
    "voids",
    "precision",
)
"""Kinds that a mesh may have: they are reported, and nothing is done about them."""

COMPONENT_KINDS = ("several_components", "no_such_component", "crossing_shells")
"""Kinds that choosing one of the components does away with."""
