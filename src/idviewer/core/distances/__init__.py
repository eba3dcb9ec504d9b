"""Boundary distances, one file each: a file that is put here is found, and registers what it defines."""

from importlib import import_module
from pkgutil import iter_modules

from idviewer.core.distances.biharmonic import Biharmonic
from idviewer.core.distances.diffusion import Diffusion
from idviewer.core.distances.euclidean import Euclidean
from idviewer.core.distances.gps import GPS
from idviewer.core.distances.parameters import Choice, File, Formula, Integer, Number, Parameter
from idviewer.core.distances.registry import (
    DISTANCES,
    Basis,
    Distance,
    QuadraticForm,
    check_dimension,
    distance,
    made,
    missing,
    parameters_of,
    values_of,
    with_defaults,
)

__all__ = [
    "DISTANCES",
    "GPS",
    "Basis",
    "Biharmonic",
    "Choice",
    "Diffusion",
    "Distance",
    "Euclidean",
    "File",
    "Formula",
    "Integer",
    "Number",
    "Parameter",
    "QuadraticForm",
    "check_dimension",
    "distance",
    "made",
    "missing",
    "parameters_of",
    "values_of",
    "with_defaults",
]

for _module in sorted(one.name for one in iter_modules(__path__)):
    import_module(f"{__name__}.{_module}")
