"""Resolution of a boundary: edges short enough for the modes that a distance keeps.

Functions on a boundary are linear along its edges and on its faces. A mode of eigenvalue lambda has the
wavelength 2 pi / sqrt(lambda), and with fewer than some eight edges to it the eigenpairs are those of another
problem. Modes that hardly weigh need not be resolved. See docs/resolution.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass

from idviewer.core.memory import bytes_in_words
from idviewer.core.shapes.mesh import Mesh, MeshError
from idviewer.core.shapes.mesh_refinement import MESH_REFINEMENT, refined_count
from idviewer.core.shapes.polygon import Polygon
from idviewer.core.shapes.shape import Shape
from idviewer.core.spectrum.eigen_solver import paper_cutoff
from idviewer.core.spectrum.lowest_eigenvalue import largest_lambda_2, lowest_eigenvalue_steps
from idviewer.core.spectrum.memory_estimate import available_bytes, needed_bytes, vertices_for

Refine = str | float
"""Refinement of a boundary: "auto", "no", or the longest edge allowed, in the shape's unit."""


@dataclass(frozen=True)
class ResolutionSettings:
    """Settings by which a boundary is fine enough, or refined. Measured in docs/decisions.md.

    Attributes:
        edges_per_wavelength: of the shortest wave that counts.
        mesh_share: on meshes, that wave's eigenvalue as a share of the cut-off: with the paper's, modes that
            weigh exp(-lambda t) < 0.5 % count no more.
        polygon_share: likewise of polygons, where all modes that are kept are cheap to resolve.
        tolerated: edges so many times as long as that are let be where no edge is longer.
        trial_coarseness: edges so many times as long as needed tell lambda_2 well enough.
        trial_vertices: about how many suffice for that in any case.
        most_vertices: of a mesh refined by itself; where it would take more, its edges stay longer.
        most_polygon_vertices: likewise of a polygon.
    """

    edges_per_wavelength: float = 8.0
    mesh_share: float = 0.385
    polygon_share: float = 1.0
    tolerated: float = 4.0 / 3.0
    trial_coarseness: float = 3.0
    trial_vertices: int = 1000
    most_vertices: int = 40_000
    most_polygon_vertices: int = 2000


RESOLUTION = ResolutionSettings()


@dataclass(frozen=True, eq=False)
class Resolved:
    """A boundary fine enough to compute on.

    Attributes:
        given: the boundary as it was given.
        shape: the same, refined where that was needed.
        option: what was asked for: "auto", "no", or a length.
        lambda_2: within some percent, where it had to be found out; None elsewhere.
        edge_length: the longest allowed; None where nothing was refined.
        reason: why it was refined, to follow "since"; empty where nothing was.
    """

    given: Shape
    shape: Shape
    option: Refine = "no"
    lambda_2: float | None = None
    edge_length: float | None = None
    reason: str = ""

    @classmethod
    def unrefined(cls, shape: Shape, option: Refine = "no") -> Resolved:
        """A boundary that is computed on as it is given.

        Args:
            shape: the boundary.
            option: what was asked for.

        >>> Resolved.unrefined(Polygon([[0, 0], [1, 0], [0, 1]])).added
        0
        """
        return cls(shape, shape, option)

    @property
    def added(self) -> int:
        """The number of vertices that the given boundary does not have."""
        return len(self.shape.vertices) - len(self.given.vertices)

    def remark(self, modes: int = 0) -> str:
        """What was refined and why, in words; empty where nothing was.

        Args:
            modes: how many are kept, where they are known.

        >>> triangle = Polygon([[0, 0], [1, 0], [0, 1]])
        >>> Resolved(triangle, triangle.refined(0.5), 0.5, None, 0.5, "its edges are too long").remark()
        '3 -> 7 vertices, since its edges are too long'
        """
        if not self.added:
            return ""
        before, after = len(self.given.vertices), len(self.shape.vertices)
        reason = self.reason.format(modes=f"{modes:,} modes" if modes else "the modes that count")
        return f"{before:,} -> {after:,} vertices, since {reason}"


def needed_edge_length(dimension: int, lambda_2: float, cutoff: Callable[[float], float]) -> float:
    """The longest edge that resolves the modes which count, in the shape's unit.

    Args:
        dimension: of the space.
        lambda_2: the first non-zero eigenvalue.
        cutoff: from it to the bound of the eigenvalues kept.

    >>> round(needed_edge_length(3, 1.0, paper_cutoff), 3)
    0.12
    """
    share = RESOLUTION.polygon_share if dimension == 2 else RESOLUTION.mesh_share
    return 2.0 * math.pi / math.sqrt(share * cutoff(lambda_2)) / RESOLUTION.edges_per_wavelength


