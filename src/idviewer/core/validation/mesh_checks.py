"""The checks that make vertices and faces a mesh, each with its repair."""

from __future__ import annotations

from functools import partial

import numpy as np

from idviewer.core.validation import soup_repairs as repairs
from idviewer.core.validation.body_checks import check_bodies, wind_shells
from idviewer.core.validation.edge_checks import check_edges, drop_copies, find_open_edges, is_double_sided
from idviewer.core.validation.findings import Finding, counted, stated
from idviewer.core.validation.polygon_soup import PolygonSoup, triangulated
from idviewer.core.validation.precision import precision_of
from idviewer.core.validation.repair_choices import NO_CHOICES, RepairChoices
from idviewer.core.validation.self_intersections import self_intersections_of
from idviewer.core.validation.tolerances import TOLERANCES
from idviewer.core.validation.topology import Topology
from idviewer.core.validation.triangle_quality import triangle_quality_of
from idviewer.core.validation.validation_report import ValidationReport


def validate(polygons: PolygonSoup, choices: RepairChoices = NO_CHOICES) -> ValidationReport:
    """Check everything that can be wrong with a mesh, and repair what can be.

    Args:
        polygons: as read; nothing about them needs to be right.
        choices: what a user decides about it.

    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> report = validate(PolygonSoup.of(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [3, 2, 1]]))
    >>> [finding.message for finding in report.findings]
    ['1 face wound against its neighbours, near (0, 1, 0)']
    """
    report = ValidationReport(polygons)
    checks = (
        _check_indices,
        _check_coordinates,
        _triangulate_polygons,
        _merge_duplicates,
        drop_copies,
        _close_gaps,
        partial(check_edges, choices=choices),
        partial(check_bodies, choices=choices),
        find_open_edges,
        _orient_consistently,
        _remove_zero_area_faces,
        wind_shells,
        _find_pinched_vertices,
        _check_triangle_quality,
        _check_self_intersections,
        _check_precision,
    )
    for check in checks:
        check(report)
        if report.stopped:
            break
    return report


