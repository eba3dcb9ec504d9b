"""Result files: one JSON file a shape, written last, by which an earlier result is known to be whole.

A result is kept as long as its key is the same: a hash of the bytes of the files that it was made from, of
the options and of the program's version. Its digest covers all that is the same wherever it is
computed again.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import re
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import idviewer
from idviewer.batch.task import Made, Task
from idviewer.core.io import PART_SUFFIX, atomic_path
from idviewer.core.spectrum import SOLVER_VERSION

RESULT_VERSION = 1
"""To be raised when what results hold, or its meaning, changes: those of before are then computed again."""

RESULT_SUFFIX = ".json"
UNREPEATABLE = ("picture",)
"""Files whose bytes may differ between machines: cards and drivers round in their own ways."""

COMPANIONS = {
    ".gltf": re.compile(rb'"uri"\s*:\s*"(?!data:)([^"]+)"'),
    ".mhd": re.compile(rb"(?m)^\s*ElementDataFile\s*=\s*(\S+)\s*$"),
    ".nhdr": re.compile(rb"(?mi)^\s*data ?file\s*:\s*(\S+)\s*$"),
}
"""Formats whose files name others that belong to them."""

DAY_SECONDS = 86400.0
LIBRARIES = ("numpy", "scipy", "numba")


def content_key(task: Task) -> str:
    """A hash of everything that the task's result depends on.

    Raises:
        OSError: a file is not there, or cannot be read.
    """
    digest = hashlib.blake2b(digest_size=20)
    made_by = [idviewer.__version__, SOLVER_VERSION, RESULT_VERSION, task.path.suffix.lower()]
    digest.update(as_json([made_by, task.options]).encode())
    for path in _files_of(task):
        digest.update(hash_of(path).encode())
    return digest.hexdigest()


def _files_of(task: Task) -> Iterable[Path]:
    yield task.path
    if names := COMPANIONS.get(task.path.suffix.lower()):
        for name in sorted(set(names.findall(task.path.read_bytes()))):
            companion = task.path.parent / unquote(os.fsdecode(name))
            if companion.is_file():
                yield companion
    yield from task.inputs


def hash_of(path: Path) -> str:
    """The hash of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=20)).hexdigest()


def kept_content(folder: Path, name: str, key: str) -> dict[str, Any] | None:
    """The content of an earlier result with that key, if it and all of its files are there and whole."""
    content = content_of(folder / f"{name}{RESULT_SUFFIX}")
    if content is None or content.get("key") != key or "result" not in content:
        return None
    try:
        files = content["files"].values()
        whole = all(hash_of(folder / one["name"]) == one["hash"] for one in files)
        return content if whole and content["digest"] == _digest(content) else None
    except (AttributeError, KeyError, TypeError, OSError):
        return None


def content_of(path: Path) -> dict[str, Any] | None:
    """What a result file holds; None if there is none, or if it is half of one."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None


def write_result(folder: Path, task: Task, key: str, made: Made, seconds: float) -> dict[str, Any]:
    """Write the result file of a task whose other files are there, and return what it holds.

    Raises:
        OSError: it cannot be written.
    """
    content: dict[str, Any] = {
        "name": task.name,
        "path": str(task.path),
        "key": key,
        "labels": dict(task.labels),
        "options": task.options,
        "result": made.result,
        "files": {kind: {"name": name, "hash": hash_of(folder / name)} for kind, name in made.files.items()},
        "made_by": {
            "idviewer": idviewer.__version__,
            "python": platform.python_version(),
            **{library: version(library) for library in LIBRARIES},
            "host": platform.node(),
            "process": os.getpid(),
            "seconds": {**made.seconds, "all": seconds},
            "finished": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        },
    }
    content = json.loads(as_json(content))
    content["digest"] = _digest(content)
    return _write(folder / f"{task.name}{RESULT_SUFFIX}", content)


def write_failure(folder: Path, task: Task, reason: str) -> None:
    """Write of a task that failed why, in place of an earlier result, which is of something else."""
    path = folder / f"{task.name}{RESULT_SUFFIX}"
    before = content_of(path) or {}
    for one in before.get("files", {}).values():
        # Only what lies in the folder: the file may be anybody's.
        if isinstance(one, dict) and (own := Path(str(one.get("name", ""))).name).startswith(task.name):
            with suppress(OSError):
                (folder / own).unlink()
    _write(path, {"name": task.name, "path": str(task.path), "error": reason})


def _write(path: Path, content: dict[str, Any]) -> dict[str, Any]:
    with atomic_path(path) as part:
        part.write_text(as_json(content) + "\n", encoding="utf-8")
    return content


def remove_parts(folder: Path, name: str | None = None) -> None:
    """Remove what a process that was ended left half-written.

    Args:
        folder: of the results.
        name: of the task that it was at; of all tasks by default, but then only what is older than a day,
            since another process may be writing now.
    """
    for path in folder.glob(f".*{PART_SUFFIX}"):
        with suppress(OSError):
            own = name is not None and path.name.startswith((f".{name}.", f".{name}-"))
            if own or (name is None and time.time() - path.stat().st_mtime > DAY_SECONDS):
                path.unlink()


def _digest(content: Mapping[str, Any]) -> str:
    """The hash of all of a result that is the same wherever it is computed."""
    files = {kind: one["hash"] for kind, one in content["files"].items() if kind not in UNREPEATABLE}
    text = as_json([content["key"], content["result"], files])
    return hashlib.blake2b(text.encode(), digest_size=20).hexdigest()


def as_json(content: Any) -> str:
    """JSON of plain values.

    Raises:
        ValueError: there is NaN or infinity among them, which JSON has no word for.
    """
    return json.dumps(content, ensure_ascii=False, allow_nan=False)
