"""Figures 12, 13 and 14: the potential U; the barycentroid under noise, deformation, pose, in a class."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.axes import Axes

from figures import flat, solid
from figures.bending import Floats, Map, bent, carried, diameter, one_after_another, ramp
from figures.boundaries import (
    DEFORMATIONS,
    DRAWS,
    FIGURE_POSES,
    NOISE,
    noise_title,
    noisy_blobs,
    posed,
    smooth_blob,
)
from figures.registry import Run, Table, figure
from figures.shapes import HANDS, body, in_pose, made_hand, moved, noisy_body, within_plane
from figures.words import percent
from idviewer.core import InteriorDistance, Mesh, Polygon, mean_value_weights, read_polygon, sample_path
from idviewer.session import Query

X, Y, Z = range(3)
REST = "one outline"
ROUGH = 0.003
"""Noise on bodies, as a share of the diagonal: some half an edge."""


@dataclass(frozen=True)
class Case:
    """A row of pictures of figure 12: titles, and for each what was done, in one draw or several.

    Attributes:
        rest: the outline to begin with.
        done: title, polygons, and the map that takes rest to them, if it is one.
    """

    rest: Polygon
    done: list[tuple[str, list[Polygon], Map | None]]


def cases(tiny: bool) -> list[Case]:
    """Noise, deformation, articulation."""
    smooth, draws = smooth_blob(), 1 if tiny else DRAWS
    noise = [(noise_title(share), [one for _, one in noisy_blobs(share, draws)], None) for share in NOISE]
    blob, ginger = read_polygon(sample_path("blob")), read_polygon(sample_path("gingerbread"))
    bends = [(name, [carried(blob, by)], by) for name, by in DEFORMATIONS.items() if name != REST]
    poses = [(name, [carried(ginger, posed(name))], posed(name)) for name in FIGURE_POSES if name != REST]
    few = 1 if tiny else None
    return [Case(smooth, noise[:few]), Case(blob, bends[:few]), Case(ginger, poses[:few])]


@figure("12", "U and the barycentroid in 2D")
def potential(run: Run) -> Table:
    """Isolines of U under noise, deformation and articulation, and where the barycentroid goes."""
    cells, titles, rows = [], [], []
    for case in cases(run.tiny):
        titles += [REST, *(name for name, _, _ in case.done)]
        drawn = [case.rest, *(polygons[0] for _, polygons, _ in case.done)]
        cells += [partial(show_potential, run=run, polygon=polygon) for polygon in drawn]
        rows += [[name, *moves(case.rest, polygons, by)] for name, polygons, by in case.done]
    flat.draw_rows(run, "12", titles, cells, len(cells) // 3)
    header = ("what was done", "barycentroid strays", "centre of area strays", "centre of area inside")
    note = (
        "As a share of the diameter, from where the same point would have gone with the deformation; "
        f"noise: means over {DRAWS} draws."
    )
    return Table(header, rows, note)


def moves(rest: Polygon, polygons: list[Polygon], by: Map | None) -> list[str]:
    """How far barycentroid and centre of area stray, and how often the latter lies inside."""
    size = diameter(rest.vertices)
    due = [middle if by is None else by(middle[None])[0] for middle in middles(rest)]
    found = [middles(polygon) for polygon in polygons]
    strayed = [np.linalg.norm(np.subtract(each, due), axis=1) / size for each in found]
    inside = all(each.contains(area[None])[0] for each, (_, area) in zip(polygons, found, strict=True))
    return [*map(percent, np.mean(strayed, axis=0).tolist()), "yes" if inside else "**no**"]


def middles(polygon: Polygon) -> tuple[Floats, Floats]:
    """The barycentroid and the centre of area."""
    return InteriorDistance(polygon).barycentroid().point, centre_of_area(flat.Filling.of(polygon, 4000))


def show_potential(axes: Axes, run: Run, polygon: Polygon) -> None:
    """U, its isolines, and its smallest value."""
    solver, filling = InteriorDistance(polygon), flat.Filling.of(polygon, run.samples)
    flat.show(axes, filling, filling.potential(solver))
    flat.dot(axes, solver.barycentroid().point, flat.BARYCENTROID, 9.0)


def centre_of_area(filling: flat.Filling) -> Floats:
    """(2,) the mean of a polygon's points."""
    corners = filling.points[filling.mesh.triangles]
    sides = corners[:, 1:] - corners[:, :1]
    areas = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    return (areas / areas.sum()) @ corners.mean(axis=1)


