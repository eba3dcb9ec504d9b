"""A human of 1.75 m: a skeleton, its poses, and the parts that it carries.

Parts are drawn in a neutral stance (arms and legs straight down, facing -y, the body's left at +x) and are
carried by the bones. A bone's pose is a rotation vector in degrees at its joint, about the neutral axes:
a positive x swings a hanging limb back and leans the trunk forward, a negative y lifts a left limb sideways,
a positive z turns to the left.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from bodies import hand_parts
from field import Array, Body, Part, ellipsoid, sweep, unite
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

Vector = tuple[float, float, float]
Pose = dict[str, Vector]
Strand = list[tuple[str, Vector, tuple[float, ...]]]  # bone, point, half axes
Ball = tuple[str, Vector, Vector, float]  # bone, centre, half axes, blend

# fmt: off
MIDDLE_JOINTS = {
    "pelvis": ("", (0, 0, 0.95)), "spine": ("pelvis", (0, 0.02, 1.05)), "chest": ("spine", (0, 0.025, 1.20)),
    "neck": ("chest", (0, 0.02, 1.46)), "head": ("neck", (0, 0.005, 1.55)),
}
LEFT_JOINTS = {
    "thigh": ("pelvis", (0.088, 0.0, 0.92)), "shin": ("thigh", (0.098, -0.005, 0.49)),
    "foot": ("shin", (0.104, 0.025, 0.075)),
    "shoulder": ("chest", (0.03, 0.0, 1.42)), "arm": ("shoulder", (0.178, 0.015, 1.405)),
    "forearm": ("arm", (0.192, 0.02, 1.115)), "hand": ("forearm", (0.196, 0.005, 0.865)),
}
STANDING: Pose = {
    "arm+": (0, -17, 0), "arm-": (0, 17, 0), "forearm+": (-14, 4, 0), "forearm-": (-14, -4, 0),
    "thigh+": (0, -3.5, 0), "thigh-": (0, 3.5, 0), "foot+": (0, 3.5, 9), "foot-": (0, -3.5, -9),
}
WALKING: Pose = {
    "pelvis": (0, 0, 6), "chest": (3, 0, -13), "head": (0, 0, 7),
    "thigh+": (-27, 0, -4), "shin+": (9, 0, 0), "foot+": (6, 0, 4),
    "thigh-": (14, 0, -4), "shin-": (26, 0, 0), "foot-": (-12, 0, -4),
    "arm+": (24, -14, 0), "forearm+": (-24, 4, 0), "arm-": (-24, 14, 0), "forearm-": (-38, -4, 0),
}
SITTING: Pose = {
    "spine": (4, 0, 0), "chest": (4, 0, 0), "neck": (4, 0, 0),
    "thigh+": (-80, 0, 9), "shin+": (74, 0, 0), "foot+": (6, 0, 4),
    "thigh-": (-80, 0, -9), "shin-": (74, 0, 0), "foot-": (6, 0, -4),
    "arm+": (-24, -13, 0), "forearm+": (-56, 0, -36), "hand+": (12, 0, -28),
    "arm-": (-24, 13, 0), "forearm-": (-56, 0, 36), "hand-": (12, 0, 28),
}
POSES = {"standing": STANDING, "walking": WALKING, "sitting": SITTING}

TORSO: Strand = [
    ("pelvis", (0, 0.012, 0.89), (0.120, 0.090, 0.07)), ("pelvis", (0, 0.012, 0.96), (0.152, 0.106, 0.07)),
    ("spine", (0, 0.004, 1.05), (0.138, 0.096, 0.07)), ("spine", (0, -0.002, 1.13), (0.131, 0.095, 0.07)),
    ("chest", (0, 0.0, 1.22), (0.143, 0.104, 0.07)), ("chest", (0, 0.006, 1.31), (0.157, 0.112, 0.07)),
    ("chest", (0, 0.014, 1.38), (0.142, 0.090, 0.07)), ("chest", (0, 0.02, 1.43), (0.085, 0.060, 0.05)),
]
NECK: Strand = [
    ("chest", (0, 0.03, 1.41), (0.052, 0.055)), ("neck", (0, 0.018, 1.49), (0.050, 0.054)),
    ("head", (0, 0.008, 1.59), (0.050, 0.056)),
]
NOSE: Strand = [
    ("head", (0, -0.078, 1.645), (0.008, 0.012)), ("head", (0, -0.087, 1.624), (0.009, 0.012)),
    ("head", (0, -0.094, 1.606), (0.013, 0.012)),
]
# for each side, drawn for the left one
TRAPEZIUS: Strand = [
    ("neck", (0.016, 0.035, 1.495), (0.024, 0.024)), ("shoulder", (0.07, 0.028, 1.432), (0.028, 0.030)),
    ("shoulder", (0.13, 0.018, 1.412), (0.036, 0.036)), ("shoulder", (0.17, 0.014, 1.395), (0.040, 0.042)),
]
LATISSIMUS: Strand = [
    ("chest", (0.085, 0.025, 1.12), (0.03, 0.05)), ("chest", (0.112, 0.028, 1.24), (0.042, 0.065)),
    ("shoulder", (0.135, 0.025, 1.35), (0.04, 0.055)),
]
THIGH: Strand = [
    ("thigh", (0.080, 0.01, 0.93), (0.070, 0.085)), ("thigh", (0.087, 0.003, 0.86), (0.086, 0.095)),
    ("thigh", (0.092, -0.002, 0.76), (0.080, 0.088)), ("thigh", (0.096, -0.008, 0.64), (0.065, 0.072)),
    ("thigh", (0.097, -0.008, 0.54), (0.053, 0.058)), ("thigh", (0.098, -0.006, 0.48), (0.043, 0.045)),
]
SHIN: Strand = [
    ("shin", (0.098, -0.002, 0.50), (0.043, 0.045)), ("shin", (0.100, 0.004, 0.44), (0.049, 0.052)),
    ("shin", (0.103, 0.016, 0.35), (0.052, 0.057)), ("shin", (0.104, 0.021, 0.23), (0.039, 0.043)),
    ("shin", (0.104, 0.025, 0.12), (0.030, 0.035)), ("foot", (0.104, 0.028, 0.06), (0.031, 0.036)),
]
FOOT: Strand = [
    ("foot", (0.102, 0.050, 0.035), (0.031, 0.034)), ("foot", (0.106, -0.02, 0.034), (0.033, 0.033)),
    ("foot", (0.110, -0.09, 0.028), (0.042, 0.027)), ("foot", (0.108, -0.15, 0.021), (0.040, 0.020, 0.038)),
]
INSTEP: Strand = [
    ("foot", (0.104, 0.018, 0.095), (0.028, 0.03)), ("foot", (0.106, -0.03, 0.062), (0.028, 0.027)),
    ("foot", (0.107, -0.095, 0.034), (0.026, 0.02)),
]
ARM: Strand = [
    ("arm", (0.165, 0.012, 1.382), (0.046, 0.050)), ("arm", (0.181, 0.012, 1.30), (0.046, 0.051)),
    ("arm", (0.189, 0.016, 1.20), (0.040, 0.043)), ("forearm", (0.192, 0.018, 1.085), (0.027, 0.028)),
]
FOREARM: Strand = [
    ("arm", (0.191, 0.018, 1.145), (0.026, 0.027)), ("forearm", (0.193, 0.012, 1.06), (0.038, 0.042)),
    ("forearm", (0.195, 0.007, 0.96), (0.030, 0.036)), ("forearm", (0.196, 0.004, 0.885), (0.021, 0.029)),
    ("hand", (0.196, 0.004, 0.84), (0.018, 0.030)),
]
WRIST = (0.196, 0.004, 0.862)
HEAD: list[Ball] = [
    ("head", (0, 0.012, 1.658), (0.078, 0.094, 0.092), 0.04),
    ("head", (0, -0.020, 1.612), (0.064, 0.070, 0.092), 0.05),
    ("head", (0, -0.056, 1.556), (0.034, 0.034, 0.026), 0.05),
    ("head", (0, -0.072, 1.652), (0.048, 0.016, 0.012), 0.04),
]
BALLS: list[Ball] = [  # cheek, ear, buttock, breast
    ("head", (0.034, -0.056, 1.600), (0.022, 0.018, 0.020), 0.05),
    ("head", (0.077, 0.014, 1.620), (0.010, 0.019, 0.031), 0.012),
    ("pelvis", (0.068, 0.050, 0.91), (0.078, 0.076, 0.085), 0.08),
    ("chest", (0.066, -0.050, 1.325), (0.075, 0.050, 0.060), 0.07),
]
# fmt: on
LIMBS = (
    (THIGH, 0.05, "leg"),
    (SHIN, 0.07, "leg"),
    (FOOT, 0.03, "leg"),
    (INSTEP, 0.03, "leg"),
    (ARM, 0.05, "arm"),
    (FOREARM, 0.04, "arm"),
)
GROUP_BLEND = {"leg": 0.08, "arm": 0.05, "hand": 0.02}


def joints() -> dict[str, tuple[str, Array]]:
    """Each bone's parent and joint, parents first; "arm+" is the left one, "arm-" the right one."""
    found = {name: (parent, np.array(at, dtype=float)) for name, (parent, at) in MIDDLE_JOINTS.items()}
    for sign in "+-":
        for name, (parent, at) in LEFT_JOINTS.items():
            found[name + sign] = (parent if parent in MIDDLE_JOINTS else parent + sign, at * mirror(sign))
    return found


