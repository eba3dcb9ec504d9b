"""Volumes of labels: voxels, where they lie in space, and the surface of one label."""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import scipy.ndimage
from numpy.typing import NDArray

from idviewer.core.arrays import Bools, Floats
from idviewer.core.errors import Part
from idviewer.core.io.contents import Contents, FileSource, PartError
from idviewer.core.io.memory_bound import MemoryBound
from idviewer.core.io.text import UnreadableError
from idviewer.core.shapes.voxel_surface import voxel_surface
from idviewer.core.validation.polygon_soup import PolygonSoup
from idviewer.core.validation.soup_repairs import volume_and_area


@dataclass(frozen=True)
class VolumeSettings:
    """Settings of what may be a volume of labels.

    Attributes:
        bound: of what is unpacked; deflate packs a byte into a thousandth of one, and labels come near that.
        most_bytes: of unpacked voxels.
        most_labels: a volume with more different numbers holds intensities.
        few_labels: above so many, a message also says how to choose a threshold.
        largest_label: a volume with larger numbers holds no labels.
    """

    bound: MemoryBound = field(default_factory=lambda: MemoryBound(times=1100))
    most_bytes: int = 2 << 30
    most_labels: int = 1000
    few_labels: int = 50
    largest_label: int = 1 << 20


UNKNOWN_SIZE = "The file does not tell the size of its voxels; coordinates are in voxels."
NO_UNIT = "The file names no unit of length; millimetres were taken."
VOLUMES = VolumeSettings()
_THRESHOLD = re.compile(r"\s*(<=|>=|<|>)\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*$")
_COMPARISONS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal}


