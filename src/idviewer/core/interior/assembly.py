"""Assembly of an interior distance: its boundary, refined where that is needed, and the coordinates on it."""

from __future__ import annotations

from collections.abc import Generator

from idviewer.core.coordinates import coordinates_of
from idviewer.core.distances import Distance
from idviewer.core.interior.embedding import EmbeddedBoundary
from idviewer.core.interior.interpolation import BasisInterpolation
from idviewer.core.shapes.shape import Shape, ShapeLike, as_shape
from idviewer.core.spectrum.eigen_solver import Spectrum, paper_cutoff
from idviewer.core.spectrum.resolution import Refine, Resolved, checked_refinement, resolved_steps

Parts = tuple[EmbeddedBoundary, BasisInterpolation]


def part_steps(
    shape: ShapeLike,
    distance: Distance,
    coordinates: str,
    rtol: float = 0.0,
    spectrum: Spectrum | None = None,
    refine: Refine | Resolved = "auto",
) -> Generator[float | None, None, Parts]:
    """Make the boundary and the interpolation of an `InteriorDistance`; the basis is not prepared yet.

    Args:
        shape, distance, coordinates, rtol, spectrum: as there.
        refine: as there, or what `boundary_steps` made of the shape before.

    Raises:
        ValueError, ShapeError: as there.

    >>> from idviewer.core import GPS, Polygon
    >>> from idviewer.core.steps import finish
    >>> square = Polygon([[0, 0], [1, 0], [1, 1], [0, 1]])
    >>> boundary, inside = finish(part_steps(square, GPS(), "mean_value"))
    >>> len(boundary.full_shape.vertices), len(boundary.shape.vertices)
    (4, 84)
    """
    given = as_shape(shape)
    coordinates_of(given, coordinates)  # what does not work is refused before anything takes time
    if isinstance(refine, Resolved):
        resolved = refine
    elif spectrum is None:
        resolved = yield from boundary_steps(given, distance, checked_refinement(refine))
    else:
        resolved = Resolved.unrefined(given)
    if spectrum is not None and len(spectrum.masses) != len(resolved.shape.vertices):
        raise ValueError(
            f"the eigenpairs are of a boundary with {len(spectrum.masses):,} vertices, and this one has "
            f"{len(resolved.shape.vertices):,}; give those of the shape, or what boundary_steps made of it"
        )
    boundary = EmbeddedBoundary(resolved.shape, distance, spectrum, resolved=resolved)
    return boundary, BasisInterpolation(boundary, coordinates_of(resolved.shape, coordinates), rtol)


def boundary_steps(
    shape: Shape, distance: Distance, refine: Refine = "auto"
) -> Generator[float | None, None, Resolved]:
    """Refine a shape's boundary where a distance needs it; yields the share done, or None.

    Args:
        shape: as it is given.
        distance: those that are exact on any boundary leave it as it is.
        refine: "auto", "no", or the longest edge allowed, in the shape's unit.

    >>> from idviewer.core import Euclidean, Polygon
    >>> from idviewer.core.steps import finish
    >>> finish(boundary_steps(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]), Euclidean())).added
    0
    """
    if not distance.needs_resolution:
        return Resolved.unrefined(shape, refine)
    cutoff = distance.cutoff if distance.spectral else paper_cutoff
    return (yield from resolved_steps(shape, refine, cutoff))


def serves(boundary: EmbeddedBoundary, distance: Distance) -> bool:
    """Whether a distance can be had on a boundary that was made for another: it is refined as it needs.

    Args:
        boundary: of the other distance.
        distance: that is wanted.

    >>> from idviewer.core import Euclidean, GPS, Polygon
    >>> boundary = EmbeddedBoundary(Polygon([[0, 0], [1, 0], [1, 1], [0, 1]]), Euclidean())
    >>> serves(boundary, GPS())  # nothing is to be refined
    True
    """
    resolved = boundary.resolved
    if resolved.option == "no":
        return True
    if resolved.added:
        return not distance.of_given_vertices
    return boundary.distance.needs_resolution or not distance.needs_resolution
