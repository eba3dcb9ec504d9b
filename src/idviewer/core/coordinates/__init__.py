"""Barycentric coordinates: what carries values at the vertices of a shape to the points inside.

A kind of coordinates is a class in a module of this package, which the decorator `register_coordinates`
enters in `COORDINATES`; menus and the command line are built from that table.
"""

from importlib import import_module
from pkgutil import iter_modules

from idviewer.core.coordinates.mean_value import MeanValueCoordinates, mean_value_weights
from idviewer.core.coordinates.registry import (
    COORDINATES,
    Coordinates,
    Property,
    coordinates_of,
    register_coordinates,
)
from idviewer.core.coordinates.tolerance import Approximation

__all__ = [
    "COORDINATES",
    "Approximation",
    "Coordinates",
    "MeanValueCoordinates",
    "Property",
    "coordinates_of",
    "mean_value_weights",
    "register_coordinates",
]

for _module in sorted(iter_modules(__path__), key=lambda module: module.name):
    import_module(f"{__name__}.{_module.name}")