def mirror(sign: str) -> Array:
    """Factors that take the left side to the side of the sign."""
    return np.array([-1.0 if sign == "-" else 1.0, 1.0, 1.0])


def between(one: Pose, other: Pose, share: float) -> Pose:
    """The pose at `share` of the way."""
    rest = (0.0, 0.0, 0.0)
    names = dict.fromkeys([*one, *other])
    ends = {name: (np.array(one.get(name, rest)), np.array(other.get(name, rest))) for name in names}
    return {name: tuple(((1 - share) * a + share * b).tolist()) for name, (a, b) in ends.items()}


@dataclass(frozen=True)
class Skeleton:
    """World transforms (rotation (3, 3), shift (3,)) of the bones: neutral point -> posed point."""

    bones: dict[str, tuple[Array, Array]]

    @classmethod
    def posed(cls, pose: Pose) -> Skeleton:
        bones: dict[str, tuple[Array, Array]] = {}
        for name, (parent, at) in joints().items():
            own = Rotation.from_rotvec(pose.get(name, (0, 0, 0)), degrees=True).as_matrix()
            turn, shift = bones[parent] if parent else (np.eye(3), np.zeros(3))
            bones[name] = (turn @ own, turn @ (at - own @ at) + shift)
        return cls(bones)

    def bone(self, name: str, sign: str) -> tuple[Array, Array]:
        return self.bones[name + sign if name in LEFT_JOINTS else name]

    def place(self, name: str, sign: str, point: ArrayLike) -> Array:
        turn, shift = self.bone(name, sign)
        return turn @ (np.asarray(point) * mirror(sign)) + shift


