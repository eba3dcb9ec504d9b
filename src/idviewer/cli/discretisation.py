"""The refinement of a boundary and the error of its discretisation, in words and for JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from idviewer.core import Discretisation, DiscretisationError, InteriorDistance, Shape
    from idviewer.core.spectrum import Refine, Resolved

UNKNOWN = "it cannot be told"


def discretisation_of(solver: InteriorDistance) -> Discretisation | None:
    """The estimate of a solver's errors; None where it cannot be had."""
    from idviewer.core import ShapeError, discretisation

    try:
        return discretisation(solver)
    except ShapeError:
        return None


def as_json(error: DiscretisationError | None) -> dict[str, Any] | None:
    """The errors for JSON: of lambda_2, relative, and of distances, as a share of the largest."""
    if error is None:
        return None
    return {
        "lambda_2": error.total_lambda_2,
        "distances": error.total_distances,
        "by_edges": {"lambda_2": error.lambda_2, "distances": error.distances},
        "by_faces_of_a_smooth_body": {
            "lambda_2": error.faces_lambda_2,
            "distances": error.faces_distances,
        },
        "largest_distance": error.largest,
        "may_exceed_5_percent": error.serious,
    }


def refinement_as_json(resolved: Resolved) -> dict[str, Any]:
    """How the boundary was refined, for JSON."""
    return {
        "asked": resolved.option,
        "vertices": len(resolved.given.vertices),
        "computed_on": len(resolved.shape.vertices),
        "edge_length": resolved.edge_length,
    }


def warnings_of(error: DiscretisationError | None) -> tuple[str, ...]:
    """What has to be told in words."""
    return (error.remark,) if error is not None and error.serious else ()


def of_shape(shape: Shape, refine: Refine) -> tuple[dict[str, Any], tuple[tuple[str, str], ...]]:
    """What `info` tells of a usable shape's boundary with the diffusion distance: for JSON, and in words."""
    from idviewer.core import Diffusion, ShapeError
    from idviewer.core.interior import shape_discretisation_steps
    from idviewer.core.steps import finish

    try:
        resolved, error = finish(shape_discretisation_steps(shape, Diffusion(), refine))
    except ShapeError as problem:
        return {"refinement": None, "discretisation": None}, (("discretisation", f"{UNKNOWN}: {problem}"),)
    told = error.remark.removeprefix("Discretisation: ") if error.largest else "none"
    words = (
        (
            "refinement",
            resolved.remark() or "none is needed" if refine == "auto" else resolved.remark() or "none",
        ),
        ("discretisation", f"{told} (diffusion distance)"),
    )
    return {"refinement": refinement_as_json(resolved), "discretisation": as_json(error)}, words
