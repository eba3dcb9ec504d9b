"""Whole files of volumes of labels, one of each format."""

from __future__ import annotations

import tempfile
from pathlib import Path

import nibabel
import numpy as np
from tests.core import volumefiles


def volume_seeds() -> dict[str, list[bytes]]:
    """Files by their suffix, those of one format under one suffix."""
    voxels = (volumefiles.labels() == 3).astype(np.uint8)[:8, :9, :9]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = [
            volumefiles.written_nifti(folder / "a.nii", voxels),
            volumefiles.written_nifti(folder / "a.nii.gz", voxels),
            volumefiles.written_nifti(folder / "a.mgz", voxels, nibabel.MGHImage),
            volumefiles.written_nrrd(folder / "a.nrrd", voxels),
            volumefiles.written_stack(folder / "a.tif", voxels),
        ]
        np.save(folder / "a.npy", voxels)
        files.append(folder / "a.npy")
        made = {"".join(path.suffixes): [path.read_bytes()] for path in files}
    made[".mha"] = [volumefiles.metaimage(voxels), volumefiles.metaimage(voxels, packed=True)]
    return made
