"""Collections: one piece of work on many shapes, on all cores or many machines, and what was done is kept."""

from idviewer.batch.events import Bar, Listener, json_lines, nothing
from idviewer.batch.inputs import Entry, entries_of, shard_of, share_of, with_names
from idviewer.batch.manifest import read_manifest
from idviewer.batch.result_files import content_of
from idviewer.batch.result_table import check_parquet
from idviewer.batch.run import RunSettings, Summary, run_collection
from idviewer.batch.task import Made, Outcome, Reserve, Task, Work

__all__ = [
    "Bar",
    "Entry",
    "Listener",
    "Made",
    "Outcome",
    "Reserve",
    "RunSettings",
    "Summary",
    "Task",
    "Work",
    "check_parquet",
    "content_of",
    "entries_of",
    "json_lines",
    "nothing",
    "read_manifest",
    "run_collection",
    "shard_of",
    "share_of",
    "with_names",
]