def checked_refinement(refine: Refine) -> Refine:
    """The word or the length, if it is one.

    Raises:
        ValueError: it is neither; one line says what is allowed.

    >>> checked_refinement("auto"), checked_refinement("0.5"), checked_refinement(2)
    ('auto', 0.5, 2.0)
    """
    if refine in ("auto", "no"):
        return refine
    try:
        length = math.nan if isinstance(refine, bool) else float(refine)
    except (TypeError, ValueError):
        length = math.nan
    if not 0.0 < length < math.inf:
        raise ValueError(
            f"refinement is auto, no, or the longest edge allowed, a positive number; not {refine}"
        )
    return length


def resolved_steps(
    shape: Shape, refine: Refine = "auto", cutoff: Callable[[float], float] = paper_cutoff
) -> Generator[float | None, None, Resolved]:
    """Find out how fine a boundary must be, and refine it; yields the share done, or None.

    Args:
        shape: as it is given.
        refine: "auto", "no", or the longest edge allowed, in the shape's unit.
        cutoff: from lambda_2 to the bound of the eigenvalues that are to be kept.

    Raises:
        ShapeError: a length that would take more vertices than there is memory for.
        ValueError: `refine` is none of these.

    >>> from idviewer.core.steps import finish
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> finish(resolved_steps(square)).remark()
    '4 -> 84 vertices, since its edges are too long for the modes that count'
    """
    refine = checked_refinement(refine)
    if refine == "no" or not isinstance(shape, Mesh | Polygon):
        return Resolved.unrefined(shape)
    if isinstance(refine, float):
        _check_count(shape, refine)
        yield 0.5
        reason = f"edges of at most {refine:.4g} were asked for"
        return Resolved(shape, shape.refined(refine), refine, None, refine, reason)
    # A bound from above for lambda_2, so one from below for the length, spares most shapes all that follows.
    highest = largest_lambda_2(shape)
    if shape.longest_edge <= _tolerated(shape, highest, cutoff):
        return Resolved.unrefined(shape, refine)
    lambda_2 = yield from _lambda_2_steps(shape, highest, cutoff)
    if shape.longest_edge <= _tolerated(shape, lambda_2, cutoff):
        return Resolved(shape, shape, refine, lambda_2)
    pieces = "edges are too long" if shape.dimension == 2 else "triangles are too large"
    wanted = needed_edge_length(shape.dimension, lambda_2, cutoff)
    length = _affordable(shape, wanted)
    reason = f"its {pieces} for {{modes}}"
    if length > wanted:
        reason += f"; about {(length / wanted) ** 2:.2g} times as many would resolve them"
    yield 0.5
    return Resolved(shape, shape.refined(length), refine, lambda_2, length, reason)


def _tolerated(shape: Shape, lambda_2: float, cutoff: Callable[[float], float]) -> float:
    return RESOLUTION.tolerated * needed_edge_length(shape.dimension, lambda_2, cutoff)


def _lambda_2_steps(
    shape: Mesh | Polygon, bound: float, cutoff: Callable[[float], float]
) -> Generator[float | None, None, float]:
    """lambda_2 within some percent, of the shape refined a little.

    Args:
        shape: as it is given.
        bound: of lambda_2, from above.
        cutoff: as for `resolved_steps`.
    """
    coarse = RESOLUTION.trial_coarseness * needed_edge_length(shape.dimension, bound, cutoff)
    if isinstance(shape, Mesh):
        # Where the bound is bad, because the shape is bent, the area tells what is enough.
        even = math.sqrt(MESH_REFINEMENT.vertices_per_area * shape.area / RESOLUTION.trial_vertices)
        coarse = max(coarse, even)
    return (yield from lowest_eigenvalue_steps(shape.refined(coarse)))


def _affordable(shape: Mesh | Polygon, wanted: float) -> float:
    """The length that is wanted, or the shortest one above it that does not take too many vertices."""
    if isinstance(shape, Polygon):
        return max(wanted, shape.perimeter / RESOLUTION.most_polygon_vertices)
    most = max(float(RESOLUTION.most_vertices), 1.5 * len(shape.vertices))
    most = min(most, vertices_for(available_bytes()))
    length = wanted
    while length < shape.longest_edge and refined_count(shape.vertices, shape.faces, length) > most:
        length *= 1.25
    return length


def _check_count(shape: Mesh | Polygon, length: float) -> None:
    """Refuse a length that takes more vertices than there is memory for."""
    if not isinstance(shape, Mesh) or shape.longest_edge <= length:
        return
    count = refined_count(shape.vertices, shape.faces, length)
    if needed_bytes(int(count)) > (there := available_bytes()):
        raise MeshError(
            f"{shape.name or 'the mesh'}: with edges of at most {length:.4g} it would have about "
            f"{count:,.0f} vertices and need {bytes_in_words(needed_bytes(int(count)))}; this machine has "
            f"{bytes_in_words(there)}: choose longer ones"
        )
