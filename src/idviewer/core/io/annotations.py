"""Outlines drawn on images: the JSON of labelme, of COCO, and of the VGG Image Annotator (VIA)."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from idviewer.core.arrays import Floats
from idviewer.core.io.geojson import is_number, loop_of
from idviewer.core.io.outlines import Outline
from idviewer.core.io.text import UnreadableError

UPWARDS = "y was turned upwards: the image's point (x, y) is (x, -y) here."
CIRCLE_SIDES = 256


@dataclass(frozen=True)
class Annotations:
    """The outlines of an annotated image, y pointing up.

    Attributes:
        outlines: in the file's order.
        kind: what the format calls them, in the plural.
        notes: one sentence each.
    """

    outlines: tuple[Outline, ...]
    kind: str
    notes: tuple[str, ...]


def annotated_outlines(content: Any) -> Annotations | None:
    """The outlines in what labelme, COCO or VIA writes; None if it is none of these.

    Args:
        content: a JSON value.

    Raises:
        UnreadableError: an outline's points cannot be read.

    >>> shape = {"label": "cat", "shape_type": "polygon", "points": [[0, 0], [4, 0], [0, 3]]}
    >>> annotated_outlines({"shapes": [shape]}).outlines[0].name
    'cat'
    """
    if not isinstance(content, dict):
        return None
    if isinstance(content.get("shapes"), list):
        return _gathered(_labelme(content["shapes"]), "shapes")
    if isinstance(content.get("annotations"), list):
        return _gathered(_coco(content), "annotations")
    images = content.get("_via_img_metadata", content)
    if isinstance(images, dict) and images and all(_is_via(image) for image in images.values()):
        return _gathered(_via(images), "regions")
    return None


def _gathered(found: Iterator[Outline | str], kind: str) -> Annotations:
    """Outlines, and a note on what has no outline."""
    everything = list(found)
    outlines = tuple(one for one in everything if isinstance(one, Outline))
    others = [one for one in everything if isinstance(one, str)]
    notes: tuple[str, ...] = (UPWARDS,)
    if others:
        named = ", ".join(sorted(set(others)))[:60]
        notes += (f"{len(others):,} of its {kind} ({named}) are no outlines and were passed over.",)
    return Annotations(outlines, kind, notes)


def _labelme(shapes: list[Any]) -> Iterator[Outline | str]:
    for number, shape in enumerate(shapes):
        where = f"shapes[{number}]"
        if not isinstance(shape, dict):
            raise UnreadableError(f"{where} is {json.dumps(shape)[:30]}, not a shape")
        kind = str(shape.get("shape_type", "polygon"))[:30]
        points = loop_of(shape.get("points"), f"{where}.points")
        if kind == "rectangle" and len(points) == 2:
            points = _rectangle(points[0], points[1])
        elif kind == "circle" and len(points) == 2:
            points = _ellipse(points[0], np.full(2, math.dist(points[0], points[1])))
        elif kind != "polygon":
            yield kind
            continue
        yield _outline([points], shape.get("label"))


def _coco(content: dict[str, Any]) -> Iterator[Outline | str]:
    categories = content.get("categories")
    names = {
        one.get("id"): one.get("name")
        for one in (categories if isinstance(categories, list) else [])
        if isinstance(one, dict) and isinstance(one.get("id"), int | str)
    }
    for number, one in enumerate(content["annotations"]):
        where = f"annotations[{number}]"
        if not isinstance(one, dict):
            raise UnreadableError(f"{where} is {json.dumps(one)[:30]}, not an annotation")
        pieces = one.get("segmentation")
        if not isinstance(pieces, list) or not pieces:
            yield "run lengths" if isinstance(pieces, dict) else "boxes"
            continue
        category = one.get("category_id")
        name = names.get(category) if isinstance(category, int | str) else None
        for place, numbers in enumerate(pieces):
            if not isinstance(numbers, list) or len(numbers) % 2 or not all(map(is_number, numbers)):
                raise UnreadableError(f"{where}.segmentation[{place}] is no list of x, y, x, y, ...")
            yield _outline([np.array(numbers, dtype=np.float64).reshape(-1, 2)], name, one.get("id"))


def _is_via(image: Any) -> bool:
    return isinstance(image, dict) and isinstance(image.get("regions"), list | dict)


def _via(images: dict[str, Any]) -> Iterator[Outline | str]:
    for image in images.values():
        regions = image["regions"]
        for region in regions if isinstance(regions, list) else regions.values():
            shape = region.get("shape_attributes") if isinstance(region, dict) else None
            if not isinstance(shape, dict):
                raise UnreadableError(f"a region is {json.dumps(region)[:30]}, without shape_attributes")
            attributes = region.get("region_attributes")
            told = [
                value
                for value in (attributes.values() if isinstance(attributes, dict) else ())
                if isinstance(value, str) and value.strip()
            ]
            points = _via_points(shape)
            yield str(shape.get("name"))[:30] if points is None else _outline([points], *told[:1])


def _via_points(shape: dict[str, Any]) -> Floats | None:
    if shape.get("name") in ("polygon", "polyline"):
        xs, ys = shape.get("all_points_x"), shape.get("all_points_y")
        if not (isinstance(xs, list) and isinstance(ys, list) and len(xs) == len(ys)):
            raise UnreadableError("a region's all_points_x and all_points_y are not as many")
        return loop_of([list(point) for point in zip(xs, ys, strict=True)], "a region's points")
    keys = {
        "rect": ("x", "y", "width", "height"),
        "ellipse": ("cx", "cy", "rx", "ry"),
        "circle": ("cx", "cy", "r", "r"),
    }
    wanted = keys.get(str(shape.get("name")))
    if wanted is None:
        return None
    values = [shape.get(key) for key in wanted]
    if not all(map(is_number, values)):
        raise UnreadableError(f"a region's {', '.join(dict.fromkeys(wanted))} are not all numbers")
    first, second = np.array(values, dtype=np.float64).reshape(2, 2)
    return _rectangle(first, first + second) if shape["name"] == "rect" else _ellipse(first, second)


def _rectangle(corner: Floats, opposite: Floats) -> Floats:
    (left, low), (right, high) = corner.tolist(), opposite.tolist()
    return np.array([[left, low], [right, low], [right, high], [left, high]])


def _ellipse(centre: Floats, radii: Floats) -> Floats:
    angles = 2.0 * np.pi * np.arange(CIRCLE_SIDES) / CIRCLE_SIDES
    return centre + radii * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _outline(loops: list[Floats], *names: Any) -> Outline:
    given = [str(name) for name in names if isinstance(name, str | int) and str(name).strip()]
    turned = tuple(loop * [1.0, -1.0] for loop in loops)
    return Outline(turned, given[0] if given else "", tuple(given))