@figure("13", "U in bodies")
def potential_in_bodies(run: Run) -> Table:
    """Isolines of U on slices through the barycentroid, also under noise and in another pose."""
    hand, human = body(run, "hand"), body(run, "human")
    bodies = {
        "hand": (hand, hand, solid.FRONT),
        "hand, with noise": (hand, noisy_body(hand, ROUGH), solid.FRONT),
        "human": (human, human, solid.FRONT),
        "human, walking": (human, in_pose(run, "human", "human_walking"), solid.FRONT),
    }
    pictures, rows = [], []
    for name, (rest, mesh, normal) in bodies.items():
        middle = solid.frame_of(mesh, Query()).barycentroid
        query = Query(planes=(solid.cut(middle, normal),), quantity="potential")
        pictures.append(solid.picture(run, mesh, query, 460)[0])
        if mesh is not rest:
            rows.append(
                [name, percent(strays(rest, mesh, solid.frame_of(rest, Query()).barycentroid, middle))]
            )
    solid.draw_rows(run, "13", list(bodies), pictures, 4)
    return Table(("body", "barycentroid strays"), rows, STRAYS)


STRAYS = (
    "As a share of the diameter, from where the barycentroid at rest goes when it is carried along by the "
    "mean value coordinates of its own place."
)


def strays(rest: Mesh, mesh: Mesh, before: Floats, after: Floats) -> float:
    """How far the barycentroid is from where the vertices carry that of the body at rest; of the diameter."""
    expected = mean_value_weights(rest, before[None]) @ mesh.vertices
    return float(np.linalg.norm(after - expected[0]) / diameter(rest.vertices))


def human_poses(run: Run) -> list[tuple[str, Mesh]]:
    """The bundled poses, and one bent smoothly."""
    standing = body(run, "human")
    sideways = within_plane(bent(lambda points: points, 0.98, 1.38, np.radians(38)), Z, X)
    return [
        ("standing", standing),
        ("walking", in_pose(run, "human", "human_walking")),
        ("sitting", in_pose(run, "human", "human_sitting")),
        ("leaning", moved(standing, sideways)),
    ]


def cat_poses(run: Run) -> list[tuple[str, Mesh]]:
    """The bundled cat, and bent smoothly: its spine, its neck and its tail."""
    cat = body(run, "cat")
    spine = within_plane(bent(lambda points: points, -0.10, 0.22, np.radians(60)), Y, X)
    tail = within_plane(shifted(bent(lambda points: points, 0.26, 0.5, np.radians(75)), 0.3), Y, Z)
    return [
        ("walking", cat),
        ("spine bent", moved(cat, spine)),
        ("head down", moved(cat, nodding)),
        ("tail up, turning", moved(cat, one_after_another(tail, spine))),
    ]


def shifted(by: Map, height: float) -> Map:
    """A map of along and across whose middle line lies at a height."""
    offset = np.array([0.0, height])
    return lambda points: by(points - offset) + offset


def nodding(points: Floats) -> Floats:
    """The neck turned downwards about the shoulders."""
    at = np.array([0.0, -0.17, 0.33])
    turn = np.radians(48) * ramp(-points[:, Y] + 0.5 * points[:, Z], 0.27, 0.48)
    c, s, to = np.cos(turn), np.sin(turn), points - at
    return at + np.stack([to[:, X], c * to[:, Y] - s * to[:, Z], s * to[:, Y] + c * to[:, Z]], axis=1)


@figure("14", "the barycentroid over poses and in a class")
def barycentroid(run: Run) -> Table:
    """Two bodies in four poses each, and four members of a class."""
    step, count = (0.6, 300) if run.tiny else (0.15, 5000)
    hands = [(name, made_hand(name, step, count)) for name in list(HANDS)[: 2 if run.tiny else None]]
    pictures, titles, rows = [], [], []
    for what, poses, normal in (
        ("human", human_poses(run), solid.FRONT),
        ("cat", cat_poses(run), solid.ABOVE),
        ("hands", hands, solid.FRONT),
    ):
        poses = poses[:2] if run.tiny else poses
        middles, everywhere = [], np.concatenate([mesh.vertices for _, mesh in poses])
        for name, mesh in poses:
            query, facing = Query(quantity="potential"), solid.cut((0, 0, 0), normal)
            pixels, frame = solid.picture(run, mesh, query, 460, everywhere, facing)
            pictures.append(pixels)
            titles.append(name)
            middles.append(frame.barycentroid)
        rows += numbers(what, poses, middles)
    solid.draw_rows(run, "14", titles, pictures, len(pictures) // 3)
    note = (
        f"{STRAYS} Hands have no vertices in common: there it is the distance from the first one's "
        "barycentroid in the frame in which all were drawn."
    )
    return Table(("body", "barycentroid strays"), rows, note)


def numbers(what: str, poses: list[tuple[str, Mesh]], middles: list[Floats]) -> list[list[str]]:
    """The movement in each pose but the first."""
    (_, rest), *others = poses
    size, rows = diameter(rest.vertices), []
    for (name, mesh), middle in zip(others, middles[1:], strict=True):
        posed = what != "hands"
        far = strays(rest, mesh, middles[0], middle) if posed else np.linalg.norm(middle - middles[0]) / size
        rows.append([f"{what}, {name}", percent(float(far))])
    return rows
