"""Lengths and viewports of SVG: what a user unit is, and where a drawing in a drawing lies."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

PIXELS = {"px": 1.0, "in": 96.0, "cm": 96.0 / 2.54, "mm": 96.0 / 25.4, "pt": 96.0 / 72.0, "pc": 16.0}
"""A length in pixels, as CSS defines them; "q" is left out, as nobody writes it."""

_LENGTH = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-z]+|%)?\s*$", re.IGNORECASE)
_ALONG = {"x": 0, "width": 0, "cx": 0, "rx": 0, "x1": 0, "x2": 0, "y": 1, "height": 1, "cy": 1, "ry": 1}
_ALONG |= {"y1": 1, "y2": 1, "r": 2}


@dataclass(frozen=True)
class Viewport:
    """The rectangle that percentages refer to.

    Attributes:
        width: in user units.
        height: likewise.
    """

    width: float
    height: float

    def without_percentages(self, attributes: Mapping[str, str]) -> dict[str, str]:
        """Attributes with numbers for percentages.

        Args:
            attributes: of an element.

        >>> Viewport(200.0, 100.0).without_percentages({"width": "50%", "height": "50%", "fill": "red"})
        {'width': '100.0', 'height': '50.0', 'fill': 'red'}
        """
        sizes = (self.width, self.height, math.hypot(self.width, self.height) / math.sqrt(2.0))
        return {
            key: str(length(value, sizes[_ALONG[key]], 0.0)) if key in _ALONG and "%" in value else value
            for key, value in attributes.items()
        }


def length(text: str | None, whole: float, default: float) -> float:
    """A length in user units.

    Args:
        text: such as "12", "4in" or "50%".
        whole: what 100 % is.
        default: where the text is no length.

    >>> length("1in", 1.0, 0.0), length("50%", 8.0, 0.0), length(None, 8.0, 3.0)
    (96.0, 4.0, 3.0)
    """
    found = _LENGTH.match(text or "")
    if found is None:
        return default
    number, unit = float(found[1]), (found[2] or "px").lower()
    if unit == "%":
        return number / 100.0 * whole
    return number * PIXELS[unit] if unit in PIXELS else default


def view_box(attributes: Mapping[str, str]) -> tuple[float, float, float, float] | None:
    """Left, top, width and height of the viewBox; None where there is none that can be used.

    Args:
        attributes: of the element.

    >>> view_box({"viewBox": "0 0 4,3"}), view_box({"viewBox": "0 0 0 3"})
    ((0.0, 0.0, 4.0, 3.0), None)
    """
    words = re.split(r"[\s,]+", attributes.get("viewBox", "").strip())
    try:
        left, top, width, height = map(float, words)
    except ValueError:
        return None
    usable = width > 0.0 and height > 0.0 and all(map(math.isfinite, (left, top, width, height)))
    return (left, top, width, height) if usable else None


def _scales(size: tuple[float, float], box: tuple[float, float], aspect: str) -> tuple[float, float]:
    across, down = size[0] / box[0], size[1] / box[1]
    if aspect.strip().startswith("none"):
        return across, down
    one = max(across, down) if "slice" in aspect else min(across, down)
    return one, one


def nested_transform(attributes: Mapping[str, str], around: Viewport) -> tuple[str, Viewport]:
    """The transform of a drawing in a drawing, and the viewport of what it holds.

    Args:
        attributes: of the inner one.
        around: the outer one's viewport.

    >>> inner = {"x": "5", "width": "10", "height": "10", "viewBox": "1 0 2 2"}
    >>> nested_transform(inner, Viewport(100.0, 100.0))[0]
    'translate(5.0, 0.0) scale(5.0, 5.0) translate(-1.0, -0.0)'
    """
    x, y = length(attributes.get("x"), around.width, 0.0), length(attributes.get("y"), around.height, 0.0)
    width = length(attributes.get("width"), around.width, around.width)
    height = length(attributes.get("height"), around.height, around.height)
    box = view_box(attributes)
    if box is None:
        return f"translate({x!r}, {y!r})", Viewport(width, height)
    aspect = attributes.get("preserveAspectRatio", "xMidYMid meet")
    across, down = _scales((width, height), box[2:], aspect)
    if not aspect.strip().startswith("none"):
        for axis, place in (("x", aspect.strip()[:4]), ("y", aspect.strip()[4:8])):
            spare = width - across * box[2] if axis == "x" else height - down * box[3]
            share = 0.0 if "Min" in place else 1.0 if "Max" in place else 0.5
            x, y = (x + share * spare, y) if axis == "x" else (x, y + share * spare)
    scaled = f"scale({across!r}, {down!r}) translate({-box[0]!r}, {-box[1]!r})"
    return f"translate({x!r}, {y!r}) {scaled}", Viewport(box[2], box[3])


def user_unit(attributes: Mapping[str, str]) -> tuple[tuple[float, float], str, Viewport]:
    """How long the drawing's units are, across and down; in which unit; and its viewport.

    The unit is the one in which the drawing's width is given, or else pixels.

    Args:
        attributes: of the outermost element.

    >>> user_unit({"width": "4in", "viewBox": "0 0 4 3"})[:2]
    ((1.0, 1.0), 'in')
    >>> user_unit({"width": "100mm", "viewBox": "0 0 200 200"})[:2]
    ((0.5, 0.5), 'mm')
    """
    box = view_box(attributes)
    given = {side: _LENGTH.match(attributes.get(side, "")) for side in ("width", "height")}
    told = [found for found in given.values() if found and (found[2] or "px").lower() in PIXELS]
    unit = (told[0][2] or "px").lower() if told else "px"
    sides = [
        float(found[1]) * (PIXELS[(found[2] or "px").lower()] / PIXELS[unit])
        if found in told and found
        else 0.0
        for found in given.values()
    ]
    if box is None:
        one = 1.0 / PIXELS[unit]
        return (one, one), unit, Viewport(sides[0] / one or 100.0, sides[1] / one or 100.0)
    if not any(sides):
        return (1.0, 1.0), "px", Viewport(box[2], box[3])
    # What is not given follows from the box.
    width = sides[0] or sides[1] * box[2] / box[3]
    height = sides[1] or sides[0] * box[3] / box[2]
    across, down = _scales((width, height), box[2:], attributes.get("preserveAspectRatio", "xMidYMid meet"))
    return (across, down), unit, Viewport(box[2], box[3])
