"""The bundled shapes: their names, their files and a line about each.

They lie in `idviewer/assets` of an installed package, and in `assets` of a source checkout.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

DEFAULT_SAMPLE = "hand"

_SHAPES = {
    "hand": "an open right hand with its wrist",
    "human": "a human standing",
    "human_walking": "the same human walking, same triangles",
    "human_sitting": "the same human sitting, same triangles",
    "octopus": "an octopus with eight curling arms",
    "cat": "a cat-like animal walking",
    "couple": "two figures that hold each other, a body with three holes",
}
_SIZES = {"": 7000, "_2k": 2500, "_27k": 27000}
_IN_THREE_SIZES = ("hand", "human", "octopus")
_POLYGONS = {
    "blob": ("a smooth round outline", 200),
    "star": ("a star of five points", 200),
    "bay_1": ("a square with a shallow bay", 240),
    "bay_2": ("the same square with a deeper bay", 240),
    "bay_3": ("the same square with a bay so deep that it is a U", 240),
    "gingerbread": ("a gingerbread man", 300),
    "gingerbread_waving": ("the same man waving", 300),
    "spiral": ("a band that winds inward", 400),
    "snake": ("a corridor that goes to and fro", 400),
    "ring": ("a disc with a hole", 220),
    "plate": ("an oblong with three holes", 320),
}


@dataclass(frozen=True)
class Sample:
    """A bundled shape: its name, its file, what it is, in one line, and its dimension, 2 or 3."""

    name: str
    path: Path
    description: str
    dimension: int = 3


def all_samples() -> tuple[Sample, ...]:
    """All bundled shapes: meshes, each one's sizes in turn, the usual size first, and then polygons.

    >>> all_samples()[0].description, all_samples()[-1].description
    ('an open right hand with its wrist, 7,000 vertices', 'an oblong with three holes, 320 vertices, 2D')
    """
    folder = _folder()
    meshes = tuple(
        Sample(shape + ending, folder / f"{shape}{ending}.ply", f"{what}, {count:,} vertices")
        for shape, what in _SHAPES.items()
        for ending, count in _SIZES.items()
        if ending != "_27k" or shape in _IN_THREE_SIZES
    )
    polygons = tuple(
        Sample(name, folder / f"{name}.csv", f"{what}, {count} vertices, 2D", 2)
        for name, (what, count) in _POLYGONS.items()
    )
    return meshes + polygons


def sample_names(dimension: int | None = None) -> tuple[str, ...]:
    """Names of the bundled shapes; `_2k` and `_27k` end those of a mesh's small and large size.

    Args:
        dimension: 3 for the meshes alone, 2 for the polygons.

    >>> sample_names()[:3], sample_names(2)[:3]
    (('hand', 'hand_2k', 'hand_27k'), ('blob', 'star', 'bay_1'))
    """
    return tuple(sample.name for sample in all_samples() if dimension in (None, sample.dimension))


def sample_path(name: str = DEFAULT_SAMPLE) -> Path:
    """The file of a bundled shape: binary PLY in metres with z up, or the CSV of a polygon about 1 wide.

    Raises:
        ValueError: there is no shape of that name; the message lists those there are.

    >>> sample_path("human_2k").name
    'human_2k.ply'
    """
    for sample in all_samples():
        if sample.name == name:
            return sample.path
    raise ValueError(f"no bundled shape is called {name!r}; there are {', '.join(sample_names())}")


def _folder() -> Path:
    package = Path(str(files("idviewer")))
    installed = package / "assets"
    return installed if installed.is_dir() else package.parents[1] / "assets"
