"""Memory estimate of the work on a shape, and a refusal before it where the machine has less."""

from __future__ import annotations

import math
import os
from contextlib import suppress
from functools import cache
from pathlib import Path

from idviewer.core.memory import bytes_in_words
from idviewer.core.shapes.mesh import MeshError
from idviewer.core.shapes.shape import Shape

BYTES_PER_VERTEX = 10.6e3
"""Bytes for each vertex of a compact shape, which has 170 to 180 modes; others need less."""

BYTES_PER_VERTEX_OF_SMALL = 19.8e3
SMALL_VERTICES = 117_000
"""On shapes of up to so many vertices, slices have two trees instead of one, and need so much."""

CONTAINER_LIMIT_FILES = (
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)
"""Where Linux tells what a container may have."""


def needed_bytes(vertices: int) -> float:
    """About how many bytes it takes to open a mesh of so many vertices, at most at one time.

    Measured from 27,000 to 540,000 vertices, from reading to slices; see docs/decisions.md.

    >>> round(needed_bytes(500_000) / 1e9, 1)
    5.3
    """
    return max(BYTES_PER_VERTEX * vertices, BYTES_PER_VERTEX_OF_SMALL * min(vertices, SMALL_VERTICES))


def vertices_for(available: float) -> int:
    """The largest number of vertices, to two digits, that so many bytes suffice for.

    >>> needed_bytes(vertices_for(2e9)) < 2e9
    True
    """
    low, high = 1.0, max(available, 2.0)
    while high / low > 1.001:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if needed_bytes(round(middle)) <= available else (low, middle)
    step = 10 ** max(0, math.floor(math.log10(low)) - 1)
    return int(low // step * step)


@cache
def available_bytes(limit_files: tuple[Path, ...] = CONTAINER_LIMIT_FILES) -> float:
    """The memory of this machine, or what a container may have of it; infinite where it cannot be told."""
    found = [math.inf]
    with suppress(AttributeError, OSError, ValueError):
        found.append(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    for path in limit_files:
        try:
            found.append(int(path.read_text()))
        except (OSError, ValueError):  # "max", or no such thing
            continue
    return float(min(size for size in found if size > 0))


def check_memory(shape: Shape, available: float | None = None) -> None:
    """Refuse a mesh that does not fit into memory with its eigenpairs and samples, in an instant.

    Args:
        shape: polygons are let through.
        available: bytes there are; this machine's by default.

    Raises:
        MeshError: it does not fit; the line says what it needs, what there is, and what would fit.

    >>> from idviewer.core import MeshError, read_mesh, sample_path
    >>> try:
    ...     check_memory(read_mesh(sample_path("hand_2k")), available=9e6)
    ... except MeshError as error:
    ...     print(str(error)[:54])
    hand_2k has 2,500 vertices and would need about 50 MB;
    """
    count = len(shape.vertices)
    available = available_bytes() if available is None else available
    if shape.dimension == 2 or needed_bytes(count) <= available:
        return
    need, fitting = bytes_in_words(needed_bytes(count)), vertices_for(available)
    raise MeshError(
        f"{shape.name or 'the mesh'} has {count:,} vertices and would need about {need}; "
        f"this machine has {bytes_in_words(available)}: simplify it to about {fitting:,} vertices"
    )
