"""The command `batch`: from its options to the tasks of a collection, and to an exit status."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from cyclopts import App, CycloptsError

from idviewer.cli import distance_options, parsing
from idviewer.cli.options import DisplayOptions, DistanceOptions, PictureQuery, ReadingOptions

if TYPE_CHECKING:
    from idviewer.batch import Entry, Listener, RunSettings, Summary, Task
    from idviewer.cli.collection_options import CollectionOptions, OutputOptions

DONE, SOME_FAILED, STOPPED = 0, 1, 130

NO_CACHE = "no_cache"
"""The one option of reading that changes no result."""

Group = TypeVar("Group", ReadingOptions, DistanceOptions)

row_app = App(help_flags=[], version_flags=[], result_action="return_value")
"""Reads the options of a manifest's row as the command line reads its own."""


@row_app.default
def _row(
    *, reading: ReadingOptions = ReadingOptions(), options: DistanceOptions = DistanceOptions()
) -> tuple[ReadingOptions, DistanceOptions]:
    return reading, options


def run(
    files: Sequence[str],
    out: Path,
    collection: CollectionOptions,
    outputs: OutputOptions,
    options: DistanceOptions,
    reading: ReadingOptions,
) -> int:
    """Carry out a collection; the exit status."""
    from idviewer.batch import RunSettings, check_parquet, shard_of, share_of

    _check(collection, outputs)
    if collection.parquet:
        check_parquet()
    shard = None if collection.shard is None else shard_of(collection.shard)
    tasks = tasks_of(listed(files, collection.manifest, out), outputs, reading, options)
    if shard is not None:
        tasks = share_of(tasks, *shard)
    settings = RunSettings(
        folder=out.absolute(),
        table="results" if shard is None else "results-{}-of-{}".format(*shard),
        parquet=collection.parquet,
        processes=collection.jobs,
        memory=None if collection.memory is None else 1e9 * collection.memory,
        scheduler=collection.scheduler,
    )
    summary = carried_out(tasks, settings, listener_of(collection.quiet))
    print("\n".join(str(path) for path in summary.tables))
    return STOPPED if summary.interrupted else SOME_FAILED if summary.failures else DONE


def carried_out(tasks: list[Task], settings: RunSettings, listener: Listener) -> Summary:
    """Carry out tasks, telling of it to somebody."""
    from idviewer.batch import run_collection
    from idviewer.cli import batch_work

    kinds = tuple(sorted({_kernels_of(task) for task in tasks}))
    prepare = partial(batch_work.prepare_kernels, kinds)
    return run_collection(tasks, batch_work.compute, prepare, settings, listener)


def _kernels_of(task: Task) -> tuple[int, str]:
    from idviewer.cli import shape_info

    return 2 if shape_info.is_polygon(task.path) else 3, str(task.options["distance"]["coordinates"])


def listener_of(quiet: bool) -> Listener:
    """Who tells of it on standard error: a bar in a terminal, lines elsewhere, or nobody."""
    from idviewer.batch import Bar, json_lines, nothing

    if quiet:
        return nothing
    return Bar(sys.stderr) if sys.stderr.isatty() else json_lines(sys.stderr)


def _check(collection: CollectionOptions, outputs: OutputOptions) -> None:
    """Refuse what cannot be, before anything is read or computed."""
    from idviewer.cli.batch_outputs import MAX_GRID_SIDE
    from idviewer.cli.collection_options import OutputOptions
    from idviewer.cli.commands import check_picture

    check_picture(outputs.query, outputs.display)
    if outputs.pictures:
        parsing.need_picture_libraries()
    elif (outputs.query, outputs.display) != (PictureQuery(), DisplayOptions()):
        raise ValueError("options of pictures are given, but no pictures are asked for; add --pictures")
    if outputs.grid_format != OutputOptions.grid_format and outputs.grids is None:
        raise ValueError(f"--grid-format {outputs.grid_format}: no grids are asked for; add --grids N")
    if collection.jobs is not None and collection.jobs < 1:
        raise ValueError(f"--jobs {collection.jobs}: at least one process is needed")
    if collection.memory is not None and not collection.memory > 0.0:
        raise ValueError(f"--memory {collection.memory:g}: give a number of gigabytes, such as --memory 8")
    if collection.scheduler is not None and (collection.jobs or collection.memory):
        raise ValueError(
            "--scheduler: its workers have their own number and memory; leave --jobs and --memory out"
        )
    if outputs.grids is not None and not 2 <= outputs.grids <= MAX_GRID_SIDE:
        raise ValueError(f"--grids {outputs.grids}: 2 to {MAX_GRID_SIDE} nodes along the longest side")


