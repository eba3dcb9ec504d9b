"""Colours for values: the paper's blue to red, and a perceptually even map, also for the colour-blind."""

from __future__ import annotations

from functools import cache

import numpy as np
import pyvista as pv
from matplotlib import colormaps as matplotlib_colormaps
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

COLORMAPS: dict[str, str] = {"paper": "Blue to red (as in the paper)", "even": "Perceptually even"}
"""Names of the colour maps, and their titles for menus."""

TABLE_SIZE = 256
"""Colours in a table."""
UNKNOWN_COLOR = (0.62, 0.62, 0.62)
"""The grey of a value that is not known (NaN)."""

# Dark blue, blue, cyan, green, yellow, red, dark red: the order of the paper's figures.
_PAPER_COLORS = np.array(
    [
        [0.06, 0.07, 0.50],
        [0.11, 0.31, 0.88],
        [0.17, 0.76, 0.90],
        [0.37, 0.80, 0.40],
        [0.98, 0.90, 0.27],
        [0.90, 0.27, 0.13],
        [0.52, 0.03, 0.06],
    ]
)


@cache
def colors(name: str) -> NDArray[np.uint8]:
    """The colours of a map from its lowest to its highest value.

    Args:
        name: one of `COLORMAPS`.

    Returns:
        (256, 3) red, green and blue, read-only.

    Raises:
        ValueError: there is no such map.

    >>> colors("paper")[[0, -1]].tolist()
    [[15, 18, 128], [133, 8, 15]]
    """
    levels = np.linspace(0.0, 1.0, TABLE_SIZE)
    if name == "paper":
        # Monotone pieces between the given colours: smooth, and no channel overshoots.
        rgb = PchipInterpolator(np.linspace(0.0, 1.0, len(_PAPER_COLORS)), _PAPER_COLORS)(levels)
    elif name == "even":
        rgb = matplotlib_colormaps["viridis"](levels)[:, :3]
    else:
        raise ValueError(f"there is no colour map {name!r}; there are {', '.join(COLORMAPS)}")
    table = np.round(np.clip(rgb, 0.0, 1.0) * 255).astype(np.uint8)
    table.flags.writeable = False
    return table


def lookup_table(name: str) -> pv.LookupTable:
    """A new lookup table over the range 0 to 1.

    Args:
        name: one of `COLORMAPS`.

    Raises:
        ValueError: there is no such map.
    """
    table = pv.LookupTable()
    table.values = np.column_stack([colors(name), np.full(TABLE_SIZE, 255, np.uint8)])
    table.scalar_range = (0.0, 1.0)
    table.nan_color = UNKNOWN_COLOR
    return table
