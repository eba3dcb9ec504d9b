"""The report on a shape's file: sizes, what is wrong, and whether it can be used."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from idviewer.cli import discretisation, output, parsing
from idviewer.cli.options import EVERY_COMPONENT, BodyChoice

if TYPE_CHECKING:
    from idviewer.core import Polygon, Repairs, ShapeError
    from idviewer.core.shapes import Diagnosis
    from idviewer.core.spectrum import Refine

TITLE_WIDTH = 16
LISTED_COMPONENTS = 20
UNKNOWN_UNIT = "not told by the file"


def is_polygon(path: Path) -> bool:
    """Whether a file of that name holds a polygon."""
    from idviewer.core.io import readable_suffixes

    return path.suffix.lower() in readable_suffixes(2) and not path.is_dir()


def mesh(
    name: str, path: Path, choice: BodyChoice, repairs: Repairs, refine: Refine, json: bool
) -> tuple[str, bool]:
    """The report on a mesh or its components after repairs, in words or JSON, and whether it can be used."""
    from idviewer.core import ShapeError
    from idviewer.view.vtk_files import register_vtk_reader

    register_vtk_reader()
    try:
        bodies = _bodies(name, path, choice, repairs)
        found = [(title, *_of_mesh(title, path, body, repairs, refine)) for title, body in bodies]
    except ShapeError as error:
        if not error.parts:
            raise
        return _several("mesh", name, error, json), False
    usable = all(fit for *_, fit in found)
    if EVERY_COMPONENT not in (choice.component, choice.part):
        _, content, text, _ = found[0]
        return (output.as_json({"mesh": name, **content}) if json else text), usable
    if json:
        listed = [{"name": title, "component": n, **told} for n, (title, told, *_) in enumerate(found, 1)]
        return output.as_json({"mesh": name, "usable": usable, "components": listed}), usable
    return "\n\n".join(text for _, _, text, _ in found), usable


def _bodies(name: str, path: Path, choice: BodyChoice, repairs: Repairs) -> Iterable[tuple[str, BodyChoice]]:
    """The bodies that are meant, each with its title."""
    from idviewer.core.io import inspect_file

    for part in parsing.parts_of(path) if choice.part == EVERY_COMPONENT else [choice.part]:
        title = name if part is None or choice.part != EVERY_COMPONENT else f"{name}, part {part}"
        if choice.component != EVERY_COMPONENT:
            yield title, BodyChoice(choice.component, part)
            continue
        count = max(1, len(inspect_file(path, part, repairs, 1).component_list))
        for one in range(1, count + 1):
            yield f"{title}, component {one}", BodyChoice(str(one), part)


def _of_mesh(
    name: str, path: Path, choice: BodyChoice, repairs: Repairs, refine: Refine
) -> tuple[dict[str, Any], str, bool]:
    """What JSON and words tell of a mesh, or of one of its components, and whether it can be used."""
    from idviewer.core.io import read_body

    outcome = read_body(path, parsing.component_of(choice.component), choice.part).repaired(repairs)
    diagnosis = outcome.diagnosis
    content: dict[str, Any] = {}
    lines: tuple[tuple[str, str], ...] = ()
    if diagnosis.usable:
        content, lines = discretisation.of_shape(outcome.mesh_from(str(path)), refine)
    return {**diagnosis.as_dict(), **content}, _report(name, diagnosis, lines), diagnosis.usable


def _several(kind: str, name: str, error: ShapeError, json: bool) -> str:
    """The report on a file of several shapes: all of them, by which they can be chosen."""
    if json:
        shapes = [{"name": part.name, "description": part.description} for part in error.parts]
        return output.as_json({kind: name, "usable": False, "problem": str(error), "shapes": shapes})
    width = max(len(part.name) for part in error.parts)
    lines = [_line("shape", f"{part.name:<{width}}  {part.description}") for part in error.parts]
    return "\n".join([name, _line("problem", str(error)), *lines, _line("usable", "no")])


def polygon(
    name: str, path: Path, choice: BodyChoice, repairs: Repairs, refine: Refine, json: bool
) -> tuple[str, bool]:
    """The report on a polygon, in words or JSON, and whether it can be used."""
    from idviewer.core import Polygon, PolygonError, read_shape

    if choice.component is not None:
        raise ValueError(f"{name}: a polygon has no components; leave --component out")
    try:
        made = read_shape(path, part=choice.part, repairs=repairs)
        assert isinstance(made, Polygon)
    except PolygonError as error:
        problem = str(error)
        if error.parts:
            return _several("polygon", name, error, json), False
        if json:
            return output.as_json({"polygon": name, "usable": False, "problem": problem}), False
        return "\n".join([name, _line("problem", problem), _line("usable", "no")]), False
    content, lines = discretisation.of_shape(made, refine)
    if json:
        return output.as_json({"polygon": name, "usable": True, **_polygon_sizes(made), **content}), True
    sizes = (
        ("vertices", f"{len(made.vertices):,}"),
        ("loops", f"{len(made.loops)} ({_holes(made)})"),
        ("bounding box", _box(made.bounds.tolist())),
        ("unit", made.unit or UNKNOWN_UNIT),
        ("area", f"{made.area:.6g}"),
        ("perimeter", f"{made.perimeter:.6g}"),
        *lines,
    )
    notes = [_line("note", note) for note in made.notes] or [_line("faults", "none")]
    return "\n".join([name, *(_line(*size) for size in sizes), *notes, _line("usable", "yes")]), True


def health(path: Path, part: str | None, repairs: Repairs) -> dict[str, Any]:
    """Sizes of a shape and what is wrong with it, for JSON; nothing is computed on its boundary.

    Raises:
        ShapeError: the file cannot be read, or what it holds is no polygon.
    """
    from idviewer.core import Polygon, read_shape
    from idviewer.core.io import inspect_file

    if not is_polygon(path):
        return inspect_file(path, part, repairs).as_dict()
    made = read_shape(path, part=part, repairs=repairs)
    assert isinstance(made, Polygon)
    return {"usable": True, **_polygon_sizes(made)}


def _polygon_sizes(made: Polygon) -> dict[str, object]:
    return {
        "vertices": len(made.vertices),
        "loops": [len(loop) for loop in made.loops],
        "area": made.area,
        "perimeter": made.perimeter,
        "bounds": made.bounds,
        "notes": made.notes,
        "unit": made.unit,
    }


def _holes(made: Polygon) -> str:
    count = len(made.loops) - 1
    return f"{count} hole{'' if count == 1 else 's'}" if count else "no holes"


def _line(title: str, value: str) -> str:
    return f"  {title:<{TITLE_WIDTH}}{value}"


def _box(corners: Iterable[Iterable[float]]) -> str:
    lower, upper = ("(" + ", ".join(f"{value:.6g}" for value in corner) + ")" for corner in corners)
    return f"{lower} to {upper}"


def _report(name: str, diagnosis: Diagnosis, more: Iterable[tuple[str, str]]) -> str:
    sizes = (*_sizes(diagnosis), *more)
    lines = [name, *(f"  {title:<{TITLE_WIDTH}}{value}" for title, value in sizes)]
    for finding in diagnosis.findings:
        incurable = "a repair mends it, see below" if diagnosis.advice else "cannot be mended"
        fate = (
            (not diagnosis.advice and finding.remedy) or incurable
            if finding.fatal
            else f"is {finding.repair} when it is opened"
        )
        lines.append(f"  {'problem' if finding.fatal else 'note':<{TITLE_WIDTH}}{finding.message}; {fate}")
    lines += [_line("note", note) for note in diagnosis.notes]
    if diagnosis.advice:
        lines.append(_line("repair", f"idviewer repair {name} OUT {diagnosis.advice}"))
    if not diagnosis.findings:
        lines.append(f"  {'faults':<{TITLE_WIDTH}}none")
    lines.append(f"  {'usable':<{TITLE_WIDTH}}{'yes' if diagnosis.usable else 'no'}")
    return "\n".join(lines)


def _sizes(diagnosis: Diagnosis) -> Iterable[tuple[str, str]]:
    from idviewer.core.memory import bytes_in_words
    from idviewer.core.spectrum import needed_bytes

    yield "vertices", f"{diagnosis.vertices:,}"
    yield "faces", f"{diagnosis.faces:,}"
    yield "edges", f"{diagnosis.edges:,}"
    yield "components", f"{len(diagnosis.components)}"
    if len(diagnosis.component_list) > 1:
        for one in diagnosis.component_list[:LISTED_COMPONENTS]:
            yield "  component", str(one)
        if (more := len(diagnosis.component_list) - LISTED_COMPONENTS) > 0:
            yield "", f"and {more:,} more"
    if len(diagnosis.shells) > 1:
        yield (
            "shells",
            ", ".join(f"{faces:,}" for faces in diagnosis.shells[:8])
            + (" faces" if len(diagnosis.shells) <= 8 else ", ... faces"),
        )
    if diagnosis.genus is not None:
        yield "genus", f"{diagnosis.genus}"
    if diagnosis.boundary_loops:
        yield "boundary loops", f"{diagnosis.boundary_loops}"
    if diagnosis.bounds is not None:
        yield "bounding box", _box(diagnosis.bounds)
    yield "unit", diagnosis.unit or UNKNOWN_UNIT
    yield "area", f"{diagnosis.area:.6g}"
    if diagnosis.volume is not None:
        yield "volume", f"{diagnosis.volume:.6g}"
    if diagnosis.usable:
        yield (
            "memory",
            f"about {bytes_in_words(needed_bytes(diagnosis.vertices))} to open it{_too_much(diagnosis)}",
        )


def _too_much(diagnosis: Diagnosis) -> str:
    from idviewer.core.memory import bytes_in_words
    from idviewer.core.spectrum import available_bytes, needed_bytes, vertices_for

    if needed_bytes(diagnosis.vertices) <= (there := available_bytes()):
        return ""
    return (
        f"; this machine has {bytes_in_words(there)}: simplify it to about {vertices_for(there):,} vertices"
    )
