"""Figures 5, 6 and 7: noise on the boundary, articulation, deformation."""

from __future__ import annotations

from functools import partial

import numpy as np
from figures import flat
from figures.bending import (
    Floats,
    Map,
    bent,
    carried,
    change,
    diameter,
    noisy,
    one_after_another,
    ramp,
    skinned,
)
from figures.registry import SEED, Run, Table, figure
from figures.words import percent

from idviewer.core import InteriorDistance, Polygon, read_polygon, sample_path

NOISE = (0.01, 0.02, 0.04)
NOISY_VERTICES = 100
SMOOTH_SOURCE = (0.22, 0.12)


def noisy_blobs() -> list[tuple[float, float, Polygon]]:
    """A smooth outline and it with noise: wanted deviation, that of the displacements, and the polygon."""
    smooth = read_polygon(sample_path("blob")).resampled(NOISY_VERTICES)
    made = [(0.0, 0.0, smooth)]
    for share in NOISE:
        polygon, kept = noisy(smooth, share, np.random.default_rng(SEED))
        made.append((share, kept, polygon))
    return made


def noise_title(share: float) -> str:
    """Above the picture of a noisy outline."""
    return f"noise of {100 * share:.0f} % of the diameter" if share else "smooth"


@figure("5", "noise on the boundary")
def noise(run: Run) -> Table:
    """Distances between the same points while the boundary gets ever noisier."""
    made, cells, rows = noisy_blobs(), [], []
    smooth = made[0][2]
    fillings = [flat.Filling.of(polygon, run.samples) for _, _, polygon in made]
    places = fillings[0].points[fillings[0].inner]
    before = InteriorDistance(smooth).field(SMOOTH_SOURCE, places)
    for (share, kept, polygon), filling in zip(made, fillings, strict=True):
        solver = InteriorDistance(polygon)
        values = filling.distances(solver, SMOOTH_SOURCE)
        cells.append(partial(flat.show, filling=filling, values=values, source=SMOOTH_SOURCE))
        if share:
            raw, scaled = change(before, solver.field(SMOOTH_SOURCE, places))
            longer = polygon.perimeter / smooth.perimeter
            rows.append([f"{100 * share:.0f} %", percent(kept), f"{longer:.2f}", percent(raw), percent(scaled)])
    flat.draw_rows(run, "5", [noise_title(share) for share, _, _ in made], cells)
    header = (
        "noise",
        "deviation of what was kept",
        "perimeter, times",
        "mean change of d",
        "but for a common factor",
    )
    return Table(header, rows)


def bar(thicker: float, angle: float) -> tuple[Polygon, Map]:
    """A rounded bar, and a map that bends its middle and makes that so many times as thick."""
    half = np.linspace(-np.pi / 2, np.pi / 2, 200)
    right = np.stack([0.85 + 0.15 * np.cos(half), 0.15 * np.sin(half)], axis=1)
    polygon = Polygon(np.concatenate([right, -right])).resampled(260)

    def swell(points: Floats) -> Floats:
        factor = 1.0 + (thicker - 1.0) * ramp(0.45 - np.abs(points[:, 0]), 0.0, 0.45)
        return points * np.stack([np.ones_like(factor), factor], axis=1)

    if angle == 0.0:
        return polygon, swell
    return polygon, one_after_another(swell, bent(lambda points: points, -0.45, 0.45, np.radians(angle)))


def upright(polygon: Polygon, angle: float) -> Map:
    """Turns a bent bar so that its two ends lie level."""
    c, s = np.cos(np.radians(angle / 2)), np.sin(np.radians(angle / 2))
    return lambda points: points @ np.array([[c, -s], [s, c]])


LIMBS = (((-0.1, 0.13), 195, 0.32), ((0.1, 0.13), -15, 0.32), ((-0.08, -0.16), 250, 0.36), ((0.08, -0.16), 290, 0.36))
"""Joint, heading in degrees and length of each limb of the gingerbread."""

BODY = (((0.0, 0.36), (0.0, -0.16)), ((-0.06, 0.12), (0.06, 0.12)), ((-0.05, -0.14), (0.05, -0.14)))
"""Bones that stay: spine, shoulders, hips."""

FIGURE_POSES = {
    "one outline": (0, 0, 0, 0),
    "one arm up": (0, 55, 0, 0),
    "walking": (30, 35, -22, 22),
    "jumping": (-50, 50, -26, 26),
}
"""Degrees by which the limbs swing, counter-clockwise."""


