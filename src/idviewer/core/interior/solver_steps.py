"""An interior distance made step by step, for work that is to be interrupted."""

from __future__ import annotations

from collections.abc import Generator

from idviewer.core.distances import Distance
from idviewer.core.interior.assembly import part_steps
from idviewer.core.interior.solver import InteriorDistance, solver_of_parts
from idviewer.core.shapes.shape import ShapeLike
from idviewer.core.spectrum.eigen_solver import Spectrum
from idviewer.core.spectrum.resolution import Refine, Resolved


def solver_steps(
    shape: ShapeLike,
    distance: Distance,
    coordinates: str = "mean_value",
    spectrum: Spectrum | None = None,
    refine: Refine | Resolved = "auto",
) -> Generator[float | None, None, InteriorDistance]:
    """Make an exact `InteriorDistance`; yields the share done, or None, every few milliseconds.

    Args:
        shape, distance, coordinates, spectrum, refine: as there.

    Raises:
        ValueError, ShapeError: as there.

    >>> from idviewer.core import Euclidean, Polygon
    >>> from idviewer.core.steps import finish
    >>> square = Polygon([[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> finish(solver_steps(square, Euclidean())).distance([[1, 1]], [[3, 1]]).round(12).tolist()
    [2.0]
    """
    parts = yield from part_steps(shape, distance, coordinates, 0.0, spectrum, refine)
    yield from parts[0].prepare_steps()
    return solver_of_parts(*parts)
