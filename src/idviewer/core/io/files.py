"""From a path to bytes, whatever the path may be."""

from __future__ import annotations

import stat
from collections.abc import Sequence
from pathlib import Path

from idviewer.core.io.text import UnreadableError


def bytes_of(path: Path, kind: str, unfit: str, suffixes: Sequence[str]) -> bytes:
    """What a file holds.

    Args:
        path: of the file.
        kind: of shape that is looked for, for messages.
        unfit: what there is to say of files with another suffix.
        suffixes: those of the files that are read.

    Raises:
        UnreadableError: there is no such file, it cannot be read, or there is nothing in it.
    """
    try:
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise UnreadableError(f"this is a folder; name a {kind} file in it")
        if not stat.S_ISREG(mode):
            raise UnreadableError("this is no ordinary file")
        if path.suffix.lower() not in suffixes:
            raise UnreadableError(wrong_suffix(path, unfit, suffixes))
        data = path.read_bytes()
    except UnreadableError:
        raise
    except FileNotFoundError as error:
        raise UnreadableError("there is no such file") from error
    except (OSError, ValueError) as error:  # a name that no file can have is a ValueError
        cause = getattr(error, "strerror", None) or error
        raise UnreadableError(f"the file cannot be read ({cause})") from error
    if not data.strip():
        raise UnreadableError("the file is empty; export it again")
    return data


def wrong_suffix(path: Path, unfit: str, suffixes: Sequence[str]) -> str:
    """What to do about a suffix that no reader is for.

    >>> wrong_suffix(Path("a.doc"), "cannot be read", (".off", ".obj"))
    "'.doc' files cannot be read; save it as one of .off, .obj"
    """
    suffix = path.suffix.lower()
    what = f"'{told(suffix)}' files {unfit}" if suffix else "a suffix must tell the file's format"
    return f"{what}; save it as one of {', '.join(suffixes)}"


def told(thing: object) -> str:
    """A path or a cause on one line, whatever it is made of."""
    return "".join(letter if letter.isprintable() else "?" for letter in str(thing))
