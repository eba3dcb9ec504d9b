"""Comparison of shapes by the descriptors in their results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from idviewer.batch.result_files import RESULT_SUFFIX, content_of
from idviewer.core.interior import ShapeDescriptors, descriptor_differences

MOST_COMPARED = 5000
"""Shapes; the matrix of so many takes 200 MB a part."""


@dataclass(frozen=True)
class Compared:
    """One shape to be compared.

    Attributes:
        name: for the matrix.
        descriptors: of it.
        distance: options of the distance that they were made with.
        where: it was found, for errors.
    """

    name: str
    descriptors: ShapeDescriptors
    distance: Mapping[str, Any]
    where: str


@dataclass(frozen=True, eq=False)
class Comparison:
    """Differences of all pairs of shapes.

    Attributes:
        names: of the s shapes.
        parts: (s, s) differences by each part of the descriptors, by its name.
        sampling_errors: of each shape (s,) by those parts that are sampled.
    """

    names: list[str]
    parts: dict[str, NDArray[np.float64]]
    sampling_errors: dict[str, list[float]]

    def difference(self, by: Sequence[str]) -> NDArray[np.float64]:
        """The sum (s, s) of some parts."""
        return np.asarray(sum(self.parts[part] for part in by))


def is_result(path: Path) -> bool:
    """Whether a file is the result of a shape, and not a shape."""
    if path.suffix.lower() != RESULT_SUFFIX:
        return False
    content = content_of(path) or {}
    return "name" in content and ("key" in content or "error" in content)


def results_in(folder: Path) -> list[Path]:
    """Result files in a folder; none where it holds shapes."""
    return [path for path in sorted(folder.glob(f"*{RESULT_SUFFIX}")) if is_result(path)]


def compared_of(content: Mapping[str, Any], where: str) -> Compared:
    """The shape that a result file tells of.

    Raises:
        ValueError: it failed, or its descriptors were not asked for.
    """
    if "error" in content:
        reason = str(content["error"])
        raise ValueError(reason if reason.startswith(where) else f"{where}: {reason}")
    try:
        stored, distance = content["result"].get("descriptors"), content["options"]["distance"]
        if stored is None:
            raise ValueError("it has no descriptors; compute it with `idviewer batch --descriptors`")
        return Compared(str(content["name"]), ShapeDescriptors.from_dict(stored), distance, where)
    except (AttributeError, KeyError, TypeError) as error:
        raise ValueError(f"{where}: not a whole result; compute it again") from error
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error


def compare(shapes: Sequence[Compared], with_size: bool = False) -> Comparison:
    """Compare all pairs of shapes.

    Args:
        shapes: at least two.
        with_size: whether their sizes count.

    Raises:
        ValueError: there are too few or too many, they were made with different distances, or some are
            polygons and some are meshes.
    """
    if not 2 <= len(shapes) <= MOST_COMPARED:
        raise ValueError(f"2 to {MOST_COMPARED:,} shapes can be compared, not {len(shapes)}")
    first = shapes[0]
    for one in shapes[1:]:
        if one.distance != first.distance:
            told = (f"{each.name} with {_in_words(each.distance)}" for each in (first, one))
            raise ValueError(f"shapes described by different distances cannot be compared: {', '.join(told)}")
        if one.descriptors.dimension != first.descriptors.dimension:
            flat, solid = sorted((first, one), key=lambda each: each.descriptors.dimension)
            raise ValueError(f"{flat.name} is a polygon and {solid.name} a mesh; they cannot be compared")
    described = [one.descriptors for one in shapes]
    return Comparison(
        _distinct([one.name for one in shapes], [one.where for one in shapes]),
        descriptor_differences(described, with_size),
        {
            "distances": [one.distances_error for one in described],
            "potential": [one.potential_error for one in described],
        },
    )


def _distinct(names: list[str], places: list[str]) -> list[str]:
    """Names that are all different: where they are not, with where each was found."""
    return [
        name if names.count(name) == 1 else f"{name} ({place})"
        for name, place in zip(names, places, strict=True)
    ]


def _in_words(distance: Mapping[str, Any]) -> str:
    """Options of a distance, those that are set."""
    return " ".join(f"{name}={value}" for name, value in distance.items() if value)
