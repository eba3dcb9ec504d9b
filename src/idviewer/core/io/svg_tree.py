"""An SVG drawing's tree with what is drawn in it, and nothing else: uses replaced by what they draw."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from xml.etree import ElementTree

from idviewer.core.io.svg_viewports import Viewport, length, nested_transform
from idviewer.core.io.text import UnreadableError
from idviewer.core.io.text_tables import text_of

DRAWN_ELSEWHERE = frozenset(
    {"defs", "symbol", "marker", "mask", "clipPath", "pattern", "metadata", "filter", "font", "glyph"}
    | {"linearGradient", "radialGradient"}
)
"""Elements whose contents are drawn where they are referred to, if at all."""

SHAPES = frozenset(["path", "polygon", "polyline", "rect", "circle", "ellipse"])
LINK = "{http://www.w3.org/1999/xlink}href"
SPACE = "{http://www.w3.org/2000/svg}"


@dataclass(frozen=True)
class TreeLimits:
    """Bounds on a drawing, which may use what uses something else, and so on.

    Attributes:
        elements: that are drawn.
        depth: of elements in elements.
    """

    elements: int = 200_000
    depth: int = 200


TREE_LIMITS = TreeLimits()


def parsed_tree(data: bytes) -> ElementTree.Element:
    """Parse a drawing; names of its elements are without SVG's namespace.

    Args:
        data: of the file.

    Raises:
        UnreadableError: it is no XML.

    >>> parsed_tree(b'<svg xmlns="http://www.w3.org/2000/svg"/>').tag
    'svg'
    """
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        raise UnreadableError(f"line {error.position[0]}: {error.msg.partition(':')[0]}") from error
    except (LookupError, ValueError):  # an encoding that nobody knows
        root = ElementTree.fromstring(text_of(data))
    for element in root.iter():
        if isinstance(element.tag, str):
            element.tag = element.tag.removeprefix(SPACE)
    return root


def drawn_tree(root: ElementTree.Element, viewport: Viewport) -> ElementTree.Element:
    """Copy a drawing's tree with what is drawn where it stands; drawings in it become groups.

    Args:
        root: of the tree.
        viewport: of the drawing.

    Raises:
        UnreadableError: it is larger than `TREE_LIMITS` once uses are replaced.

    >>> root = parsed_tree(b'<svg><marker><path/></marker><line/></svg>')
    >>> [one.tag for one in drawn_tree(root, Viewport(1.0, 1.0))]
    ['line']
    """
    named = {element.get("id", ""): element for element in root.iter() if element.get("id")}
    return _Expansion(named).drawn(root, viewport, ())


class _Expansion:
    def __init__(self, named: dict[str, ElementTree.Element]) -> None:
        self._named = named
        self._elements = 0

    def drawn(
        self, element: ElementTree.Element, viewport: Viewport, inside: tuple[str, ...]
    ) -> ElementTree.Element:
        """A copy of an element without what is drawn elsewhere, uses replaced.

        Args:
            element: to copy.
            viewport: around it.
            inside: references to the elements around it, which may not be used in themselves.
        """
        self._elements += 1
        if self._elements > TREE_LIMITS.elements or len(inside) > TREE_LIMITS.depth:
            raise UnreadableError(
                f"it draws over {TREE_LIMITS.elements:,} elements, or over {TREE_LIMITS.depth} in one another"
            )
        attributes = viewport.without_percentages(element.attrib)
        tag = element.tag
        if tag in ("svg", "symbol") and inside:
            transform, viewport = nested_transform(attributes, viewport)
            attributes = {key: value for key, value in attributes.items() if key not in _OF_VIEWPORTS}
            tag, attributes["transform"] = "g", f"{attributes.get('transform', '')} {transform}".strip()
        kept = ElementTree.Element(tag, attributes)
        kept.text = element.text
        inside = (*inside, f"#{element.get('id', '')}")
        for child in element:
            if not isinstance(child.tag, str) or child.tag in DRAWN_ELSEWHERE:
                if child.tag == "defs":  # styles count wherever they stand
                    kept.extend(copy.deepcopy(style) for style in child.iter("style"))
            elif any(
                size not in child.attrib and size not in child.get("style", "") for size in _sizes(child)
            ):
                continue  # of no size, and so not drawn
            elif child.tag == "use":
                kept.extend(self._used(child, viewport, inside))
            else:
                kept.append(self.drawn(child, viewport, inside))
        return kept

    def _used(
        self, use: ElementTree.Element, viewport: Viewport, inside: tuple[str, ...]
    ) -> list[ElementTree.Element]:
        """The group that a use stands for: nothing where it uses nothing, or itself."""
        name = (use.get("href") or use.get(LINK) or "").strip()
        target = self._named.get(name.removeprefix("#"))
        if target is None or not name.startswith("#") or name in inside or len(inside) > TREE_LIMITS.depth:
            return []
        if target.tag in ("symbol", "svg"):
            sides = {side: use.get(side) or target.get(side) or "100%" for side in ("width", "height")}
            inner, target = target, ElementTree.Element("svg", dict(target.attrib) | sides)
            target.extend(inner)
        around = ElementTree.Element("g")
        around.append(target)
        drawn = self.drawn(around, viewport, (*inside, name))
        group = ElementTree.Element("g", {k: v for k, v in use.attrib.items() if k not in _OF_USES})
        x, y = length(use.get("x"), viewport.width, 0.0), length(use.get("y"), viewport.height, 0.0)
        group.set("transform", f"{use.get('transform', '')} translate({x!r}, {y!r})".strip())
        if use.get("id") and len(drawn) == 1 and drawn[0].tag in SHAPES:
            drawn[0].set("id", use.get("id", ""))
        group.append(drawn)
        return [group]


def _sizes(element: ElementTree.Element) -> tuple[str, ...]:
    """Attributes without which a shape has no size."""
    return {"rect": ("width", "height"), "circle": ("r",), "ellipse": ("rx", "ry")}.get(element.tag, ())


_OF_VIEWPORTS = frozenset({"x", "y", "width", "height", "viewBox", "preserveAspectRatio"})
_OF_USES = frozenset({"x", "y", "width", "height", "href", LINK, "id"})
