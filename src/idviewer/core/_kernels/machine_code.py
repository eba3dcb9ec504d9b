"""Machine code of the kernels, kept on disk by the content of all their sources.

numba itself looks at the source of a kernel alone, and at the file's date: after a change of what it calls in
another file it would go on with the machine code of before, and compile again what was only copied. It ends
the program where nothing may be written, as in a container or with a full disk; kernels need not be kept.
"""

from __future__ import annotations

import hashlib
import logging
import os
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any
from uuid import uuid4

import platformdirs
from numba.core import caching, dispatcher

LOG = logging.getLogger("idviewer")


@cache
def sources_digest() -> str:
    """Digest of the sources of all kernels, but not of this file, which no kernel calls."""
    sources = sorted(path for path in Path(__file__).parent.rglob("*.py") if path.name != "machine_code.py")
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]


def wanted_folder() -> Path:
    """The folder where these sources' machine code belongs: NUMBA_CACHE_DIR, or the user's cache folder."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    root = Path(given) if given else platformdirs.user_cache_path("idviewer", False) / "kernels"
    return root / sources_digest()


@cache
def cache_folder() -> Path:
    """The folder where it is: a temporary one, of which a line is logged, where nothing may be written there.

    What an installation brought along in a folder that may only be read is copied. Where nothing may be
    written at all, kernels are compiled anew in each run.
    """
    wanted = wanted_folder()
    if _takes_files(wanted):
        return wanted
    temporary = _private_folder()
    why = f"idviewer: nothing can be written to {wanted.parent}; compiled kernels are"
    if temporary is None or not _takes_files(temporary / wanted.name):
        LOG.warning("%s not kept. NUMBA_CACHE_DIR can name a folder for them.", why)
        return wanted
    _copy_new(wanted, temporary / wanted.name)
    LOG.warning("%s kept in %s. NUMBA_CACHE_DIR can name another folder.", why, temporary)
    return temporary / wanted.name


def _takes_files(folder: Path) -> bool:
    """Whether a file can be written into a folder, which is made."""
    probe = folder / f"{uuid4().hex}.probe"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.write_bytes(b"0")
    except OSError:
        return False
    finally:
        with suppress(OSError):
            probe.unlink(missing_ok=True)
    return True


def _private_folder() -> Path | None:
    """A folder for temporary files that is the user's own; None where there is none.

    Machine code that is loaded is run: nobody else may have put it there.
    """
    user = os.getuid() if hasattr(os, "getuid") else "user"
    folder = Path(tempfile.gettempdir()) / f"idviewer-{user}"
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        status = folder.lstat()
    except OSError:
        return None
    if not stat.S_ISDIR(status.st_mode):
        return None
    if hasattr(os, "getuid") and (status.st_uid != user or status.st_mode & 0o077):
        return None
    return folder


def _copy_new(origin: Path, target: Path) -> None:
    """Copy files that are not there yet, as far as they can be read and written."""
    with suppress(OSError):
        for path in origin.iterdir():
            if not (target / path.name).exists():
                part = target / f"{path.name}.{uuid4().hex}"
                shutil.copyfile(path, part)
                os.replace(part, target / path.name)


class _FolderLocator(caching._CacheLocator):
    """Tells numba where a kernel's machine code is; it is valid as long as the sources are the same."""

    def __init__(self, kernel: Callable[..., Any]) -> None:
        self._module = kernel.__module__

    def get_cache_path(self) -> str:
        return str(cache_folder())

    def ensure_cache_path(self) -> None:
        cache_folder().mkdir(parents=True, exist_ok=True)

    def get_source_stamp(self) -> str:
        return sources_digest()

    def get_disambiguator(self) -> str:
        return hashlib.sha256(self._module.encode()).hexdigest()[:10]

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> _FolderLocator:
        return cls(py_func)


class _KernelCacheImpl(caching.CompileResultCacheImpl):
    _locator_classes: list[type[object]] = [_FolderLocator]  # noqa: RUF012 - as in the class above


class _KernelCache(caching.FunctionCache):
    """A cache that may fail: what cannot be read is compiled, what cannot be written is not kept."""

    _impl_class = _KernelCacheImpl

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # a damaged file can make unpickling raise anything
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        # An index that was damaged raises anything, too; the code is there and runs.
        with suppress(Exception):
            super().save_overload(sig, data)


@contextmanager
def kept_by_sources() -> Iterator[None]:
    """Have kernels that are defined within keep their machine code in `cache_folder`, and nobody else's."""
    numba_dispatcher: Any = dispatcher  # whose name for the class is not exported
    before = numba_dispatcher.FunctionCache
    numba_dispatcher.FunctionCache = _KernelCache
    try:
        yield
    finally:
        numba_dispatcher.FunctionCache = before
