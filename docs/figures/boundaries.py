"""Figures 5, 6 and 7: noise on the boundary, articulation, deformation."""

from __future__ import annotations

from functools import partial

import numpy as np
from matplotlib.axes import Axes

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
DRAWS = 8
"""Of each noise, over which numbers are averaged."""
SMOOTH_SOURCE = (0.22, 0.12)


def smooth_blob() -> Polygon:
    """What noise is added to."""
    return read_polygon(sample_path("blob")).resampled(NOISY_VERTICES)


def noisy_blobs(share: float, draws: int = DRAWS) -> list[tuple[float, Polygon]]:
    """The outline with several draws of noise: deviation of the displacements that were kept, and polygon."""
    made = []
    for draw in range(draws):
        polygon, kept = noisy(smooth_blob(), share, np.random.default_rng((SEED, draw)))
        made.append((kept, polygon))
    return made


def noise_title(share: float) -> str:
    """Above the picture of a noisy outline."""
    return f"noise of {100 * share:.0f} % of the diameter" if share else "smooth"


@figure("5", "noise on the boundary")
def noise(run: Run) -> Table:
    """Distances between the same points while the boundary gets ever noisier."""
    smooth, rows = smooth_blob(), []
    polygons = [smooth]
    resting = flat.Filling.of(smooth, min(3000, run.samples))
    places = resting.points[resting.inner]
    before = InteriorDistance(smooth).field(SMOOTH_SOURCE, places)
    for share in NOISE:
        made = noisy_blobs(share, 1 if run.tiny else DRAWS)
        polygons.append(made[0][1])
        told = [
            (kept, polygon.perimeter / smooth.perimeter, *change(before, field_of(polygon, places)))
            for kept, polygon in made
        ]
        kept, longer, raw, scaled = np.mean(told, axis=0).tolist()
        worst = float(np.max(told, axis=0)[3])
        title = f"{100 * share:.0f} %"
        rows.append([title, percent(kept), f"{longer:.2f}", percent(raw), percent(scaled), percent(worst)])
    cells = [partial(show_from, run=run, polygon=polygon) for polygon in polygons]
    flat.draw_rows(run, "5", [noise_title(share) for share in (0.0, *NOISE)], cells)
    header = (
        "noise",
        "deviation of what was kept",
        "perimeter, times",
        "mean change of d",
        "but for a common factor",
        "the worst draw",
    )
    return Table(header, rows, f"Means over {DRAWS} draws; the pictures show the first.")


def field_of(polygon: Polygon, places: Floats) -> Floats:
    """(p,) distances from the source of figure 5."""
    return InteriorDistance(polygon).field(SMOOTH_SOURCE, places)


def show_from(axes: Axes, run: Run, polygon: Polygon) -> None:
    """The distances from the source of figure 5."""
    filling = flat.Filling.of(polygon, run.samples)
    flat.show(axes, filling, filling.distances(InteriorDistance(polygon), SMOOTH_SOURCE), SMOOTH_SOURCE)


BARS = (
    ("a bar", 1.0, 0),
    ("bent 70°", 1.0, 70),
    ("bent 140°", 1.0, 140),
    ("bent 170°, thin in the middle", 0.6, 170),
)
"""Title, how thick the middle is, and how far it is bent."""


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


LIMBS = (
    ((-0.1, 0.13), 195, 0.32),
    ((0.1, 0.13), -15, 0.32),
    ((-0.08, -0.16), 250, 0.36),
    ((0.08, -0.16), 290, 0.36),
)
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
    for name, thicker, angle in BARS:
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
    header = (
        "deformation",
        "points moved, mean, of the diameter",
        "change of d, the points moved along",
        "the same places",
    )
    return Table(header, rows, "Mean changes of d but for a common factor.")