def listed(files: Sequence[str], manifest: Path | None, out: Path) -> list[Entry]:
    """The shapes that are named, by themselves, by folders and patterns, or in a manifest.

    Raises:
        ValueError: none are, or the manifest cannot be understood.
    """
    from idviewer.batch import entries_of, read_manifest, with_names
    from idviewer.batch.manifest import LANDMARKS
    from idviewer.view.vtk_files import register_vtk_reader

    register_vtk_reader()
    entries = entries_of(files, parsing.path_of, out)
    if manifest is not None:
        entries += read_manifest(manifest, [*_row_options(), LANDMARKS])
    if not entries:
        raise ValueError(
            "no shapes are named; name files, folders or patterns (of batch also --manifest LIST.csv)"
        )
    return with_names(entries)


def tasks_of(
    entries: Sequence[Entry], outputs: OutputOptions, reading: ReadingOptions, options: DistanceOptions
) -> list[Task]:
    """The tasks of a collection, each with all of its options.

    Raises:
        ValueError: an option means nothing.
    """
    distance_options.chosen_distance(options)
    return [_task(entry, outputs, reading, options) for entry in entries]


def _row_options() -> dict[str, str]:
    """Options that a row of a manifest may have, and the fields they fill."""
    return {
        field.name.replace("_", "-"): field.name
        for kind in (ReadingOptions, DistanceOptions)
        for field in dataclasses.fields(kind)
        if field.name != NO_CACHE
    }


def _task(entry: Entry, outputs: OutputOptions, reading: ReadingOptions, options: DistanceOptions) -> Task:
    """The task of an entry: the options of the command line, but for those of its own."""
    from idviewer.batch import Task
    from idviewer.batch.manifest import LANDMARKS

    own = {name: text for name, text in entry.options if name != LANDMARKS}
    if own:
        reading, options = _with_own(entry, own, reading, options)
    pattern = dict(entry.options).get(LANDMARKS, outputs.landmarks)
    landmarks = None if pattern is None else _landmarks(pattern, entry)
    inputs = [] if landmarks is None else [landmarks]
    wanted = {
        name: getattr(outputs, name) for name in ("pictures", "descriptors", "fields", "grids", "grid_format")
    }
    given, files = _with_absolute_files(dataclasses.asdict(options))
    read = dataclasses.asdict(reading)
    settings = {NO_CACHE: read.pop(NO_CACHE)}
    plain: dict[str, Any] = {
        "reading": read,
        "distance": given,
        "outputs": {**wanted, "landmarks": None if landmarks is None else str(landmarks)},
    }
    if outputs.pictures:
        plain |= {"query": dataclasses.asdict(outputs.query), "display": dataclasses.asdict(outputs.display)}
    return Task(entry.name, entry.path, plain, (*inputs, *files), entry.labels, settings)


def _with_own(
    entry: Entry, own: Mapping[str, str], reading: ReadingOptions, options: DistanceOptions
) -> tuple[ReadingOptions, DistanceOptions]:
    """The options of the command line, with those of a manifest's row in place of some."""
    texts = [f"--{name}={text.strip()}" for name, cell in own.items() for text in _texts(name, cell)]
    try:
        row_reading, row_options = row_app(texts, exit_on_error=False, print_error=False)
        fields = _row_options()
        changes = {fields[name] for name in own}
        merged = _merged(reading, row_reading, changes), _merged(options, row_options, changes)
        distance_options.chosen_distance(merged[1])
    except (CycloptsError, ValueError, OSError) as error:
        raise ValueError(f"{entry.where}: {' '.join(str(error).split())}") from error
    return merged


def _merged(given: Group, row: Group, changes: Collection[str]) -> Group:
    """Options with the changed ones of a row."""
    changed = {name: getattr(row, name) for name in changes if hasattr(row, name)}
    return dataclasses.replace(given, **changed)


def _texts(name: str, cell: str) -> list[str]:
    """The values of a cell; several settings are parted by semicolons."""
    return cell.split(";") if name == "set" else [cell]


def _landmarks(pattern: str, entry: Entry) -> Path:
    """The file of an entry's landmarks; a pattern in a manifest is relative to the shape's folder."""
    from idviewer.batch.inputs import stem_of

    filled = pattern.replace("{name}", entry.name).replace("{stem}", stem_of(entry.path))
    own = any(name == "landmarks" for name, _ in entry.options)
    return (entry.path.parent / filled if own else Path(filled)).absolute()


def _with_absolute_files(given: dict[str, Any]) -> tuple[dict[str, Any], list[Path]]:
    """Settings of a distance with its files named so that other processes find them, and these files."""
    from idviewer.core import DISTANCES, parameters_of
    from idviewer.core.distances import File

    kinds = parameters_of(DISTANCES[given["distance"]])
    settings, files = [], []
    for text in given["set"]:
        name, _, value = text.partition("=")
        if isinstance(kinds.get(name.strip()), File):
            files.append(Path(value).absolute())
            text = f"{name.strip()}={files[-1]}"
        settings.append(text)
    return {**given, "set": settings}, files