@dataclass(frozen=True)
class Volume:
    """Voxels of a file.

    Attributes:
        voxels: as the file's arrays are indexed: (p, q, r).
        affine: (4, 4), from indices of voxels, whole at their middles, to coordinates.
        unit: of the coordinates.
        axes: which way they run, such as "RAS" (to the right, the front and above); may be empty.
        names: of labels, where the file has some.
        notes: one sentence each.
    """

    voxels: NDArray[Any]
    affine: Floats
    unit: str
    axes: str = ""
    names: dict[int, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def voxel_size(self) -> Floats:
        """Sides (3,) of a voxel."""
        return np.linalg.norm(self.affine[:3, :3], axis=0)


def label_contents(volume: Volume, source: FileSource) -> Contents[PolygonSoup]:
    """The surface of the one label in a volume, or of the chosen one, or of what passes a threshold.

    Args:
        volume: of the file.
        source: the file, with the label's number or name, or a threshold such as ">100".

    Raises:
        PartError: there are several labels and none is chosen, none of that name, or intensities instead.
        UnreadableError: the volume has not three sides, or its voxels no size.
    """
    voxels = _in_space(volume.voxels)
    if not np.isfinite(volume.affine).all() or abs(np.linalg.det(volume.affine[:3, :3])) == 0.0:
        raise UnreadableError("its voxels have no size")
    title, chosen = _chosen_voxels(volume, voxels, source)
    box = scipy.ndimage.find_objects(chosen.view(np.uint8))
    if not box:
        raise PartError(f"it has no {title}; choose another threshold")
    soup, told = _surface(chosen[box[0]], np.array([side.start for side in box[0]]), volume.affine)
    sides = " x ".join(f"{side:.4g}" for side in volume.voxel_size)
    axes = f", axes {volume.axes}" if volume.axes else ""
    first = (
        f"{title[:1].upper()}{title[1:]}: {np.count_nonzero(chosen):,} voxels of {sides} {volume.unit}{axes}"
    )
    return Contents(soup, (f"{first}; {told}.", *volume.notes), volume.unit)


def _in_space(voxels: NDArray[Any]) -> NDArray[Any]:
    """The voxels as an array of three dimensions: further ones may have one entry."""
    if voxels.dtype.names or voxels.dtype.kind not in "biuf":
        raise UnreadableError("its voxels are colours or complex numbers, and no labels")
    while voxels.ndim > 3 and voxels.shape[-1] == 1:
        voxels = voxels[..., 0]
    if voxels.ndim != 3 or 0 in voxels.shape:
        sizes = " x ".join(map(str, voxels.shape))
        raise UnreadableError(
            f"its voxels are {sizes or 'one number'}, and a volume of labels has three sides"
        )
    return voxels


def _chosen_voxels(volume: Volume, voxels: NDArray[Any], source: FileSource) -> tuple[str, Bools]:
    """The chosen voxels, and what they are in words."""
    if source.part is not None and (threshold := _THRESHOLD.match(source.part)):
        with np.errstate(invalid="ignore"):
            return f"voxel {threshold[1]} {threshold[2]}", _COMPARISONS[threshold[1]](
                voxels, float(threshold[2])
            )
    counts = label_counts(voxels)
    if not counts:
        raise PartError("it holds no label: all of its voxels are 0")
    size = float(abs(np.linalg.det(volume.affine[:3, :3])))
    unit = "voxels" if volume.unit == "voxel" else f"{volume.unit}^3"
    named = {label: f"{volume.names[label]}, " if label in volume.names else "" for label in counts}
    parts = [Part(str(label), f"{named[label]}{_size(n * size)} {unit}") for label, n in counts.items()]
    hint = "; a threshold, such as part='>100', is taken too" if len(parts) > VOLUMES.few_labels else ""
    names = [[volume.names[label]] if label in volume.names else [] for label in counts]
    number = source.chosen(parts, "labels", names, by_place=False, hint=hint)
    assert number is not None
    label = list(counts)[number]
    name = f" ({volume.names[label]})" if label in volume.names else ""
    return f"label {label}{name}", voxels == label


def _size(volume: float) -> str:
    """A volume in four digits, with marks for thousands: 23,970."""
    return f"{float(f'{volume:.4g}'):,.10g}"


def label_counts(voxels: NDArray[Any]) -> dict[int, int]:
    """Count the voxels of each label, in ascending order; 0 is the background.

    Args:
        voxels: (p, q, r).

    Raises:
        PartError: they are no labels but intensities.

    >>> label_counts(np.array([[[0, 3, 3, 1]]]))
    {1: 1, 3: 2}
    """
    counts = np.zeros(1, np.int64)
    for layer in voxels:
        numbers = layer.ravel()
        if not len(numbers):
            continue
        low, high = numbers.min(), numbers.max()
        whole = numbers.dtype.kind != "f" or bool((numbers == np.floor(numbers)).all())
        if not (whole and low >= 0 and high <= VOLUMES.largest_label):
            wrong = "below 0" if low < 0 else "not whole" if not whole else f"as large as {high:.6g}"
            raise PartError(f"it holds intensities, not labels: some are {wrong}; {_THRESHOLD_HINT}")
        here = np.bincount(numbers.astype(np.int64))
        longer, shorter = (here, counts) if len(here) > len(counts) else (counts, here)
        counts = longer.copy()
        counts[: len(shorter)] += shorter
    found = np.flatnonzero(counts)
    if len(found) > VOLUMES.most_labels:
        raise PartError(
            f"it holds {len(found):,} different numbers, intensities and not labels; {_THRESHOLD_HINT}"
        )
    return {int(label): int(counts[label]) for label in found if label}


_THRESHOLD_HINT = "choose what is inside by a threshold, such as part='>100'"


def _surface(chosen: Bools, corner: NDArray[Any], affine: Floats) -> tuple[PolygonSoup, str]:
    """The surface of voxels in space, and what was smoothed, in words."""
    surface = voxel_surface(chosen, np.linalg.norm(affine[:3, :3], axis=0))
    # A voxel's middle has whole indices, and half ones in the surface's lattice.
    vertices = (surface.vertices + corner - 0.5) @ affine[:3, :3].T + affine[:3, 3]
    turned = np.linalg.det(affine[:3, :3]) < 0.0
    triangles = np.ascontiguousarray(surface.faces[:, ::-1]) if turned else surface.faces
    volume = np.count_nonzero(chosen) * abs(np.linalg.det(affine[:3, :3]))
    change = abs(volume_and_area(vertices, triangles)[0] / volume - 1.0)
    told = (
        f"its surface was smoothed, vertices moved by at most {surface.displacement:.2g} voxels, "
        f"volume changed by {100.0 * change:.1g} %"
    )
    return PolygonSoup.of(vertices, triangles), told


def checked_size(shape: tuple[int, ...], item: int, there: int) -> int:
    """Bytes of the voxels that a header announces.

    Args:
        shape: announced.
        item: bytes of a voxel.
        there: bytes in the file, as far as they are known; -1 while they are packed.

    Raises:
        UnreadableError: there are fewer, or too many.

    >>> checked_size((2, 3, 4), 2, 48)
    48
    """
    if not shape or min(shape) < 1:
        raise UnreadableError(f"it announces {' x '.join(map(str, shape)) or 'no'} voxels")
    needed = item
    for side in shape:
        needed *= int(side)
    if 0 <= there < needed:
        raise UnreadableError(f"truncated: it announces {needed:,} bytes of voxels and holds {there:,}")
    if needed > VOLUMES.most_bytes:
        raise UnreadableError(
            f"it announces {needed:,} bytes of voxels, more than the {VOLUMES.most_bytes:,} allowed"
        )
    return needed


def unpacked(data: bytes, most: int | None = None) -> bytes:
    """Unpack what gzip or zlib has packed.

    Args:
        data: all of it.
        most: bytes that are wanted; what follows is left.

    Raises:
        UnreadableError: it is damaged or cut, or unpacks to more than the settings' bound.

    >>> import gzip
    >>> unpacked(gzip.compress(b"abc") + gzip.compress(b"de"))
    b'abcde'
    """
    bound = min(VOLUMES.bound.of(len(data)), VOLUMES.most_bytes + (1 << 20))
    pieces: list[bytes] = []
    total, rest = 0, data
    while rest and (most is None or total < most):
        packed = zlib.decompressobj(wbits=47)
        try:
            while not packed.eof and rest:
                piece = packed.decompress(rest, 1 << 22)
                pieces.append(piece)
                total += len(piece)
                rest = packed.unconsumed_tail
                if total > bound:
                    raise UnreadableError(f"it unpacks to over {bound:,} bytes, more than is allowed")
                if most is not None and total >= most:
                    return b"".join(pieces)[:most]
        except zlib.error as error:
            raise UnreadableError(f"truncated or damaged: it cannot be unpacked ({error})") from None
        if not packed.eof:
            raise UnreadableError("truncated: what is packed in it breaks off")
        rest = packed.unused_data.lstrip(b"\0")
    return b"".join(pieces)


def file_beside(path: Path, name: str) -> bytes:
    """Bytes of a file in the same folder as another.

    Args:
        path: of the other.
        name: of the file, which may lead nowhere else.

    Raises:
        UnreadableError: it would, or cannot be read.

    >>> file_beside(Path("a.mhd"), "../b.raw")
    Traceback (most recent call last):
    idviewer.core.io.text.UnreadableError: its voxels are in '../b.raw'; only files beside it are opened
    """
    if name in ("", ".", "..") or re.search(r"[/\\:\0]", name):
        raise UnreadableError(f"its voxels are in {name[:60]!a}; only files beside it are opened")
    beside = path.parent / name
    try:
        if beside.is_symlink() or not beside.is_file():
            raise UnreadableError(f"its voxels are in {name[:60]!a}, and there is no such file beside it")
        return beside.read_bytes()
    except OSError as error:
        raise UnreadableError(f"{name[:60]!a} beside it cannot be read ({error.strerror})") from error
