"""The commands on collections of shapes, as the command line sees them."""

from __future__ import annotations

from pathlib import Path

from cyclopts import App

from idviewer.cli.collection_options import CollectionOptions, ComparisonOptions, OutputOptions
from idviewer.cli.options import DistanceOptions, ReadingOptions


def add_to(app: App) -> None:
    """Add the commands to a command line."""
    app.command(batch)
    app.command(compare)


def batch(
    *files: str,
    out: Path,
    collection: CollectionOptions = CollectionOptions(),
    outputs: OutputOptions = OutputOptions(),
    options: DistanceOptions = DistanceOptions(),
    reading: ReadingOptions = ReadingOptions(),
) -> int:
    """Compute many shapes, on all cores or many machines; exit status 1 if some of them failed.

    What is in the folder of results already, made of the same files with the same options, is kept.

    Args:
        files: Files, folders, patterns such as "scans/*.ply", or names of bundled shapes.
        out: The folder of the results: a JSON file a shape, what else is asked for, and a table of all.
    """
    from idviewer.cli import batch_command

    return batch_command.run(files, out, collection, outputs, options, reading)


def compare(
    *files: str,
    wanted: ComparisonOptions = ComparisonOptions(),
    options: DistanceOptions = DistanceOptions(),
    reading: ReadingOptions = ReadingOptions(),
) -> int:
    """Print how much shapes differ by their descriptors, a matrix; exit status 1 if some could not be read.

    Args:
        files: Shapes, as `batch` takes them, its JSON files, or its folders of results.
    """
    from idviewer.cli import compare_command

    return compare_command.run(files, wanted, options, reading)
