"""Volumes of labels for tests, and files of them written by other libraries or by hand."""

from __future__ import annotations

import zlib
from pathlib import Path

import nibabel
import nrrd
import numpy as np
import tifffile

OBLIQUE = np.array([[-0.8, 0.1, 0, 10], [0.05, 0.9, 0.2, -20], [0, -0.1, 2.0, 5], [0, 0, 0, 1]])
"""From voxels to space: turned, sheared, and left-handed."""


def labels() -> np.ndarray:
    """A ball of label 3, a larger one of 7, and a cube of 12 in a corner of the volume."""
    found = np.zeros((13, 15, 11), np.uint8)
    places = np.indices(found.shape)
    for label, centre, radius in ((3, (3, 4, 5), 2.6), (7, (8, 9, 5), 3.6)):
        found[radius**2 > ((places.T - centre) ** 2).sum(axis=-1).T] = label
    found[:2, :2, :2] = 12
    return found


def written_nifti(path: Path, voxels: np.ndarray, kind: type = nibabel.Nifti1Image, unit: str = "mm") -> Path:
    image = kind(voxels, OBLIQUE)
    if hasattr(image.header, "set_xyzt_units"):
        image.header.set_xyzt_units(unit)
    nibabel.save(image, path)
    return path


def written_nrrd(path: Path, voxels: np.ndarray, **more: object) -> Path:
    space = {"space": "left-posterior-superior", "space directions": OBLIQUE[:3, :3].T}
    header = {**space, "space origin": OBLIQUE[:3, 3], **more}
    nrrd.write(str(path), voxels, header, detached_header=path.suffix == ".nhdr")
    return path


def metaimage(voxels: np.ndarray, packed: bool = False, big: bool = False, beside: str = "") -> bytes:
    data = voxels.astype(">u2" if big else "<u2").tobytes(order="F")
    turned = " ".join(map(repr, (OBLIQUE[:3, :3] / [0.5, 0.25, 2]).T.ravel().tolist()))
    lines = [
        "ObjectType = Image",
        "NDims = 3",
        "BinaryData = True",
        f"BinaryDataByteOrderMSB = {big}",
        f"CompressedData = {packed}",
        f"TransformMatrix = {turned}",
        f"Offset = {' '.join(map(repr, OBLIQUE[:3, 3].tolist()))}",
        "ElementSpacing = 0.5 0.25 2",
        f"DimSize = {' '.join(map(str, voxels.shape))}",
        "AnatomicalOrientation = RAI",
        "ElementType = MET_USHORT",
        f"ElementDataFile = {beside or 'LOCAL'}",
    ]
    header = "\n".join(lines).encode() + b"\n"
    return header + (b"" if beside else zlib.compress(data) if packed else data)


def written_stack(path: Path, voxels: np.ndarray, **more: object) -> Path:
    tifffile.imwrite(path, np.ascontiguousarray(voxels.T), **more)  # type: ignore[arg-type]
    return path