def posed(name: str) -> Map:
    """The map that takes the gingerbread to a pose."""
    limbs = []
    for (x, y), heading, length in LIMBS:
        turn = np.radians(heading)
        limbs.append(((x, y), (x + length * np.cos(turn), y + length * np.sin(turn))))
    angles = np.radians([0] * len(BODY) + list(FIGURE_POSES[name]))
    return skinned(np.array([*BODY, *limbs]), angles)


@figure("6", "articulation")
def articulation(run: Run) -> Table:
    """Limbs swing and a bar bends; distances between the points that correspond."""
    cells, rows, titles = [], [], []
    ginger = read_polygon(sample_path("gingerbread"))
    motions = [(name, ginger, posed(name), (-0.36, 0.03)) for name in FIGURE_POSES]
    for name, thicker, angle in (("a bar", 1, 0), ("bent 70°", 1, 70), ("bent 140°", 1, 140), ("… thin in the middle", 0.6, 170)):
        polygon, bend = bar(thicker, angle)
        motions.append((name, polygon, one_after_another(bend, upright(polygon, angle)), (-0.8, 0.04)))
    before: Floats | None = None
    for index, (name, rest, by, source) in enumerate(motions):
        resting = flat.Filling.of(rest, run.samples)
        places = resting.points[resting.inner]
        if index % 4 == 0:
            before = InteriorDistance(rest).field(source, places)
        polygon, at = carried(rest, by), by(np.array([source]))[0]
        solver, filling = InteriorDistance(polygon), flat.Filling.of(polygon, run.samples)
        cells.append(partial(flat.show, filling=filling, values=filling.distances(solver, at), source=at))
        titles.append(name)
        if index % 4:
            straight = change(distances(source, places), distances(at, by(places)))
            changes = change(before, solver.field(at, by(places)))
            rows.append([name, *map(percent, changes), percent(straight[0])])
    flat.draw_rows(run, "6", titles, cells)
    header = ("pose", "mean change of d", "but for a common factor", "mean change of the Euclidean distance")
    return Table(header, rows)


def distances(source: object, points: Floats) -> Floats:
    """(p,) Euclidean."""
    return np.linalg.norm(points - np.asarray(source), axis=1)


def stretched(points: Floats) -> Floats:
    """Longer, and waved."""
    return np.stack([1.45 * points[:, 0], points[:, 1] + 0.12 * np.sin(5.0 * points[:, 0])], axis=1)


def pushed(points: Floats) -> Floats:
    """A thumb pressed in from above, and drawn out to the right."""
    near = np.exp(-((points[:, 0] - 0.1) ** 2) / 0.02)
    depth = 0.42 * near * ramp(points[:, 1], -0.35, 0.5)
    out = 0.35 * ramp(points[:, 0], 0.0, 0.6) * np.exp(-((points[:, 1] + 0.1) ** 2) / 0.02)
    return points + np.stack([out, -depth], axis=1)


DEFORMATIONS: dict[str, Map] = {
    "one outline": lambda points: points,
    "stretched and waved": stretched,
    "bent": bent(lambda points: points, -0.5, 0.5, -1.4),
    "pushed in, drawn out": pushed,
}


@figure("7", "deformation")
def deformation(run: Run) -> Table:
    """Maps of the plane that are no isometries: the distance goes with the points."""
    rest, cells, rows = read_polygon(sample_path("blob")), [], []
    resting, first = flat.Filling.of(rest, run.samples), InteriorDistance(rest)
    places = resting.points[resting.inner]
    before = first.field(SMOOTH_SOURCE, places)
    for name, by in DEFORMATIONS.items():
        polygon, at = carried(rest, by), by(np.array([SMOOTH_SOURCE]))[0]
        solver, filling = InteriorDistance(polygon), flat.Filling.of(polygon, run.samples)
        cells.append(partial(flat.show, filling=filling, values=filling.distances(solver, at), source=at))
        if name != "one outline":
            going = change(before, solver.field(at, by(places)))[1]
            staying = change(before, solver.field(at, places))[1]
            moved = float(np.linalg.norm(by(places) - places, axis=1).mean() / diameter(rest.vertices))
            rows.append([name, percent(moved), percent(going), percent(staying)])
    flat.draw_rows(run, "7", list(DEFORMATIONS), cells)
    header = ("deformation", "points moved, mean, of the diameter", "change of d, the points moved along", "the same places")
    return Table(header, rows, "Mean changes of d but for a common factor.")
