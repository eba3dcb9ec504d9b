"""One walk through all that can be wrong with a mesh, mending what it can and looking on behind it."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.validation import repairs as mending
from idviewer.core.validation.findings import KEPT, Finding, counted, several, stated
from idviewer.core.validation.polygon_soup import PolygonSoup, triangulated
from idviewer.core.validation.topology import Topology
from idviewer.core.validation.triangle_quality import TriangleQuality, triangle_quality_of

NO_VOLUME = 1e-9
"""A body whose volume is below this share of (its area) ** 1.5 encloses nothing (a ball has 0.09)."""

SIZES = (1e-60, 1e60)
"""Outside these, fourth powers of lengths leave the range of floating-point numbers."""


class ValidationReport:
    """The arrays as mended so far, and what was found. `validate` calls the steps in their order."""

    def __init__(self, polygons: PolygonSoup) -> None:
        self.given = polygons
        self.polygons = polygons
        self.findings: list[Finding] = []
        self.component_sizes: tuple[int, ...] = ()
        self.hopeless = False  # nothing further can be looked at
        self.triangle_quality: TriangleQuality | None = None
        self.vertices = polygons.vertices
        self._faces = np.empty((0, 3), np.int64)
        self._topology: Topology | None = None

    @property
    def faces(self) -> Ints:
        """(m, 3) triangles."""
        return self._faces

    @faces.setter
    def faces(self, faces: Ints) -> None:
        self._faces, self._topology = faces, None

    @property
    def topology(self) -> Topology:
        """Of the current faces."""
        if self._topology is None:
            self._topology = Topology(self.faces, len(self.vertices))
        return self._topology

    @property
    def size(self) -> float:
        """The bounding box's diagonal."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @property
    def fatal(self) -> bool:
        """Whether something was found that has no repair."""
        return any(finding.fatal for finding in self.findings)

    @property
    def sound(self) -> bool:
        """Whether the surface is closed, manifold and consistently wound."""
        return len(self.faces) > 0 and self.topology.closed and not self.topology.clashing.any()

    def closed(self) -> bool:
        """Whether two faces meet in every edge; a vertex with fewer than two faces spares the sorting."""
        return bool(np.bincount(self.faces.ravel()).min() > 1) and self.topology.closed

    @property
    def changed(self) -> bool:
        """Whether anything was repaired."""
        return any(finding.kind not in KEPT for finding in self.findings)

    def give_up(self, finding: Finding) -> None:
        """Nothing can be looked at behind this finding."""
        self.findings.append(finding)
        self.hopeless = True

    def near(self, vertex: int | np.integer) -> tuple[Floats, float]:
        """A place for a finding."""
        return self.vertices[vertex], self.size

    def keep(self, chosen: Bools) -> None:
        """Go on with some of the faces and the vertices they use."""
        self.vertices, self.faces = mending.compacted(self.vertices, self.faces[chosen])

    def look_at_indices(self) -> None:
        """No faces, missing vertices, too few corners, vertices without a face."""
        given, count = self.given, len(self.given.vertices)
        if len(given.sizes) == 0:
            return self.give_up(
                stated("no_faces", f"no faces among {count:,} {_vertices(count)}", count=count)
            )
        bad = (given.corners < 0) | (given.corners >= count)
        if bad.any():
            faces = np.unique(np.repeat(np.arange(len(given.sizes)), given.sizes)[bad])
            detail = f": face {faces[0]} to vertex {given.corners[bad][0]}, where 0 to {count - 1} exist"
            return self.give_up(
                counted("index_out_of_range", len(faces), detail if count else ": there are none")
            )
        if few := int(np.count_nonzero(given.sizes < 3)):
            self.findings.append(counted("few_corners", few))
        used = np.zeros(count, bool)
        used[given.corners] = True
        if not used.all():
            self.findings.append(counted("isolated_vertices", int(count - np.count_nonzero(used))))
            self.vertices = given.vertices[used]
            self.polygons = PolygonSoup(self.vertices, (np.cumsum(used) - 1)[given.corners], given.sizes)
        return None

    def look_at_coordinates(self) -> None:
        """Coordinates that are not finite, or too large or small to compute with."""
        broken = ~np.isfinite(self.vertices).all(axis=1)
        if broken.any():
            detail = f" (one is {self.vertices[np.argmax(broken)].tolist()})"
            return self.give_up(counted("not_finite", int(np.count_nonzero(broken)), detail))
        size = float(np.abs(self.vertices).max(initial=0.0))
        if size <= SIZES[1] and len(self.vertices):
            size = float(np.ptp(self.vertices, axis=0).max())
        if size > SIZES[1] or 0 < size < SIZES[0]:
            self.give_up(
                stated("extent", f"coordinates of a size of {size:.0e}, which cannot be computed with")
            )
        return None

    def look_at_polygons(self) -> None:
        """Polygons become triangles; faces that repeat a vertex go."""
        if many := int(np.count_nonzero(self.polygons.sizes > 3)):
            self.findings.append(counted("polygons", many))
        self.faces = triangulated(self.polygons)
        repeating = mending.repeating(self.faces)
        if repeating.any():
            self.findings.append(counted("repeated_vertices", int(np.count_nonzero(repeating))))
        if repeating.any() or np.any(self.polygons.sizes < 3):
            self.keep(~repeating)
        self.stop_without_faces()

    def stop_without_faces(self) -> None:
        """Nothing is left to look at."""
        if len(self.faces) == 0:
            self.give_up(
                stated("no_faces", "no face with three different corners", count=len(self.given.sizes))
            )

    def look_for_coincidences(self) -> None:
        """Duplicated vertices and faces."""
        first = mending.same_points(self.vertices)
        different = first != np.arange(len(first))
        if different.any():
            count, place = int(np.count_nonzero(different)), self.near(np.argmax(different))
            vertices, faces, _ = mending.merged(self.vertices, self.faces, first)
            # A surface that is closed as it is needs no merging: its parts only touch each other. But faces
            # that collapse, between vertices in the same place, are better gone.
            spoiled = len(faces) == len(self.faces) or len(Topology(faces, len(vertices)).crowded) > 0
            apart = spoiled and self.closed()
            kind = "touching_vertices" if apart else "duplicated_vertices"
            self.findings.append(counted(kind, count, place=place))
            if not apart:
                self.vertices, self.faces = vertices, faces
                self.stop_without_faces()
        if not self.hopeless and not self.sound:
            # The two sides of a sheet, joined at its rim alone, are no copies: its edges have two faces each.
            copies = mending.later_copies(self.faces, either_winding=len(self.topology.crowded) > 0)
            if copies.any():
                place = self.near(self.faces[np.argmax(copies), 0])
                self.findings.append(counted("duplicate_faces", int(np.count_nonzero(copies)), place=place))
                self.keep(~copies)

    def look_for_gaps(self) -> None:
        """Boundary vertices that nearly coincide are merged if that closes the surface."""
        rim = np.unique(self.topology.ends[self.topology.boundary])
        if len(rim) == 0:
            return
        first = mending.close_points(self.vertices, rim, mending.CLOSE * self.size)
        vertices, faces, gone = mending.merged(self.vertices, self.faces, first)
        if gone and len(faces) and Topology(faces, len(vertices)).closed:
            self.findings.append(counted("nearby_vertices", gone, place=self.near(rim[0])))
            self.vertices, self.faces = vertices, faces

    def look_at_components(self, component: int | None) -> None:
        """Several components: one of them if it was chosen, else an error that names them."""
        number, of_face = self.topology.components
        self.component_sizes = tuple(np.bincount(of_face).tolist())
        if component is not None and not 1 <= component <= number:
            have = (
                "there is only one"
                if number == 1
                else f"they are numbered from 1, the largest, to {number:,}"
            )
            return self.give_up(stated("no_such_component", f"no component {component}: {have}"))
        if number == 1:
            return None
        if component is None:
            self.findings.append(several(self.component_sizes))
        else:
            chosen = of_face == component - 1
            faces = f"{np.count_nonzero(chosen):,} of {len(chosen):,} faces"
            self.findings.append(stated("chosen_component", f"component {component} of {number:,} ({faces})"))
            self.keep(chosen)
        return None

    def look_at_edges(self) -> None:
        """Holes, and edges with more than two faces."""
        topology = self.topology
        if len(topology.crowded):
            place = self.near(topology.ends[topology.crowded[0], 0])
            self.findings.append(counted("non_manifold_edges", len(topology.crowded), place=place))
        if len(topology.boundary):
            loops = topology.boundary_loops()
            place = self.near(topology.ends[topology.boundary[0], 0])
            detail = f" in {loops:,} {'loop' if loops == 1 else 'loops'}"
            self.findings.append(counted("boundary_edges", len(topology.boundary), detail, place))

    def look_at_winding(self) -> None:
        """Faces wound against each other are turned, unless the surface has one side only."""
        topology = self.topology
        if not topology.clashing.any():
            return
        turned = topology.turned()
        place = self.near(topology.tails[topology.pairs[np.argmax(topology.clashing), 0]])
        if turned is None:
            self.findings.append(
                stated("not_orientable", "a one-sided surface, like a Moebius band", place=place)
            )
            return
        self.findings.append(counted("inconsistent_winding", int(np.count_nonzero(turned)), place=place))
        self.faces = np.where(turned[:, None], self.faces[:, ::-1], self.faces)

    def look_at_flat_faces(self) -> None:
        """Faces without area are flipped or collapsed away."""
        flat = mending.flat_faces(self.vertices, self.faces)
        if not flat.any():
            return
        finding = counted(
            "flat_faces", int(np.count_nonzero(flat)), place=self.near(self.faces[np.argmax(flat), 0])
        )
        if not self.fatal and not self.remove_flat_faces():
            finding = Finding(**{**vars(finding), "repair": None})
        self.findings.append(finding)

    def remove_flat_faces(self) -> bool:
        """Whether no face without area is left."""
        first = mending.without_short_edges(self.vertices, self.faces)
        vertices, faces, gone = mending.merged(self.vertices, self.faces, first)
        if gone and len(faces) and Topology(faces, len(vertices)).closed:
            self.vertices, self.faces = vertices, faces
        self.faces = mending.flipped(self.vertices, self.faces)
        return not mending.flat_faces(self.vertices, self.faces).any()

    def look_at_volume(self) -> None:
        """No volume, inside out, pinched."""
        if self.fatal:
            return
        volume, area = mending.volume_and_area(self.vertices, self.faces)
        if abs(volume) <= NO_VOLUME * area**1.5:
            self.findings.append(stated("no_volume", "no volume: the surface is closed but encloses nothing"))
            return
        if volume < 0:
            self.findings.append(stated("inside_out", "the body, which was inside out,"))
            self.faces = self.faces[:, ::-1]
        visits = np.bincount(self.topology.umbrellas(), minlength=len(self.vertices))
        if (visits > 1).any():
            pinched = np.flatnonzero(visits > 1)
            self.findings.append(counted("pinched_vertices", len(pinched), place=self.near(pinched[0])))

    def look_at_thin_faces(self) -> None:
        """Triangles on which the cotangent Laplacian is wrong: another one is used."""
        if self.fatal or (found := triangle_quality_of(self.vertices, self.faces)).bearable:
            return
        place = self.near(found.worst)
        self.findings.append(stated("uneven_triangles", found.words, count=max(found.thin, 1), place=place))


def validate(polygons: PolygonSoup, component: int | None = None) -> ValidationReport:
    """Walk through everything that can be wrong; `component` (1 is the largest) chooses one of several."""
    walk = ValidationReport(polygons)
    steps = (
        walk.look_at_indices,
        walk.look_at_coordinates,
        walk.look_at_polygons,
        walk.look_for_coincidences,
        walk.look_for_gaps,
        lambda: walk.look_at_components(component),
        walk.look_at_edges,
        walk.look_at_winding,
        walk.look_at_flat_faces,
        walk.look_at_volume,
        walk.look_at_thin_faces,
    )
    for step in steps:
        step()
        if walk.hopeless:
            break
    return walk


def _vertices(count: int) -> str:
    return "vertex" if count == 1 else "vertices"
