"""NIfTI and FreeSurfer's MGH volumes, read by nibabel."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.libraries import library
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.volumes import NO_UNIT, Volume, checked_size, label_contents, unpacked
from idviewer.core.validation.polygon_soup import PolygonSoup

NIFTI_UNITS = {"mm": "mm", "micron": "um", "meter": "m"}
_NIFTI_HEADERS = {348: "Nifti1Image", 540: "Nifti2Image"}


def read_nifti(source: FileSource) -> Contents[PolygonSoup]:
    """Read a label's surface from NIfTI, packed or not, in the millimetres of its affine.

    Args:
        source: the file, with the label to take.

    Raises:
        UnreadableError: it is damaged or holds no labels, or nibabel is missing.
    """
    nibabel = library("nibabel", "volumes of this kind are read by nibabel")
    data = _plain(source.data)
    for order in ("little", "big"):
        kind = _NIFTI_HEADERS.get(int.from_bytes(data[:4], order))
        if kind is not None:
            return label_contents(_volume(getattr(nibabel, kind), data), source)
    raise UnreadableError("it does not begin with a header of NIfTI")


def read_mgh(source: FileSource) -> Contents[PolygonSoup]:
    """Read a label's surface from FreeSurfer's .mgh or .mgz, in the millimetres of the scanner.

    Args:
        source: the file, with the label to take.

    Raises:
        UnreadableError: it is damaged or holds no labels, or nibabel is missing.
    """
    nibabel = library("nibabel", "volumes of this kind are read by nibabel")
    return label_contents(_volume(nibabel.MGHImage, _plain(source.data)), source)


def _plain(data: bytes) -> bytes:
    return unpacked(data) if data.startswith(b"\x1f\x8b") else data


def _volume(kind: Any, data: bytes) -> Volume:
    try:
        header = kind.header_class.from_fileobj(io.BytesIO(data))
        shape, item = header.get_data_shape(), header.get_data_dtype().itemsize
        start = int(header.get_data_offset())
    except Exception as error:  # nibabel's own kinds of errors, and what rubbish leads it to
        raise UnreadableError(f"its header cannot be read ({error})") from None
    checked_size(tuple(int(side) for side in shape), item, max(len(data) - start, 0))
    image = kind.from_bytes(data)
    voxels = np.asanyarray(image.dataobj)
    named = header.get_xyzt_units()[0] if hasattr(header, "get_xyzt_units") else "mm"
    unit = NIFTI_UNITS.get(named, "mm")
    notes = () if named in NIFTI_UNITS else (NO_UNIT,)
    return Volume(voxels, np.asarray(image.affine, dtype=np.float64), unit, "RAS", notes=notes)
