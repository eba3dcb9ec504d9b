"""MetaImage volumes, .mha and .mhd: a header of lines, and voxels behind it or in a file beside it."""

from __future__ import annotations

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.contents import Contents, FileSource
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.volumes import Volume, checked_size, file_beside, label_contents, unpacked
from idviewer.core.validation.polygon_soup import PolygonSoup

METAIMAGE_TYPES = {
    "CHAR": "i1",
    "UCHAR": "u1",
    "SHORT": "i2",
    "USHORT": "u2",
    "INT": "i4",
    "UINT": "u4",
    "LONG": "i4",
}
METAIMAGE_TYPES |= {"ULONG": "u4", "LONG_LONG": "i8", "ULONG_LONG": "u8", "FLOAT": "f4", "DOUBLE": "f8"}
_YES = ("true", "yes", "1")
MOST_HEADER_BYTES = 1 << 16


def read_metaimage(source: FileSource) -> Contents[PolygonSoup]:
    """Read a label's surface from a MetaImage, in the millimetres of its spacing, axes and offset.

    Args:
        source: the file, with the label to take.

    Raises:
        UnreadableError: it is damaged or holds no labels.
    """
    fields, behind = _header(source.data)
    shape = tuple(int(word) for word in _words(fields, "DimSize"))
    if len(shape) != 3:
        raise UnreadableError(f"it has {len(shape)} dimensions, and a volume of labels has three")
    if fields.get("ElementNumberOfChannels", "1").strip() != "1":
        raise UnreadableError("its voxels are colours or vectors, and no labels")
    kind = fields.get("ElementType", "").strip().removeprefix("MET_")
    if kind not in METAIMAGE_TYPES:
        raise UnreadableError(f"its ElementType {kind[:20]!a} is not known")
    big = _is_set(fields, "ElementByteOrderMSB") or _is_set(fields, "BinaryDataByteOrderMSB")
    voxel = np.dtype(METAIMAGE_TYPES[kind]).newbyteorder(">" if big else "<")
    name = fields["ElementDataFile"].strip()
    if name.upper() != "LOCAL" and (name.upper() == "LIST" or "%" in name):
        raise UnreadableError("its voxels are in a list of files; save it as one .mha file")
    data = behind if name.upper() == "LOCAL" else file_beside(source.path, name)
    packed = _is_set(fields, "CompressedData")
    needed = checked_size(shape, voxel.itemsize, -1 if packed else len(data))
    if packed:
        data = unpacked(data, needed)
        checked_size(shape, voxel.itemsize, len(data))
    elif (skipped := int(fields.get("HeaderSize", "0"))) != 0:
        data = data[len(data) - needed if skipped < 0 else skipped :]
        checked_size(shape, voxel.itemsize, len(data))
    voxels = np.frombuffer(data, voxel, count=needed // voxel.itemsize).reshape(shape, order="F")
    axes = fields.get("AnatomicalOrientation", "").strip().replace("???", "")
    return label_contents(Volume(voxels, _affine(fields), "mm", "LPS" if axes else ""), source)


def _is_set(fields: dict[str, str], key: str) -> bool:
    return fields.get(key, "").strip().lower() in _YES


def _header(data: bytes) -> tuple[dict[str, str], bytes]:
    """The header's fields, and what is behind them."""
    fields: dict[str, str] = {}
    start = 0
    while start < min(len(data), MOST_HEADER_BYTES):
        end = data.find(b"\n", start)
        end = len(data) if end < 0 else end
        key, mark, value = data[start:end].decode("latin-1").partition("=")
        if not mark:
            break
        fields[key.strip()] = value.strip()
        start = end + 1
        if key.strip() == "ElementDataFile":  # the last by definition
            return fields, data[start:]
    raise UnreadableError("its header has no ElementDataFile")


def _words(fields: dict[str, str], *keys: str) -> list[str]:
    return next((fields[key].split() for key in keys if key in fields), [])


def _affine(fields: dict[str, str]) -> Floats:
    spacing = np.array(_words(fields, "ElementSpacing", "ElementSize") or np.ones(3), np.float64)
    origin = np.array(_words(fields, "Offset", "Position", "Origin") or np.zeros(3), np.float64)
    turned = np.array(_words(fields, "TransformMatrix", "Rotation", "Orientation") or np.eye(3), np.float64)
    affine = np.eye(4)
    # Its rows are the directions of the voxels' axes.
    affine[:3, :3] = turned.reshape(3, 3).T * spacing
    affine[:3, 3] = origin
    return affine
