"""How much memory a shape's eigenpairs need, and a refusal before the work where the machine has less."""

from __future__ import annotations

import math
import os
from contextlib import suppress
from functools import cache
from pathlib import Path

from idviewer.core.mesh import MeshError
from idviewer.core.shape import Shape

MODES = 170
"""What compact shapes need by the paper's rule; others need fewer."""

VECTORS_OF_A_MODE = 5.5
"""Long vectors held at once for each mode: three and a half of the basis, two copies of the eigenvector."""

SURFACE = 800.0
"""Bytes for each vertex of the surface itself, while it is read and looked at."""

OF_AN_ENTRY, OF_AN_ENTRY_MADE = 20.0, 92.0
"""Bytes for each entry of the factor: while it is used, and while it is made."""

LIMITS = (
    Path("/sys/fs/cgroup/memory.max"),
    Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
)
"""Where Linux tells what a container may have."""


def needed_bytes(vertices: int) -> float:
    """About how many bytes it takes to open a mesh of so many vertices, at most at one time.

    The factor's entries for each vertex grow by five with each doubling, as nested dissection has it (George
    1973: n log n). Measured from 27,000 to 540,000 vertices; see docs/eigenpairs.md.

    >>> round(needed_bytes(500_000) / 1e9, 1)
    4.8
    """
    entries = max(5.1 * math.log2(max(vertices, 1)) - 28.0, 10.0)
    made = OF_AN_ENTRY_MADE * entries
    used = OF_AN_ENTRY * entries + 8.0 * VECTORS_OF_A_MODE * MODES
    return vertices * (SURFACE + max(made, used))


def vertices_for(room: float) -> int:
    """The largest number of vertices, to two digits, that so many bytes suffice for.

    >>> needed_bytes(vertices_for(2e9)) < 2e9
    True
    """
    low, high = 1.0, max(room, 2.0)
    while high / low > 1.001:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if needed_bytes(round(middle)) <= room else (low, middle)
    step = 10 ** max(0, math.floor(math.log10(low)) - 1)
    return int(low // step * step)


@cache
def room_bytes() -> float:
    """The memory of this machine, or what a container may have of it; infinite where it cannot be told."""
    found = [math.inf]
    with suppress(AttributeError, OSError, ValueError):
        found.append(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    for path in LIMITS:
        try:
            found.append(int(path.read_text()))
        except (OSError, ValueError):  # "max", or no such thing
            continue
    return float(min(size for size in found if size > 0))


def check_room(shape: Shape, room: float | None = None) -> None:
    """Refuses a mesh whose eigenpairs do not fit into memory, in an instant.

    Args:
        shape: polygons are let through.
        room: bytes there are; this machine's by default.

    Raises:
        MeshError: it does not fit; the line says what it needs, what there is, and what would fit.

    >>> from idviewer.core import MeshError, read_mesh, sample_path
    >>> try:
    ...     check_room(read_mesh(sample_path("hand_2k")), room=9e6)
    ... except MeshError as error:
    ...     print(str(error)[:54])
    hand_2k has 2,500 vertices and would need about 22 MB;
    """
    count, room = len(shape.vertices), room_bytes() if room is None else room
    if shape.dimension == 2 or needed_bytes(count) <= room:
        return
    need = size(needed_bytes(count))
    raise MeshError(
        f"{shape.name or 'the mesh'} has {count:,} vertices and would need about {need}; "
        f"this machine has {size(room)}: simplify it to about {vertices_for(room):,} vertices"
    )


def size(count: float) -> str:
    """Bytes in words, two digits.

    >>> size(1.93e11), size(4.21e9), size(17e6)
    ('190 GB', '4.2 GB', '17 MB')
    """
    power = min(3, max(1, math.floor(math.log10(max(count, 1.0) * 1.005) / 3)))
    rounded = float(f"{count / 1e3**power:.2g}")
    name = ("KB", "MB", "GB")[power - 1]
    return f"{rounded:.0f} {name}" if rounded >= 10 else f"{rounded:g} {name}"
