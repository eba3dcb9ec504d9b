"""Work on one shape of a collection, as a worker process does it: what the single commands do, into files."""

from __future__ import annotations

import io
import json
from collections.abc import Generator, Mapping
from contextlib import contextmanager, redirect_stderr
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Any

from idviewer.cli import (
    batch_outputs,
    commands,
    discretisation,
    distance_options,
    output,
    parsing,
    shape_info,
)
from idviewer.cli.options import DisplayOptions, DistanceOptions, PictureQuery, ReadingOptions

if TYPE_CHECKING:
    from idviewer.batch import Made, Reserve, Task
    from idviewer.cli.batch_outputs import Floats
    from idviewer.core import InteriorDistance, Shape
    from idviewer.session import SpectrumCache


def prepare_kernels(kinds: tuple[tuple[int, str], ...]) -> None:
    """Compile the kernels for shapes of dimensions with coordinates, for all processes of this machine."""
    from idviewer.core.compilation import compile_steps
    from idviewer.core.steps import finish

    for dimension, coordinates in kinds:
        finish(compile_steps(dimension, coordinates))


class Stopwatch:
    """Seconds that stages take.

    Attributes:
        seconds: by the stages' names.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Generator[None, None, None]:
        """Measure what is done within."""
        began = perf_counter()
        yield
        self.seconds[name] = round(perf_counter() - began, 4)


def compute(task: Task, folder: Path, reserve: Reserve) -> Made:
    """Compute what is wanted of a shape, and write all files but the JSON one.

    Args:
        task: the shape; its options are those of `task_options`.
        folder: to write to.
        reserve: gets memory.
    """
    from idviewer.batch import Made
    from idviewer.core.spectrum import needed_bytes

    told, watch = io.StringIO(), Stopwatch()
    reading, chosen = _reading(task), distance_options.chosen_distance(_distance(task.options))
    wanted = task.options["outputs"]
    with redirect_stderr(told), _cache(reading.no_cache and wanted["pictures"], reading) as cache:
        with watch.stage("reading"):
            shape = parsing.shape_of(str(task.path), reading)
            health = shape_info.health(task.path, reading.part, parsing.repairs_of(reading))
        with watch.stage("distance"):
            solver = commands.solver_of(
                shape, chosen, cache, lambda refined: reserve(needed_bytes(len(refined.vertices)))
            )
        with watch.stage("barycentroid"):
            centre = solver.barycentroid()
            commands.print_remarks(commands.remarks_on_barycentroid(solver))
        with watch.stage("discretisation"):
            levels = discretisation.discretisation_of(solver)
            summary = None if levels is None else levels.summary
            commands.print_remarks(discretisation.warnings_of(summary))
        files: dict[str, str] = {}
        results = {
            **_sizes(shape),
            "discretisation": discretisation.as_json(summary),
            **batch_outputs.measures(solver, centre),
            **_wanted(task, folder, (solver, centre.point), files, watch),
        }
        commands.print_remarks(commands.remarks_on_weights(solver))
        if wanted["pictures"]:
            with watch.stage("picture"):
                files["picture"] = f"{task.name}.png"
                _draw(task.options, folder / files["picture"], shape, cache)
    results["remarks"] = _remarks(told.getvalue(), task.path)
    return Made(json.loads(output.as_json({**results, "info": health})), files, watch.seconds)


def _remarks(told: str, path: Path) -> list[str]:
    """What the commands told of values on standard error; notes on reading are the shape's own."""
    mark = "idviewer: "  # other threads may write there, too
    lines = [line.removeprefix(mark) for line in told.splitlines() if line.startswith(mark)]
    return [line for line in lines if not line.startswith(f"{path}: ")]


def _wanted(
    task: Task, folder: Path, found: tuple[InteriorDistance, Floats], files: dict[str, str], watch: Stopwatch
) -> dict[str, Any]:
    """Results that were asked for; the names of files that are written are added."""
    wanted, results = task.options["outputs"], {}
    solver, centre = found
    if wanted["descriptors"]:
        with watch.stage("descriptors"):
            results["descriptors"] = batch_outputs.descriptors(solver)
    if wanted["landmarks"]:
        with watch.stage("landmarks"):
            files["landmarks"] = f"{task.name}.landmarks.csv"
            results["landmarks"] = batch_outputs.write_landmarks(
                folder / files["landmarks"], solver, Path(wanted["landmarks"])
            )
    if wanted["fields"]:
        with watch.stage("fields"):
            files["fields"] = f"{task.name}.vtp"
            results["fields"] = batch_outputs.write_fields(folder / files["fields"], solver, centre)
    if wanted["grids"]:
        with watch.stage("grid"):
            files["grid"] = f"{task.name}.grid.{wanted['grid_format']}"
            results["grid"] = batch_outputs.write_grid(
                folder / files["grid"], solver, centre, wanted["grids"]
            )
    return results


def _reading(task: Task) -> ReadingOptions:
    return ReadingOptions(**task.options["reading"], **task.settings)


def _distance(options: Mapping[str, Any]) -> DistanceOptions:
    values = options["distance"]
    return DistanceOptions(**{**values, "set": tuple(values["set"])})


@contextmanager
def _cache(own: bool, reading: ReadingOptions) -> Generator[SpectrumCache | None, None, None]:
    """The cache of eigenpairs; one of the shape's own where a picture shall find them, but no other run."""
    if not own:
        yield commands.cache_of(reading.no_cache)
        return
    from idviewer.session import SpectrumCache

    with TemporaryDirectory(prefix="idviewer-") as name:
        yield SpectrumCache(Path(name), worth=0.0)


def _sizes(shape: Shape) -> dict[str, Any]:
    sizes = {
        name: getattr(shape, name)
        for name in ("area", "volume", "perimeter", "diagonal")
        if hasattr(shape, name)
    }
    return {
        "dimension": shape.dimension,
        "unit": shape.unit,
        "vertices": len(shape.vertices),
        "facets": len(shape.facets),
        **sizes,
        "notes": list(shape.notes),
    }


def _draw(options: Mapping[str, Any], path: Path, shape: Shape, cache: SpectrumCache | None) -> None:
    chosen = distance_options.chosen_distance(_distance(options))
    query = PictureQuery(**{**options["query"], "plane": tuple(options["query"]["plane"])})
    commands.draw_picture(shape, path, chosen, query, DisplayOptions(**options["display"]), cache)
