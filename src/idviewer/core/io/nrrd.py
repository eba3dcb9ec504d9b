"""NRRD volumes, also Slicer's segmentations (.seg.nrrd): the header is read by pynrrd."""

from __future__ import annotations

import bz2
import io
import re
from typing import Any

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.libraries import library
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.volumes import (
    NO_UNIT,
    UNKNOWN_SIZE,
    VOLUMES,
    Volume,
    checked_size,
    file_beside,
    label_contents,
    unpacked,
)
from idviewer.core.validation.polygon_soup import PolygonSoup

NRRD_TYPES = {"i1": ("char", "int8"), "u1": ("uchar", "unsigned char", "uint8"), "i2": ("short", "int16")}
NRRD_TYPES |= {"u2": ("ushort", "unsigned short", "uint16"), "i4": ("int", "int32"), "f4": ("float",)}
NRRD_TYPES |= {
    "u4": ("uint", "unsigned", "uint32"),
    "i8": ("longlong", "long long", "int64"),
    "f8": ("double",),
}
NRRD_TYPES |= {"u8": ("ulonglong", "unsigned long long", "uint64")}
_AXES = {"left": "L", "right": "R", "posterior": "P", "anterior": "A", "superior": "S", "inferior": "I"}


def read_nrrd(source: FileSource) -> Contents[PolygonSoup]:
    """Read a label's surface from NRRD, in the space that the file names; Slicer's segments have names.

    Args:
        source: the file, with the label to take.

    Raises:
        UnreadableError: it is damaged or holds no labels, or pynrrd is missing.
    """
    nrrd = library("nrrd", "volumes of this kind are read by pynrrd")
    stream = io.BytesIO(source.data)
    try:
        header = nrrd.read_header(stream)
        voxel = _voxel_type(header)
        shape = tuple(int(side) for side in header["sizes"])
    except Exception as error:  # pynrrd's own kind of error, and what rubbish leads it to
        raise UnreadableError(f"its header cannot be read ({error})") from None
    if len(shape) > 3 and min(shape) > 1:
        raise UnreadableError(
            f"it has {len(shape)} dimensions: segments that overlap are not read; flatten them"
        )
    data = source.data[stream.tell() :]
    name = header.get("data file") or header.get("datafile")
    if name:
        data = file_beside(source.path, str(name))
    needed = checked_size(shape, voxel.itemsize, -1)
    plain = _decoded(data, header, needed)
    checked_size(shape, voxel.itemsize, len(plain))
    if str(header["encoding"]).lower() in ("ascii", "text", "txt"):
        voxels = np.array(plain.split()[: needed // voxel.itemsize], dtype=np.float64)
        checked_size(shape, 1, len(voxels))
    else:
        voxels = np.frombuffer(plain, voxel, count=needed // voxel.itemsize)
    affine, axes, known = _affine(header, shape)
    kept = [side for side, one in enumerate(shape) if len(shape) == 3 or one > 1 or side in known]
    voxels = voxels.reshape(shape, order="F").reshape([shape[side] for side in kept], order="F")
    unit, notes = _unit(header, axes) if affine is not None else ("voxel", (UNKNOWN_SIZE,))
    volume = Volume(voxels, np.eye(4) if affine is None else affine, unit, axes, _segments(header), notes)
    return label_contents(volume, source)


def _decoded(data: bytes, header: dict[str, Any], needed: int) -> bytes:
    """The voxels' bytes, or their text."""
    encoding = str(header.get("encoding", "raw")).lower()
    for _ in range(max(int(header.get("line skip", header.get("lineskip", 0))), 0)):
        data = data.partition(b"\n")[2]
    if encoding in ("ascii", "text", "txt"):
        return data
    skipped = int(header.get("byte skip", header.get("byteskip", 0)))
    if encoding == "raw":
        return data[len(data) - needed if skipped < 0 else skipped :]
    if encoding in ("gzip", "gz"):
        return unpacked(data, needed + max(skipped, 0))[max(skipped, 0) :]
    if encoding in ("bzip2", "bz2"):
        VOLUMES.bound.check(needed, len(data), "its voxels")
        try:
            return _unpacked_bz2(data, needed)
        except (OSError, EOFError, ValueError) as error:
            raise UnreadableError(f"truncated or damaged: it cannot be unpacked ({error})") from None
    raise UnreadableError(f"its encoding {encoding[:20]!a} is not known")


def _unpacked_bz2(data: bytes, needed: int) -> bytes:
    pieces, total, packed = [], 0, bz2.BZ2Decompressor()
    while total < needed and not packed.eof and (data or not packed.needs_input):
        pieces.append(packed.decompress(data, needed - total))
        total, data = total + len(pieces[-1]), b""
    return b"".join(pieces)


def _voxel_type(header: dict[str, Any]) -> np.dtype[Any]:
    """The type of the voxels; NRRD has many names for each."""
    words = [word for word in str(header["type"]).lower().removesuffix("_t").split() if word != "signed"]
    name = " ".join(word for word in words if word != "int") or "int"
    kinds = [kind for kind, names in NRRD_TYPES.items() if name in names]
    if not kinds:
        raise UnreadableError(f"voxels of the type {str(header['type'])[:20]!a} are no labels")
    return np.dtype(kinds[0]).newbyteorder("B" if str(header.get("endian")).lower() == "big" else "L")


def _affine(header: dict[str, Any], shape: tuple[int, ...]) -> tuple[Floats | None, str, list[int]]:
    """From voxels to space, the names of its axes, and which of the array's axes lie in it."""
    directions = header.get("space directions")
    affine = np.eye(4)
    if directions is not None:
        rows = [
            np.array(row, dtype=np.float64) if row is not None else np.full(3, np.nan) for row in directions
        ]
        known = [side for side, row in enumerate(rows) if row.shape == (3,) and np.isfinite(row).all()]
        if len(known) != 3:
            raise UnreadableError("it does not tell the directions of three axes")
        affine[:3, :3] = np.stack([rows[side] for side in known], axis=1)
        origin = header.get("space origin")
        affine[:3, 3] = 0.0 if origin is None else origin
        words = re.split(r"[-_ ]", str(header.get("space", "")).lower())
        axes = "".join(_AXES.get(word, "") for word in words)
        return affine, axes if len(axes) == 3 else str(header.get("space", ""))[:3].upper(), known
    spacings = header.get("spacings")
    if spacings is None:
        return None, "", []
    known = [side for side, step in enumerate(spacings) if np.isfinite(step)][:3]
    affine[:3, :3] = np.diag([abs(float(spacings[side])) for side in known]) if len(known) == 3 else np.eye(3)
    return affine, "", known


def _unit(header: dict[str, Any], axes: str) -> tuple[str, tuple[str, ...]]:
    """The unit of lengths, and a note where it is not the file's; spaces of a body are in millimetres."""
    units = header.get("space units") or header.get("units") or []
    named = {str(unit).strip('"') for unit in units if str(unit).strip('"')}
    if len(named) == 1:
        return named.pop(), ()
    return "mm", () if axes else (NO_UNIT,)


def _segments(header: dict[str, Any]) -> dict[int, str]:
    """Names of labels in a segmentation of Slicer's."""
    names = {}
    for key, value in header.items():
        found = re.match(r"Segment(\d+)_LabelValue$", str(key))
        name = header.get(f"Segment{found[1]}_Name") if found else None
        if name and str(value).strip().isdigit():
            names[int(value)] = str(name)[:60]
    return names
