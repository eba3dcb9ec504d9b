"""The menu line that clears the cache: says how much there is, and afterwards how much is gone."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu

from idviewer.session.spectrum_cache import SpectrumCache

UNUSED = "The program was started without a cache"


def show_size(action: QAction, cache: SpectrumCache | None) -> None:
    """Has a menu's line tell the cache's size whenever the menu opens; without a cache, disables it."""
    if cache is None:
        action.setEnabled(False)
        action.setToolTip(UNUSED)
        return
    action.setToolTip(f"Eigenpairs of shapes seen before, in {cache.folder}")
    menu, text = action.parent(), action.text()
    assert isinstance(menu, QMenu)
    menu.aboutToShow.connect(lambda: action.setText(f"{text} ({in_words(cache.size)})"))


def clear(cache: SpectrumCache | None, tell: Callable[[str], object]) -> None:
    """Clears the cache and tells what that freed."""
    if cache is None:
        return
    freed = cache.clear()
    tell(f"The cache is empty; {in_words(freed)} freed" if freed else "The cache was empty")


def in_words(size: int) -> str:
    """A number of bytes.

    >>> [in_words(size) for size in (0, 4096, 25_612_288, 1_999_000_000)]
    ['empty', '4 KB', '26 MB', '2.0 GB']
    """
    if size == 0:
        return "empty"
    for unit, name in ((1e9, "GB"), (1e6, "MB")):
        if size >= unit:
            value = size / unit
            return f"{value:.0f} {name}" if value >= 10 else f"{value:.1f} {name}"
    return f"{size / 1e3:.0f} KB"