def without_duplicates(polygons: PolygonSoup) -> ValidationReport:
    """Make only the first of the checks: those behind which there are triangles that share their vertices.

    Args:
        polygons: as read.

    >>> sheet = PolygonSoup.of([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> without_duplicates(sheet).faces.tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    report = ValidationReport(polygons)
    for check in (_check_indices, _check_coordinates, _triangulate_polygons, _merge_duplicates):
        check(report)
        if report.stopped:
            break
    return report


def _check_indices(report: ValidationReport) -> None:
    """Refuse missing faces and vertices; leave out faces with too few corners, and isolated vertices."""
    source, count = report.source, len(report.source.vertices)
    if len(source.sizes) == 0:
        return report.stop(stated("no_faces", f"no faces among {count:,} {_vertices(count)}", count=count))
    bad = (source.corners < 0) | (source.corners >= count)
    if bad.any():
        faces = np.unique(np.repeat(np.arange(len(source.sizes)), source.sizes)[bad])
        detail = f": face {faces[0]} to vertex {source.corners[bad][0]}, where 0 to {count - 1} exist"
        return report.stop(counted("index_out_of_range", len(faces), detail if count else ": there are none"))
    if few := int(np.count_nonzero(source.sizes < 3)):
        report.add(counted("few_corners", few))
    became = repairs.numbers_of_used(source.corners, count)
    if isolated := int(np.count_nonzero(became < 0)):
        report.add(counted("isolated_vertices", isolated))
        report.renumber(source.vertices[became >= 0], report.faces, became)
        report.polygons = PolygonSoup(report.vertices, became[source.corners], source.sizes)
    return None


def _check_coordinates(report: ValidationReport) -> None:
    """Refuse coordinates that are not finite, or too large or small to compute with."""
    broken = ~np.isfinite(report.vertices).all(axis=1)
    if broken.any():
        detail = f" (one is {report.vertices[np.argmax(broken)].tolist()})"
        return report.stop(counted("not_finite", int(np.count_nonzero(broken)), detail))
    size = float(np.abs(report.vertices).max(initial=0.0))
    if size <= TOLERANCES.largest_extent and len(report.vertices):
        size = float(np.ptp(report.vertices, axis=0).max())
    if size > TOLERANCES.largest_extent or 0 < size < TOLERANCES.smallest_extent:
        report.stop(stated("extent", f"coordinates of a size of {size:.0e}, which cannot be computed with"))
    return None


def _triangulate_polygons(report: ValidationReport) -> None:
    """Cut polygons into triangles; leave out faces that repeat a vertex."""
    if many := int(np.count_nonzero(report.polygons.sizes > 3)):
        report.add(counted("polygons", many))
    report.faces = triangulated(report.polygons)
    repeating = repairs.repeating_a_vertex(report.faces)
    if repeating.any():
        report.add(counted("repeated_vertices", int(np.count_nonzero(repeating))))
    if repeating.any() or np.any(report.polygons.sizes < 3):
        report.keep(~repeating)
    _stop_without_faces(report)


def _stop_without_faces(report: ValidationReport) -> None:
    """Stop if no face is left."""
    if len(report.faces) == 0:
        report.stop(
            stated("no_faces", "no face with three different corners", count=len(report.source.sizes))
        )


def _merge_duplicates(report: ValidationReport) -> None:
    """Merge duplicated vertices, and leave out duplicate faces."""
    first = repairs.first_coincident(report.vertices)
    different = first != np.arange(len(first))
    if different.any():
        count, place = int(np.count_nonzero(different)), report.near(np.argmax(different))
        merged = repairs.merged_vertices(report.vertices, report.faces, first)
        # A surface that is closed as it is needs no merging: its parts only touch each other. But faces
        # that collapse, between vertices in the same place, are better gone.
        spoiled = (
            len(merged.faces) == len(report.faces)
            or len(Topology(merged.faces, len(merged.vertices)).non_manifold_edges) > 0
        )
        apart = spoiled and report.is_closed()
        if apart and is_double_sided(merged.faces, len(merged.vertices)):
            _take_once(report, merged)
            return
        kind = "touching_vertices" if apart else "duplicated_vertices"
        report.add(counted(kind, count, place=place))
        if not apart:
            report.renumber(merged.vertices, merged.faces, merged.became)
            _stop_without_faces(report)


def _take_once(report: ValidationReport, merged: repairs.Merged) -> None:
    """Merge the vertices of faces that are there from both sides, and take each of these once."""
    copies = repairs.duplicates_of_earlier(merged.faces, either_winding=True)
    place = merged.vertices[merged.faces[np.argmax(copies), 0]], report.size
    report.add(counted("double_sided", int(np.count_nonzero(copies)), place=place))
    report.renumber(merged.vertices, merged.faces, merged.became)
    report.keep(~copies)


def _close_gaps(report: ValidationReport) -> None:
    """Merge boundary vertices that nearly coincide, if that closes the surface."""
    rim = np.unique(report.topology.ends[report.topology.boundary])
    if len(rim) == 0:
        return
    first = repairs.first_within(report.vertices, rim, TOLERANCES.gap * report.size)
    merged = repairs.merged_vertices(report.vertices, report.faces, first)
    if merged.gone and len(merged.faces) and Topology(merged.faces, len(merged.vertices)).closed:
        report.add(counted("nearby_vertices", merged.gone, place=report.near(rim[0])))
        report.renumber(merged.vertices, merged.faces, merged.became)


def _orient_consistently(report: ValidationReport) -> None:
    """Flip faces that are inconsistently oriented; a surface with one side only is refused."""
    topology = report.topology
    if not topology.inconsistently_oriented.any():
        return
    flipped = topology.faces_to_flip()
    place = report.near(topology.tails[topology.pairs[np.argmax(topology.inconsistently_oriented), 0]])
    if flipped is None:
        report.add(stated("not_orientable", "a one-sided surface, like a Moebius band", place=place))
        return
    report.add(counted("inconsistent_winding", int(np.count_nonzero(flipped)), place=place))
    report.faces = np.where(flipped[:, None], report.faces[:, ::-1], report.faces)


def _remove_zero_area_faces(report: ValidationReport) -> None:
    """Remove faces without area by edge flips and collapses."""
    degenerate = repairs.zero_area_faces(report.vertices, report.faces)
    if not degenerate.any():
        return
    finding = counted(
        "flat_faces",
        int(np.count_nonzero(degenerate)),
        place=report.near(report.faces[np.argmax(degenerate), 0]),
    )
    if not report.fatal and not _without_zero_area_faces(report):
        finding = Finding(**{**vars(finding), "repair": None})
    report.add(finding)


def _without_zero_area_faces(report: ValidationReport) -> bool:
    """Remove faces without area; whether none is left."""
    first = repairs.first_along_short_edges(report.vertices, report.faces)
    merged = repairs.merged_vertices(report.vertices, report.faces, first)
    if merged.gone and len(merged.faces) and Topology(merged.faces, len(merged.vertices)).closed:
        report.renumber(merged.vertices, merged.faces, merged.became)
    report.faces = repairs.with_edges_flipped(report.vertices, report.faces)
    return not repairs.zero_area_faces(report.vertices, report.faces).any()


def _find_pinched_vertices(report: ValidationReport) -> None:
    """Find vertices in which the surface still touches itself."""
    if report.fatal:
        return
    visits = np.bincount(report.topology.vertex_fans(), minlength=len(report.vertices))
    if (visits > 1).any():
        pinched = np.flatnonzero(visits > 1)
        report.add(counted("pinched_vertices", len(pinched), place=report.near(pinched[0])))


def _check_triangle_quality(report: ValidationReport) -> None:
    """Find out whether thin triangles spoil the cotangent Laplacian."""
    if report.fatal:
        return
    found = report.triangle_quality = triangle_quality_of(report.vertices, report.faces)
    if found.acceptable:
        return
    place = report.near(found.worst_vertex)
    report.add(stated("uneven_triangles", found.description, count=max(found.thin_triangles, 1), place=place))


def _check_self_intersections(report: ValidationReport) -> None:
    """Find faces that cross each other."""
    if report.fatal:
        return
    found = report.self_intersections = self_intersections_of(report.vertices, report.faces)
    if found:
        report.add(found.finding)


def _check_precision(report: ValidationReport) -> None:
    """Tell what is left of the coordinates' precision, where that is little."""
    if report.fatal:
        return
    found = report.precision = precision_of(report.vertices, report.topology.ends)
    if found.coarse:
        report.add(found.finding)


def _vertices(count: int) -> str:
    return "vertex" if count == 1 else "vertices"