def body(pose: Pose) -> Body:
    """The human as a field."""
    blends = {group + sign: blend for group, blend in GROUP_BLEND.items() for sign in "+-"}
    return unite(list(parts(Skeleton.posed(pose))), **blends)


def parts(skeleton: Skeleton) -> Iterator[Part]:
    yield strand(skeleton, TORSO, "", 0.05, "torso")
    yield strand(skeleton, NECK, "", 0.06, "torso")
    for sign in "+-":
        yield strand(skeleton, TRAPEZIUS, sign, 0.07, "torso")
        yield strand(skeleton, LATISSIMUS, sign, 0.07, "torso")
    yield from (ball(skeleton, part, "") for part in HEAD)
    yield strand(skeleton, NOSE, "", 0.022, "torso")
    yield from (ball(skeleton, part, sign) for sign in "+-" for part in BALLS)
    for sign in "+-":
        yield from (strand(skeleton, knots, sign, blend, group + sign) for knots, blend, group in LIMBS)
        yield from carried_hand(skeleton, sign)


def strand(skeleton: Skeleton, knots: Strand, sign: str, blend: float, group: str) -> Part:
    points = [skeleton.place(bone, sign, at) for bone, at, _ in knots]
    sides = [skeleton.bone(bone, sign)[0][:, 0] for bone, _, _ in knots]
    return sweep(points, [radii for _, _, radii in knots], sides, blend, group)


def ball(skeleton: Skeleton, part: Ball, sign: str) -> Part:
    bone, centre, radii, blend = part
    return ellipsoid(
        skeleton.place(bone, sign, centre), radii, blend, "torso", axes=skeleton.bone(bone, sign)[0].T
    )


def carried_hand(skeleton: Skeleton, sign: str) -> Iterator[Part]:
    """A hand at the end of the arm: fingers down, thumb to the front, palm to the body."""
    flip = np.array([[0, -1, 0], [1, 0, 0], [0, 0, -1]])
    metres, (turn, shift) = 0.01, skeleton.bone("hand", sign)
    for part in hand_parts("hand" + sign, web=0.9, curl=1.6, spread=1.5, slim=0.92):
        # the hand is drawn as a right one, and this frame is the left side's
        centres = (metres * part.centres @ flip + WRIST) * mirror(sign)
        frames = part.frames @ flip * mirror(sign)
        yield Part(
            centres @ turn.T + shift, metres * part.radii, frames @ turn.T, metres * part.blend, part.group
        )
