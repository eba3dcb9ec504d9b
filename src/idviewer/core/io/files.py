"""Bytes of files, whatever a path may be."""

from __future__ import annotations

import stat
from pathlib import Path

from idviewer.core.io.formats import why_unreadable
from idviewer.core.io.text import UnreadableError


def bytes_of(path: Path, dimension: int) -> bytes:
    """Read a file.

    Args:
        path: of the file.
        dimension: of the shape that is looked for: 3 for a mesh, 2 for a polygon.

    Raises:
        UnreadableError: there is no such file, it cannot be read, or there is nothing in it.
    """
    try:
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            kind = "polygon" if dimension == 2 else "mesh"
            raise UnreadableError(f"this is a folder; name a {kind} file in it")
        if not stat.S_ISREG(mode):
            raise UnreadableError("this is no ordinary file")
        if problem := why_unreadable(path, dimension):
            raise UnreadableError(problem)
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
