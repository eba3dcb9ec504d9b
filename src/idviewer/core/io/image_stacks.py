"""Stacks of images and bare arrays as volumes of labels: TIFF by tifffile, .npy by NumPy."""

from __future__ import annotations

import io
import re
from typing import Any

import numpy as np

from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.libraries import library
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.volumes import UNKNOWN_SIZE, VOLUMES, Volume, checked_size, label_contents
from idviewer.core.validation.polygon_soup import PolygonSoup

STACK_UNITS = {
    "micron": "um",
    "\\u00b5m": "um",
    "µm": "um",
    "um": "um",
    "mm": "mm",
    "cm": "cm",
    "nm": "nm",
    "m": "m",
}
STACK_UNITS |= {"millimeter": "mm", "micrometer": "um", "nanometer": "nm", "inch": "in", "in": "in"}


def read_tiff(source: FileSource) -> Contents[PolygonSoup]:
    """Read a label's surface from a stack of images; x and y as in the images, z from one to the next.

    The size of voxels is taken from what ImageJ or OME writes.

    Args:
        source: the file, with the label to take.

    Raises:
        UnreadableError: it is damaged or holds no labels, or tifffile is missing.
    """
    tifffile = library("tifffile", "stacks of images are read by tifffile")
    try:
        with tifffile.TiffFile(io.BytesIO(source.data)) as file:
            return label_contents(_stack(file, len(source.data)), source)
    except tifffile.TiffFileError as error:
        raise UnreadableError(f"it is no whole TIFF file ({error})") from None
    except ValueError as error:
        if "imagecodecs" in str(error):
            raise UnreadableError(
                "its images are packed in a way that needs the package imagecodecs; save them without, "
                "or pip install imagecodecs"
            ) from None
        raise


def _stack(file: Any, size: int) -> Volume:
    series = file.series[0]
    shape = tuple(int(side) for side in series.shape)
    needed = checked_size(shape, series.dtype.itemsize, -1)
    VOLUMES.bound.check(needed, size, "its images")
    axes = series.axes
    if axes.endswith("S") and shape[-1] > 1:
        raise UnreadableError("its voxels are colours, and no labels")
    voxels = series.asarray()
    voxels = voxels.reshape([side for side in shape if side > 1] or [1])
    if voxels.ndim == 2:
        raise UnreadableError("it holds one image, and a volume of labels is a stack of them")
    steps, unit = _voxel_size(file)
    affine = np.eye(4)
    if steps is not None:
        affine[:3, :3] = np.diag(steps)
    # Images come as (z, y, x).
    notes = () if steps is not None else (UNKNOWN_SIZE,)
    return Volume(voxels.transpose(), affine, unit, notes=notes)


def _voxel_size(file: Any) -> tuple[tuple[float, float, float] | None, str]:
    """Sides of a voxel along x, y and z, and their unit; None if it is not told."""
    if file.ome_metadata:
        found = {axis: re.search(rf'PhysicalSize{axis}="([^"]+)"', file.ome_metadata) for axis in "XYZ"}
        if all(found.values()):
            unit = re.search(r'PhysicalSizeXUnit="([^"]+)"', file.ome_metadata)
            sides = tuple(float(one[1]) for one in found.values() if one)
            return _checked(sides), STACK_UNITS.get(unit[1] if unit else "µm", "um")
    told = file.imagej_metadata or {}
    tags = file.pages[0].tags
    if "spacing" in told and "XResolution" in tags and "YResolution" in tags:
        across, down = (_pixel(tags[name].value) for name in ("XResolution", "YResolution"))
        if across and down:
            sides = (across, down, abs(float(told["spacing"])))
            return _checked(sides), STACK_UNITS.get(str(told.get("unit", "")), "voxel")
    return None, "voxel"


def _checked(sides: tuple[float, ...]) -> tuple[float, float, float] | None:
    usable = len(sides) == 3 and all(np.isfinite(side) and side > 0.0 for side in sides)
    return (sides[0], sides[1], sides[2]) if usable else None


def _pixel(resolution: Any) -> float:
    """Side of a pixel, from pixels a unit as a fraction."""
    above, below = resolution
    return float(below) / float(above) if above else 0.0


def read_npy(source: FileSource) -> Contents[PolygonSoup]:
    """Read a label's surface from an array of NumPy's; coordinates are its indices.

    Args:
        source: the file, with the label to take.

    Raises:
        UnreadableError: it is damaged or holds no labels.
    """
    stream = io.BytesIO(source.data)
    try:
        version = np.lib.format.read_magic(stream)
        read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
        shape, by_columns, kind = read[version](stream)
    except (ValueError, KeyError) as error:
        raise UnreadableError(f"its header cannot be read ({error})") from None
    if kind.hasobject:
        raise UnreadableError("it holds pickled objects, which could run any program, and is not opened")
    if len(shape) < 3:
        raise UnreadableError(f"an array of {len(shape)} dimensions is no volume of labels, which has three")
    needed = checked_size(shape, kind.itemsize, len(source.data) - stream.tell())
    voxels = np.frombuffer(source.data, kind, count=needed // kind.itemsize, offset=stream.tell())
    voxels = voxels.reshape(shape, order="F" if by_columns else "C")
    return label_contents(Volume(voxels, np.eye(4), "voxel", notes=(UNKNOWN_SIZE,)), source)
