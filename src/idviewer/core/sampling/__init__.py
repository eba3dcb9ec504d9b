"""Sampling: the embedding on slices, coarse to fine, for everything that draws or writes distances."""

from idviewer.core.sampling.basis_samples import BasisSamples, SourceError, remarks_on, remarks_on_negativity
from idviewer.core.sampling.evaluation import sample_slice, slice_values
from idviewer.core.sampling.plane_samples import PlaneSamples
from idviewer.core.sampling.point_norms import MaxNorm, PointNorms, squares_of
from idviewer.core.sampling.sampled_slice import POLYGON_PLANE, SampledSlice, SliceValues, error_bound
from idviewer.core.sampling.sampler import Sampler
from idviewer.core.sampling.settings import SamplingSettings

__all__ = [
    "POLYGON_PLANE",
    "BasisSamples",
    "MaxNorm",
    "PlaneSamples",
    "PointNorms",
    "SampledSlice",
    "Sampler",
    "SamplingSettings",
    "SliceValues",
    "SourceError",
    "error_bound",
    "remarks_on",
    "remarks_on_negativity",
    "sample_slice",
    "slice_values",
    "squares_of",
]
