"""The Laplacian of a mesh's intrinsic Delaunay triangulation, for triangles that spoil the cotangent one."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
import robust_laplacian
from scipy import sparse

from idviewer.core.arrays import Floats
from idviewer.core.shapes.mesh import Mesh, MeshError

LEAST_EXCESS = 1e-5
"""Every triangle inequality is to hold by so many mean edges: where need be, edges are made longer."""

_PAIRS_OF_MESHES: WeakKeyDictionary[Mesh, tuple[sparse.csc_array, Floats]] = WeakKeyDictionary()


def intrinsic_pair(mesh: Mesh) -> tuple[sparse.csc_array, Floats]:
    """Stiffness L (n, n) and masses (n,) of the intrinsic Delaunay triangulation on a mesh's vertices.

    Its edges are straight lines on the surface. No weight is negative, so functions obey the maximum
    principle. The masses are thirds of the intrinsic triangles. Kept as long as the mesh is. Source: Sharp
    and Crane 2020, "A Laplacian for nonmanifold triangle meshes".

    Args:
        mesh: n vertices.

    Raises:
        MeshError: the triangles are too thin for the triangulation to be found.

    >>> from idviewer.core import read_mesh, sample_path
    >>> mesh = read_mesh(sample_path("hand_2k"))
    >>> laplacian, masses = intrinsic_pair(mesh)
    >>> bool(abs(masses.sum() / mesh.area - 1.0) < 1e-9)
    True
    """
    if mesh not in _PAIRS_OF_MESHES:
        _PAIRS_OF_MESHES[mesh] = _intrinsic_pair(mesh)
    return _PAIRS_OF_MESHES[mesh]


def _intrinsic_pair(mesh: Mesh) -> tuple[sparse.csc_array, Floats]:
    # Lengths near one, as the library compares with numbers of its own.
    unit = (mesh.vertices - mesh.bounds.mean(axis=0)) / mesh.diagonal
    try:
        stiffness, mass = robust_laplacian.mesh_laplacian(unit, np.array(mesh.faces), LEAST_EXCESS)
    except RuntimeError as error:
        raise _unfit(mesh) from error
    laplacian, masses = sparse.csc_array(stiffness), mass.diagonal() * mesh.diagonal**2
    if not (np.isfinite(laplacian.data).all() and (masses > 0.0).all()):
        raise _unfit(mesh)
    return laplacian, masses


def _unfit(mesh: Mesh) -> MeshError:
    name = f"{mesh.name}: " if mesh.name else ""
    return MeshError(
        f"{name}the triangles are too thin for distances that need eigenpairs or a Laplacian; "
        "remesh the surface in a mesh editor such as MeshLab or Blender"
    )
