"""The menu line that clears the cache: says how much there is, and afterwards how much is gone."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from idviewer.core.memory import bytes_in_words
from idviewer.session import SpectrumCache

NO_CACHE_TIP = "The program was started without a cache"


def show_cache_size(action: QAction, cache: SpectrumCache | None) -> None:
    """Have a menu's line tell the cache's size whenever the menu opens; without a cache, disable it."""
    if cache is None:
        action.setEnabled(False)
        action.setToolTip(NO_CACHE_TIP)
        return
    action.setToolTip(f"Eigenpairs of shapes seen before, in {cache.folder}")
    menu, text = action.parent(), action.text()
    assert isinstance(menu, QMenu)
    menu.aboutToShow.connect(lambda: action.setText(f"{text} ({in_words(cache.size)})"))


def clear_cache(cache: SpectrumCache | None, tell: Callable[[str], object]) -> None:
    """Clear the cache and tell what that freed."""
    if cache is None:
        return
    freed = cache.clear()
    tell(f"The cache is empty; {in_words(freed)} freed" if freed else "The cache was empty")


def in_words(size: int) -> str:
    """A number of bytes.

    >>> [in_words(size) for size in (0, 25_612_288)]
    ['empty', '26 MB']
    """
    return "empty" if size == 0 else bytes_in_words(size)
