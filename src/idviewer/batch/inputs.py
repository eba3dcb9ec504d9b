"""Shapes of a collection: from files, folders and patterns to entries with names, and shares of them."""

from __future__ import annotations

import glob
import hashlib
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol, TypeVar

from idviewer.core.io import readable_suffixes

AMBIGUOUS_SUFFIXES = (".csv", ".json", ".txt", ".npy", ".npz")
"""Of files that may hold anything: in folders they are passed over, and taken where they are named."""

PATTERN = re.compile(r"[*?\[]")
UNFIT_IN_NAMES = re.compile(r'[\\/:*?"<>|\x00-\x1f]')
SHARD = re.compile(r"(\d+)\s*/\s*(\d+)")
DISTINCT_LETTERS = 8


class HasName(Protocol):
    """Has a name."""

    @property
    def name(self) -> str:
        """Of its results."""


Named = TypeVar("Named", bound=HasName)


@dataclass(frozen=True)
class Entry:
    """One shape as it is listed.

    Attributes:
        path: of its file, absolute.
        name: of its results; the file's name without its suffix where none is given.
        options: by name, texts as the command line takes them.
        labels: columns of the manifest that are no options.
        where: it is listed, for errors.
    """

    path: Path
    name: str = ""
    options: tuple[tuple[str, str], ...] = ()
    labels: dict[str, str] = field(default_factory=dict, compare=False, hash=False)
    where: str = field(default="", compare=False)


def entries_of(texts: Sequence[str], resolve: Callable[[str], Path], results: Path) -> list[Entry]:
    """Entries of files, folders (with all folders in them) and patterns such as "scans/*.ply", in this order.

    Args:
        texts: as they are given.
        resolve: from the name of a bundled shape to its file; it raises FileNotFoundError.
        results: a folder that is passed over in others, since what lies in it is made of shapes.

    Raises:
        ValueError: nothing fits a pattern, or a folder holds no shapes.
    """
    paths: list[Path] = []
    for text in texts:
        path = Path(text)
        if path.is_dir():
            paths += _shapes_in(path, results.absolute())
        elif path.exists() or not PATTERN.search(text):
            paths.append(_resolved(text, resolve))
        else:
            found = sorted(map(Path, glob.glob(text, recursive=True)))
            if not found:
                raise ValueError(f"{text}: no file has such a name")
            paths += [one for one in found if one.is_file()]
    return [Entry(path.absolute()) for path in paths]


def _resolved(text: str, resolve: Callable[[str], Path]) -> Path:
    try:
        return resolve(text)
    except FileNotFoundError:
        return Path(text)  # reading it will tell; the others are not to wait for that


def _shapes_in(folder: Path, results: Path) -> list[Path]:
    suffixes = tuple(one for one in readable_suffixes() if one not in AMBIGUOUS_SUFFIXES)
    found = [
        path
        for path in sorted(folder.rglob("*"))
        if path.name.lower().endswith(suffixes)
        and path.is_file()
        and results not in path.absolute().parents
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
    ]
    if not found:
        raise ValueError(
            f"{folder}: there are no shapes in this folder; files of {', '.join(suffixes)} are looked for, "
            'and those of other formats are taken where they are named, such as "folder/*.csv"'
        )
    return found


def with_names(entries: Iterable[Entry]) -> list[Entry]:
    """Entries with names that are all different; what is listed twice with the same options is left out once.

    Where files have the same name, as in several folders, some letters of a hash of their paths are added.

    Raises:
        ValueError: two would have the same name all the same, or one cannot be a file's.
    """
    distinct = list(dict.fromkeys(entries))
    named = [replace(entry, name=_fit_name(entry)) for entry in distinct]
    for same in _same_names(named):
        for number in same:
            if not distinct[number].name:
                mark = hashlib.blake2b(str(named[number].path).encode(), digest_size=16).hexdigest()
                name = f"{named[number].name}-{mark[:DISTINCT_LETTERS]}"
                named[number] = replace(named[number], name=name)
    for first, second, *_ in _same_names(named):
        raise ValueError(
            f"{named[second].where or named[second].path}: its results would have the same name as those of "
            f"{named[first].where or named[first].path}, {named[first].name!r}; give each its own in a "
            "column `name` of a manifest"
        )
    return named


def _fit_name(entry: Entry) -> str:
    """The name that is given, or one made of the file's."""
    name = entry.name or stem_of(entry.path)
    if not (UNFIT_IN_NAMES.search(name) or name.startswith(".") or name != name.strip()):
        return name
    if entry.name:
        raise ValueError(f"{entry.where}: the name {name!r} cannot be that of a file; choose another")
    return UNFIT_IN_NAMES.sub("_", name).strip(" .") or "shape"


def _same_names(entries: Sequence[Entry]) -> list[list[int]]:
    """Numbers of entries that have a name in common; there are file systems that know no capitals."""
    met: dict[str, list[int]] = defaultdict(list)
    for number, entry in enumerate(entries):
        met[entry.name.casefold()].append(number)
    return [numbers for numbers in met.values() if len(numbers) > 1]


def stem_of(path: Path) -> str:
    """A file's name without its suffix, also where that has two parts.

    >>> stem_of(Path("brain.nii.gz")), stem_of(Path("a.b.ply"))
    ('brain', 'a.b')
    """
    stem = path.name.removesuffix(".gz") if path.name.lower().endswith(".nii.gz") else path.name
    return Path(stem).stem or path.name


def shard_of(text: str) -> tuple[int, int]:
    """Number of a share, from 1, and how many shares there are.

    Raises:
        ValueError: it is no such thing.

    >>> shard_of("3/16")
    (3, 16)
    """
    match = SHARD.fullmatch(text.strip())
    if match and 1 <= int(match[1]) <= int(match[2]):
        return int(match[1]), int(match[2])
    raise ValueError(
        f"--shard {text}: write which share of how many, from 1, such as --shard 3/16 "
        "(in a SLURM script with --array=1-16: --shard $SLURM_ARRAY_TASK_ID/16)"
    )


def share_of(listed: Sequence[Named], number: int, count: int) -> list[Named]:
    """A share of what has different names: the same whatever order it is listed in, and each is in one.

    Args:
        listed: entries, or tasks.
        number: of the share, from 1.
        count: of all shares, which differ in size by one at most.
    """
    mine = set(sorted(one.name for one in listed)[number - 1 :: count])
    return [one for one in listed if one.name in mine]
