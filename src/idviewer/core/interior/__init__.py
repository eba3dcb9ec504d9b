"""Interior distance: a boundary's embedding interpolated inside (the paper's equations 1 to 5)."""

from idviewer.core.interior.assembly import boundary_steps
from idviewer.core.interior.barycentroid import Barycentroid
from idviewer.core.interior.descriptors import (
    DESCRIPTORS,
    ShapeDescriptors,
    descriptor_differences,
    shape_descriptors,
)
from idviewer.core.interior.discretisation_error import Discretisation, DiscretisationError
from idviewer.core.interior.discretisation_levels import (
    discretisation,
    discretisation_steps,
    shape_discretisation_steps,
)
from idviewer.core.interior.embedded_points import extent
from idviewer.core.interior.equations import gram_distance, pairwise_distance
from idviewer.core.interior.interpolation import ERROR_SHARE_OF_AN_END
from idviewer.core.interior.point_placement import Placement, place_points
from idviewer.core.interior.preview import (
    EIGENPAIRS_STAGE,
    SIMPLIFYING_STAGE,
    Preview,
    is_worth_previewing,
    preview_cutoff,
    preview_steps,
)
from idviewer.core.interior.preview_solver import preview_solver
from idviewer.core.interior.random_points import random_interior_points
from idviewer.core.interior.single_call import interior_distance
from idviewer.core.interior.solver import InteriorDistance
from idviewer.core.interior.solver_steps import solver_steps

__all__ = [
    "DESCRIPTORS",
    "EIGENPAIRS_STAGE",
    "ERROR_SHARE_OF_AN_END",
    "SIMPLIFYING_STAGE",
    "Barycentroid",
    "Discretisation",
    "DiscretisationError",
    "InteriorDistance",
    "Placement",
    "Preview",
    "ShapeDescriptors",
    "boundary_steps",
    "descriptor_differences",
    "discretisation",
    "discretisation_steps",
    "extent",
    "gram_distance",
    "interior_distance",
    "is_worth_previewing",
    "pairwise_distance",
    "place_points",
    "preview_cutoff",
    "preview_solver",
    "preview_steps",
    "random_interior_points",
    "shape_descriptors",
    "shape_discretisation_steps",
    "solver_steps",
]
