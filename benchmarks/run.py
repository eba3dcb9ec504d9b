"""Times idviewer beside its peers and beside what it should reach: python benchmarks/run.py [MESH ...]

Ours and theirs take turns in the same run, and medians are compared, so that a busy machine disturbs both
alike. Errors are true ones, taken outside of the timed part. The tables go to standard output, everything
measured to benchmarks/results/latest.json; --readme puts the README's table in its place. Takes some twenty
minutes on two cores.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from types import ModuleType

import batch_growth
import drag
import event_loop
import growth
import gui
import machine
import memory
import opening
import overlaps
import preparation
import refinement
import sliders
import spectrum
import tree
import weights
from bodies import Body
from settings import Settings
from table import Row, markdown, put_into

from idviewer.core import read_mesh, sample_path
from idviewer.core.compilation import compile_steps
from idviewer.core.io.bundled_shapes import DEFAULT_SAMPLE
from idviewer.core.steps import finish

ROOT = Path(__file__).parents[1]
RESULTS = ROOT / "benchmarks" / "results" / "latest.json"
SHAPES = ("hand_2k", "hand", "hand_27k")
ARMADILLO = ROOT.parent / "shared" / "meshes" / "armadillo.obj"
SIZES = (2_500, 7_900, 27_000, 43_000, 134_000, 537_000)
SUBJECTS: dict[str, ModuleType] = {
    module.__name__: module
    for module in (
        weights,
        tree,
        drag,
        sliders,
        growth,
        gui,
        event_loop,
        memory,
        preparation,
        spectrum,
        opening,
        overlaps,
        refinement,
        batch_growth,
    )
}


def main() -> None:
    asked = parser()
    arguments = asked.parse_args()
    if arguments.readme and arguments.only:
        asked.error("--readme wants all subjects, not --only some")
    settings = settings_of(arguments)
    finish(compile_steps(3))
    tables: dict[str, list[Row]] = {}
    print(machine.description())
    for name in arguments.only or SUBJECTS:
        start = time.perf_counter()
        tables[name] = list(SUBJECTS[name].rows(settings))
        print(f"\n### {SUBJECTS[name].TITLE}\n\n{markdown(tables[name])}\n\n{SUBJECTS[name].NOTE}")
        print(f"({name}: {time.perf_counter() - start:.0f} s)", flush=True)
    text = readme_text(tables)
    print(f"\n### For the README\n\n{text}\n")
    write_json(arguments.out, tables)
    if arguments.readme:
        put_into(ROOT / "README.md", text)


def parser() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    made.add_argument("meshes", nargs="*", type=Path, help="further meshes to measure on")
    made.add_argument(
        "--only", nargs="+", choices=SUBJECTS, metavar="SUBJECT", help=f"of {', '.join(SUBJECTS)}"
    )
    made.add_argument(
        "--shapes", nargs="*", default=SHAPES, metavar="NAME", help="bundled shapes to measure on"
    )
    made.add_argument("--turns", type=int, default=5, help="repetitions; the median counts")
    made.add_argument("--poses", type=int, default=100, help="of a drag, random ones and consecutive ones")
    made.add_argument(
        "--doublings", type=int, default=3, help="of the body of the growth: 14K faces, 56K, ..."
    )
    made.add_argument(
        "--sizes", type=int, nargs="*", default=SIZES, metavar="N", help="vertices of bodies to open"
    )
    made.add_argument(
        "--patient", action="store_true", help="wait for peers that take a quarter of an hour too"
    )
    made.add_argument("--out", type=Path, default=RESULTS, help="where the JSON goes")
    made.add_argument("--readme", action="store_true", help="write the README's table")
    return made


def settings_of(arguments: argparse.Namespace) -> Settings:
    """Reads the meshes. The README tells of the default shape and of the largest body."""
    paths = [*map(sample_path, arguments.shapes), *arguments.meshes]
    if ARMADILLO.exists() and tuple(arguments.shapes) == SHAPES:
        paths.append(ARMADILLO)
    bodies = sorted((Body(read_mesh(path), path) for path in paths), key=lambda body: len(body.mesh.faces))
    for body in bodies:
        body.readme = body.mesh.name == DEFAULT_SAMPLE or body is bodies[-1]
    return Settings(
        tuple(bodies),
        arguments.turns,
        arguments.poses,
        arguments.doublings,
        tuple(arguments.sizes),
        arguments.patient,
    )


def readme_text(tables: dict[str, list[Row]]) -> str:
    """The README's table and where it was measured."""
    rows = [row for some in tables.values() for row in some if row.readme]
    missed = sum(row.reached is False for row in rows)
    bars = sum(row.bar is not None for row in rows)
    return f"{markdown(rows)}\n\n{machine.description()}. Of {bars} bars, {missed} are missed."


def write_json(path: Path, tables: dict[str, list[Row]]) -> None:
    """Everything measured; what was not reached is null."""
    path.parent.mkdir(exist_ok=True)
    beside = path.with_name(path.name + ".part")
    told = {name: [dict(_plain(row)) for row in rows] for name, rows in tables.items()}
    beside.write_text(
        json.dumps({"machine": machine.description(), "tables": told}, indent=2, allow_nan=False)
    )
    beside.replace(path)
    print(f"written: {path}")


def _plain(row: Row) -> Iterator[tuple[str, object]]:
    for name, value in {**asdict(row), "reached": row.reached}.items():
        yield name, _finite(value)


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {name: _finite(one) for name, one in value.items()}
    return [_finite(one) for one in value] if isinstance(value, tuple) else value


if __name__ == "__main__":
    main()
