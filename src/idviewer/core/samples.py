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


@dataclass(frozen=True)
class Sample:
    """A bundled shape: its name, its file and what it is, in one line."""

    name: str
    path: Path
    description: str


def samples() -> tuple[Sample, ...]:
    """All bundled shapes, each shape's sizes in turn, the usual size first.

    >>> samples()[0].description
    'an open right hand with its wrist, 7,000 vertices'
    """
    folder = _folder()
    return tuple(
        Sample(shape + ending, folder / f"{shape}{ending}.ply", f"{what}, {count:,} vertices")
        for shape, what in _SHAPES.items()
        for ending, count in _SIZES.items()
        if ending != "_27k" or shape in _IN_THREE_SIZES
    )


def sample_names() -> tuple[str, ...]:
    """Names of the bundled shapes; `_2k` and `_27k` end those of the small and the large size.

    >>> sample_names()[:3]
    ('hand', 'hand_2k', 'hand_27k')
    """
    return tuple(sample.name for sample in samples())


def sample_path(name: str = DEFAULT_SAMPLE) -> Path:
    """The file of a bundled shape, binary PLY in metres with z up.

    Raises:
        ValueError: there is no shape of that name; the message lists those there are.

    >>> sample_path("human_2k").name
    'human_2k.ply'
    """
    for sample in samples():
        if sample.name == name:
            return sample.path
    raise ValueError(f"no bundled shape is called {name!r}; there are {', '.join(sample_names())}")


def _folder() -> Path:
    package = Path(str(files("idviewer")))
    installed = package / "assets"
    return installed if installed.is_dir() else package.parents[1] / "assets"
