"""Make the bundled shapes: `python assets/make_shapes.py [FOLDER]` writes to FOLDER or beside this script.

Needs the package with its extra `shapes`. Running it again gives the same bytes (same machine and versions).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import human
import numpy as np
from bodies import cat, couple, hand, octopus
from contour import Faces, contour, euler, is_closed_manifold, simplify, volume
from field import Array, Body
from posing import carry
from remesh import even_out

COUNTS = {"_2k": 2500, "": 7000, "_27k": 27000}  # vertices by the ending of the name
POSED = ("_2k", "")  # the sizes that are made in every pose
ROUNDS, POSE_ROUNDS, POSE_STEPS = 12, 10, 12


@dataclass(frozen=True)
class Shape:
    """A body, its Euler characteristic, step of the grid and range of its field, and metres in its unit."""

    body: Callable[[], Body]
    euler: int
    step: float
    far: float
    endings: tuple[str, ...] = ("_2k", "")
    metres: float = 1.0


SHAPES = {
    "hand": Shape(hand, 2, 0.1, 4.0, ("_2k", "", "_27k"), 0.01),
    "human": Shape(lambda: human.body(human.STANDING), 2, 0.0035, 0.2, ("_2k", "", "_27k")),
    "octopus": Shape(octopus, 2, 0.0025, 0.1, ("_2k", "", "_27k")),
    "cat": Shape(cat, 2, 0.003, 0.1),
    "couple": Shape(couple, -4, 0.003, 0.12),
}


def main(folder: Path) -> None:
    started, total = time.perf_counter(), 0
    for name, shape in SHAPES.items():
        for stem, (points, faces) in meshes(name, shape).items():
            points = grounded(points * shape.metres)
            check(stem, points, faces, shape.euler)
            total += write_ply(folder / f"{stem}.ply", points, faces)
            seconds = time.perf_counter() - started
            print(f"{stem:18s} {len(points):6d} vertices {len(faces):6d} triangles  {seconds:5.0f} s")
    print(f"{total} bytes in all")


def meshes(name: str, shape: Shape) -> dict[str, tuple[Array, Faces]]:
    """Every size and pose of a shape, by the file's stem."""
    body, made = shape.body(), {}
    fine, triangles = contour(body, shape.step, shape.far)
    for ending in shape.endings:
        points, faces = simplify(fine, triangles, COUNTS[ending])
        (points,), faces = even_out([body], [points], faces, shape.far, ROUNDS)
        if name == "human" and ending in POSED:
            poses, faces = posed(points, faces, shape.far)
            made.update(
                {pose_stem(pose) + ending: (at, faces) for pose, at in zip(human.POSES, poses, strict=True)}
            )
        else:
            made[name + ending] = (points, faces)
    return made


def pose_stem(pose: str) -> str:
    return "human" if pose == "standing" else f"human_{pose}"


def posed(points: Array, faces: Faces, far: float) -> tuple[list[Array], Faces]:
    """The human in each pose, the standing one first, with triangles that suit all of them."""
    poses = [points]
    for pose in list(human.POSES.values())[1:]:
        bodies = [
            human.body(human.between(human.STANDING, pose, i / POSE_STEPS)) for i in range(POSE_STEPS + 1)
        ]
        poses.append(carry(bodies, points, faces, far))
    return even_out([human.body(pose) for pose in human.POSES.values()], poses, faces, far, POSE_ROUNDS)


def grounded(points: Array) -> Array:
    """Single precision, standing on z = 0."""
    return (points - (0, 0, points[:, 2].min())).astype(np.float32)


def check(stem: str, points: Array, faces: Faces, chi: int) -> None:
    faults = {
        "not a closed manifold": not is_closed_manifold(points, faces),
        "wrong Euler characteristic": euler(points, faces) != chi,
        "duplicate vertices": len(np.unique(points, axis=0)) < len(points),
        "inside out": volume(points.astype(float), faces) <= 0,
    }
    found = [fault for fault, is_there in faults.items() if is_there]
    if found:
        raise RuntimeError(f"{stem}: {', '.join(found)}")


def write_ply(path: Path, points: Array, faces: Faces) -> int:
    """Binary PLY with 4-byte coordinates and 2-byte indices; returns its size in bytes.

    The indices are signed, since some readers (VCGlib's) know no unsigned ones of 2 bytes.
    """
    assert len(points) <= np.iinfo(np.int16).max
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        "comment made by assets/make_shapes.py of idviewer, MIT licence; metres, z up\n"
        f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar short vertex_indices\nend_header\n"
    )
    rows = np.zeros(len(faces), dtype=[("count", "u1"), ("indices", "<i2", 3)])
    rows["count"], rows["indices"] = 3, faces
    content = header.encode("ascii") + points.astype("<f4").tobytes() + rows.tobytes()
    path.write_bytes(content)
    return len(content)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
