"""The smooth surface of a set of voxels: surface nets, cut into manifold sheets where voxels meet in an edge.

S. F. F. Gibson: Constrained Elastic Surface Nets, MICCAI 1998; smoothed by G. Taubin: A Signal Processing
Approach to Fair Surface Design, SIGGRAPH 1995.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.optimize
import scipy.sparse as sp

from idviewer.core.arrays import Bools, Floats, Ints
from idviewer.core.shapes.voxel_net import VoxelNet, voxel_net
from idviewer.core.validation.soup_repairs import volume_and_area


@dataclass(frozen=True)
class SmoothingSettings:
    """Settings by which the steps of voxels are smoothed.

    Attributes:
        rounds: of smoothing, each of which shrinks the surface and swells it again.
        shrink: share of the way to the neighbours' mean.
        swell: likewise, away from it.
        volume_tolerance: in voxels, how well the step along the normals is found that gives back the volume.
    """

    rounds: int = 30
    shrink: float = 0.5
    swell: float = -0.53
    volume_tolerance: float = 1e-4


SMOOTHING = SmoothingSettings()


@dataclass(frozen=True)
class VoxelSurface:
    """A closed surface, wound outward, in a lattice in which voxel (i, j, k) is the cube from there to +1.

    Attributes:
        vertices: (n, 3) points.
        faces: (m, 3) vertex numbers.
        displacement: in voxels, by how much a vertex was moved at most.
    """

    vertices: Floats
    faces: Ints
    displacement: float


def voxel_surface(voxels: Bools, sides: Floats | None = None) -> VoxelSurface:
    """Find the smooth surface of voxels. Where they meet in an edge or a corner alone, it parts them.

    Args:
        voxels: (p, q, r), True inside; the outermost ones may be.
        sides: (3,) of a voxel, for the cut of quads along their shorter diagonal; all the same by default.

    >>> surface = voxel_surface(np.ones((2, 2, 2), bool))
    >>> len(surface.vertices), len(surface.faces), surface.displacement < 1
    (26, 48, True)
    """
    if not voxels.any():
        return VoxelSurface(np.empty((0, 3)), np.empty((0, 3), np.int64), 0.0)
    net = voxel_net(np.pad(voxels, 1))
    smooth = _smoothed(net)
    faces = _triangles(net.quads, smooth * (1.0 if sides is None else sides))
    smooth = _with_volume(net, smooth, faces, float(np.count_nonzero(voxels)))
    moved = float(np.linalg.norm(smooth - net.places, axis=1).max())
    return VoxelSurface(smooth - 1.0, faces, moved)


def _smoothed(net: VoxelNet) -> Floats:
    """The vertices with steps smoothed away, within their bounds."""
    quads = net.quads
    starts, stops = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    edges = starts != stops
    # A closed surface runs along each edge in either direction.
    weights = sp.coo_array(
        (np.ones(int(edges.sum())), (starts[edges], stops[edges])), shape=(len(net.places),) * 2
    ).tocsr()
    degrees = np.asarray(weights.sum(axis=1))[:, None]
    low, high = net.places + net.low, net.places + net.high
    smooth = net.places
    for _ in range(SMOOTHING.rounds):
        for share in (SMOOTHING.shrink, SMOOTHING.swell):
            smooth = np.clip(smooth + share * (weights @ smooth / degrees - smooth), low, high)
    return smooth


def _triangles(quads: Ints, vertices: Floats) -> Ints:
    """Triangles (t, 3) of quads, each cut along its shorter diagonal."""
    a, b, c, d = quads.T
    one, other = (np.linalg.norm(vertices[i] - vertices[j], axis=1) for i, j in ((a, c), (b, d)))
    across = (one > other) & (c != d)
    first = np.where(across, [a, b, d], [a, b, c]).T
    second = np.where(across, [b, c, d], [a, c, d]).T
    return np.ascontiguousarray(np.concatenate([first, second[c != d]]))


def _with_volume(net: VoxelNet, smooth: Floats, faces: Ints, volume: float) -> Floats:
    """The vertices moved along their normals until they enclose a volume, within their bounds."""
    a, b, c = smooth[faces].transpose(1, 0, 2)
    normals = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    sums = np.stack([np.bincount(faces.ravel(), part, len(smooth)) for part in normals.T], axis=1)
    lengths = np.linalg.norm(sums, axis=1)[:, None]
    directions = sums / np.maximum(lengths, np.finfo(np.float64).tiny)
    low, high = net.places + net.low, net.places + net.high

    def swollen(step: float) -> Floats:
        return np.clip(smooth + step * directions, low, high)

    def excess(step: float) -> float:
        return volume_and_area(swollen(step), faces)[0] - volume

    if excess(-1.0) < 0.0 < excess(1.0):
        return swollen(scipy.optimize.brentq(excess, -1.0, 1.0, xtol=SMOOTHING.volume_tolerance))
    return smooth
