"""The command `compare`: differences of shapes, from their files or from the results of `batch`."""

from __future__ import annotations

import csv
import io
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from idviewer.cli import batch_command, output, parsing
from idviewer.cli.options import DistanceOptions, ReadingOptions

if TYPE_CHECKING:
    from idviewer.batch.comparison import Compared, Comparison
    from idviewer.cli.collection_options import ComparisonOptions

EVERY_PART = "all"


def run(
    files: Sequence[str],
    wanted: ComparisonOptions,
    options: DistanceOptions,
    reading: ReadingOptions,
) -> int:
    """Compare shapes; the exit status."""
    from idviewer.batch.comparison import compare

    for path, check in (
        (wanted.picture, parsing.check_picture_path),
        (wanted.matrix, parsing.check_table_path),
    ):
        if path is not None:
            check(path)
    shapes, complaints = _shapes(files, wanted, options, reading)
    for complaint in complaints:
        print(f"idviewer: {complaint}; left out", file=sys.stderr)
    found = compare(shapes, wanted.with_size)
    parts = list(found.parts) if wanted.by == EVERY_PART else [wanted.by]
    table = _table(found, parts)
    if wanted.matrix is not None:
        from idviewer.core.io import atomic_path

        with atomic_path(wanted.matrix) as part:
            part.write_text(table + "\n", encoding="utf-8")
    if wanted.picture is not None:
        from idviewer.view.dendrogram import write_dendrogram

        title = "difference" + ("" if wanted.by == EVERY_PART else f" of {wanted.by}")
        write_dendrogram(wanted.picture, found.names, found.difference(parts), title)
    if wanted.json:
        print(output.as_json(_as_dict(found)))
    elif wanted.matrix is None:
        print(table)
    return batch_command.SOME_FAILED if complaints else batch_command.DONE


def _shapes(
    files: Sequence[str], wanted: ComparisonOptions, options: DistanceOptions, reading: ReadingOptions
) -> tuple[list[Compared], list[str]]:
    """The shapes, and complaints about those that cannot be compared."""
    from idviewer.batch import content_of
    from idviewer.batch.comparison import compared_of, is_result, results_in

    stored: list[tuple[Any, str]] = []
    shapes: list[str] = []
    for text in files:
        path = Path(text)
        results = results_in(path) if path.is_dir() else [path] if is_result(path) else []
        stored += [(content_of(one), str(one)) for one in results]
        shapes += [] if results else [text]
    own = (options, reading, wanted.jobs) != (DistanceOptions(), ReadingOptions(), None)
    if own and stored and not shapes:
        raise ValueError(
            "results are compared as they are: options of distances, reading and processes are for shapes; "
            "leave them out, or compute the results again"
        )
    compared: list[Compared] = []
    complaints: list[str] = []
    for content, where in [*stored, *(_computed(shapes, wanted, options, reading) if shapes else [])]:
        try:
            compared.append(compared_of(content, where))
        except ValueError as error:
            complaints.append(str(error))
    if len(compared) < 2 and complaints:
        raise ValueError(complaints[0])
    return compared, complaints


def _computed(
    shapes: Sequence[str], wanted: ComparisonOptions, options: DistanceOptions, reading: ReadingOptions
) -> list[tuple[Any, str]]:
    """Results of shapes, which leave no files, and where each shape is."""
    from idviewer.batch import RunSettings
    from idviewer.cli.collection_options import OutputOptions

    with TemporaryDirectory(prefix="idviewer-") as name:
        entries = batch_command.listed(shapes, None, Path(name))
        tasks = batch_command.tasks_of(entries, OutputOptions(descriptors=True), reading, options)
        settings = RunSettings(folder=Path(name), processes=wanted.jobs)
        listener = batch_command.listener_of(quiet=not sys.stderr.isatty())
        summary = batch_command.carried_out(tasks, settings, listener)
        if summary.interrupted:
            raise KeyboardInterrupt
        return [
            (outcome.content or {"error": outcome.reason}, str(outcome.task.path))
            for outcome in summary.outcomes
        ]


def _table(found: Comparison, parts: Sequence[str]) -> str:
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(["shape", *found.names])
    for name, row in zip(found.names, found.difference(parts).tolist(), strict=True):
        writer.writerow([name, *map(repr, row)])
    return lines.getvalue().rstrip("\n")


def _as_dict(found: Comparison) -> dict[str, Any]:
    return {
        "names": found.names,
        "differences": {EVERY_PART: found.difference(list(found.parts)), **found.parts},
        "sampling_errors": found.sampling_errors,
    }
