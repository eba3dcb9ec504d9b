"""Figures 12, 13 and 14: the potential U, and the barycentroid under noise, deformation, pose, and in a class."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from figures import flat, solid
from figures.bending import Floats, Map, bent, carried, diameter, one_after_another, ramp
from figures.boundaries import DEFORMATIONS, FIGURE_POSES, noise_title, noisy_blobs, posed
from figures.registry import Run, Table, figure
from figures.shapes import HANDS, bundled, made_hand, moved, noisy_body, within_plane
from figures.words import percent
from matplotlib.axes import Axes

from idviewer.core import InteriorDistance, Mesh, Polygon, mean_value_weights, read_polygon, sample_path
from idviewer.session import Query
from idviewer.session.pipeline import run_to_end

X, Y, Z = range(3)
ROUGH = 0.003
"""Noise on bodies, as a share of the diagonal: some half an edge."""


def cases() -> list[tuple[str, Polygon, Polygon, Map | None]]:
    """Title, polygon at rest, polygon, and the map between them, of figure 12."""
    noisy = noisy_blobs()
    made = [(noise_title(share), noisy[0][2], polygon, None) for share, _, polygon in noisy]
    blob = read_polygon(sample_path("blob"))
    ginger = read_polygon(sample_path("gingerbread"))
    made += [(name, blob, carried(blob, by), by) for name, by in DEFORMATIONS.items()]
    return made + [(name, ginger, carried(ginger, posed(name)), posed(name)) for name in FIGURE_POSES]


@figure("12", "U and the barycentroid in 2D")
def potential(run: Run) -> Table:
    """Isolines of U under noise, deformation and articulation, and where the barycentroid goes."""
    cells, rows, titles, rests = [], [], [], {}
    for index, (name, rest, polygon, by) in enumerate(cases()):
        solver, filling = InteriorDistance(polygon), flat.Filling.of(polygon, run.samples)
        middle = solver.barycentroid().point
        cells.append(partial(show_potential, filling=filling, solver=solver, middle=middle))
        titles.append(name)
        if index % 4 == 0:
            rests[id(rest)] = middle
            at_rest = middle
            continue
        expected = at_rest if by is None else by(at_rest[None])[0]
        size = diameter(rest.vertices)
        centroids = [centre_of_area(flat.Filling.of(each, 4000)) for each in (rest, polygon)]
        due = centroids[0] if by is None else by(centroids[0][None])[0]
        moves = (np.linalg.norm(middle - expected) / size, np.linalg.norm(centroids[1] - due) / size)
        inside = "yes" if polygon.contains(centroids[1][None])[0] else "no"
        rows.append([name, *map(percent, map(float, moves)), inside])
    flat.draw_rows(run, "12", titles, cells)
    header = ("what was done", "barycentroid strays", "centre of area strays", "centre of area inside")
    note = "As a share of the diameter, from where the same point would have gone with the deformation."
    return Table(header, rows, note)


def show_potential(axes: Axes, filling: flat.Filling, solver: InteriorDistance, middle: Floats) -> None:
    """U, its isolines, and its smallest value."""
    flat.show(axes, filling, filling.potential(solver))
    flat.dot(axes, middle, flat.BARYCENTROID, 9.0)


def centre_of_area(filling: flat.Filling) -> Floats:
    """(2,) the mean of a polygon's points."""
    corners = filling.points[filling.mesh.triangles]
    sides = corners[:, 1:] - corners[:, :1]
    areas = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    return (areas / areas.sum()) @ corners.mean(axis=1)


@figure("13", "U in bodies")
def potential_in_bodies(run: Run) -> Table:
    """Isolines of U on slices through the barycentroid, also under noise and in another pose."""
    hand, human = bundled(run.body("hand")), bundled(run.body("human"))
    bodies = {
        "hand": (hand, hand, solid.FRONT),
        "hand, with noise": (hand, noisy_body(hand, ROUGH), solid.FRONT),
        "human": (human, human, solid.FRONT),
        "human, walking": (human, bundled(run.body("human_walking")), solid.FRONT),
    }
    pictures, rows = [], []
    for name, (rest, mesh, normal) in bodies.items():
        middle = run_to_end(mesh, Query()).barycentroid
        query = Query(planes=(solid.cut(middle, normal),), quantity="potential")
        pictures.append(solid.picture(run, mesh, query, 620, barycentroid=True)[0])
        if mesh is not rest:
            rows.append([name, percent(strays(rest, mesh, run_to_end(rest, Query()).barycentroid, middle))])
    draw_pictures(run, "13", list(bodies), pictures, 4)
    return Table(("body", "barycentroid strays"), rows, STRAYS)


STRAYS = (
    "As a share of the diameter, from where the barycentroid at rest goes when it is carried along by the mean "
    "value coordinates of its own place."
)


def strays(rest: Mesh, mesh: Mesh, before: Floats, after: Floats) -> float:
    """How far the barycentroid is from where the vertices carry that of the body at rest; of the diameter."""
    expected = mean_value_weights(rest, before[None]) @ mesh.vertices
    return float(np.linalg.norm(after - expected[0]) / diameter(rest.vertices))


def draw_pictures(run: Run, number: str, titles: Sequence[str], pictures: list, columns: int) -> None:
    """Pictures in rows, all at the same height, titles above."""
    rows = len(pictures) // columns
    drawing, axes = flat.row_of(columns, 13.2 / columns, 3.8, rows)
    for place, text, pixels in zip(axes.flat, titles, pictures, strict=True):
        solid.show_pixels(place, pixels)
        flat.title(place, text)
    run.save(drawing, number)


def human_poses(run: Run) -> list[tuple[str, Mesh]]:
    """The bundled poses, and one bent smoothly."""
    standing = bundled(run.body("human"))
    sideways = within_plane(bent(lambda points: points, 0.98, 1.38, np.radians(38)), Z, X)
    return [
        ("standing", standing),
        ("walking", bundled(run.body("human_walking"))),
        ("sitting", bundled(run.body("human_sitting"))),
        ("leaning", moved(standing, sideways)),
    ]


def cat_poses(run: Run) -> list[tuple[str, Mesh]]:
    """The bundled cat, and bent smoothly: its spine, its neck and its tail."""
    cat = bundled(run.body("cat"))
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
    step, count = (0.5, 1200) if run.tiny else (0.15, 5000)
    hands = [(name, made_hand(name, step, count)) for name in HANDS]
    pictures, titles, rows = [], [], []
    for what, poses, normal in (
        ("human", human_poses(run), solid.FRONT),
        ("cat", cat_poses(run), solid.SIDE),
        ("hands", hands, solid.FRONT),
    ):
        middles = []
        for name, mesh in poses:
            pixels, frame = solid.picture(
                run, mesh, Query(), 560, barycentroid=True, facing=solid.cut((0, 0, 0), normal)
            )
            pictures.append(pixels)
            titles.append(name)
            middles.append(frame.barycentroid)
        rows += numbers(what, poses, middles)
    draw_pictures(run, "14", titles, pictures, 4)
    note = (
        f"{STRAYS} Hands have no vertices in common: there it is the distance from the first one's barycentroid in "
        "the frame in which all were drawn."
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
