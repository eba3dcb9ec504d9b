"""The menu bar as a table: what there is, under which name, by which key."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import NamedTuple

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu


class Entry(NamedTuple):
    """One line of a menu; `name` is the call it makes."""

    name: str
    text: str
    keys: str = ""


LINE, SAMPLES = Entry("", ""), Entry("samples", "Open &sample")
MENUS: dict[str, tuple[Entry, ...]] = {
    "&File": (
        Entry("open", "&Open…", "Ctrl+O"),
        SAMPLES,
        LINE,
        Entry("picture", "&Save picture…", "Ctrl+S"),
        LINE,
        Entry("quit", "&Quit", "Ctrl+Q"),
    ),
    "&View": (
        Entry("reset", "&Reset view", "R"),
        LINE,
        Entry("front", "&Front", "1"),
        Entry("back", "&Back", "2"),
        Entry("left", "&Left", "3"),
        Entry("right", "R&ight", "4"),
        Entry("top", "&Top", "5"),
        Entry("bottom", "B&ottom", "6"),
        Entry("face", "Face the &plane", "0"),
        Entry("upright", "Another axis &upwards", "A"),
        LINE,
        Entry("controls", "Show &controls", "F9"),
    ),
    "&Slice": (
        Entry("plane_x", "Normal to &x", "X"),
        Entry("plane_y", "Normal to &y", "Y"),
        Entry("plane_z", "Normal to &z", "Z"),
        Entry("through", "&Through the source", "T"),
        LINE,
        Entry("forward", "Push &forward", "PgUp"),
        Entry("backward", "Push &backward", "PgDown"),
        Entry("far_forward", "Push far forward", "Shift+PgUp"),
        Entry("far_backward", "Push far backward", "Shift+PgDown"),
        LINE,
        Entry("add_plane", "&Add a plane", "Ctrl+N"),
        Entry("remove_plane", "&Remove the plane", "Ctrl+Backspace"),
        Entry("handle", "Show or hide the &handle", "H"),
    ),
    "&Compute": (
        Entry("at_barycentroid", "&Source at the barycentroid", "Shift+B"),
        Entry("barycentroid", "Show or hide the &barycentroid", "B"),
        Entry("quantity", "Distance or &potential", "U"),
        LINE,
        Entry("cancel", "&Cancel", "Esc"),
        Entry("resume", "Compute &again", "F5"),
    ),
    "&Help": (Entry("keys", "&Keys and mouse", "F1"), Entry("about", "&About idviewer")),
}


def fill_menu_bar(
    window: QMainWindow,
    calls: Mapping[str, Callable[[], object]],
    samples: Iterable[str],
    open_sample: Callable[[str], object],
) -> dict[str, QAction]:
    """Builds the menus; calls has one callable for each entry's name. Returns the actions by name."""
    actions: dict[str, QAction] = {}
    for title, entries in MENUS.items():
        menu = window.menuBar().addMenu(title)
        for entry in entries:
            if entry is LINE:
                menu.addSeparator()
            elif entry is SAMPLES:
                _add_samples(menu.addMenu(entry.text), samples, open_sample)
            else:
                actions[entry.name] = _action(menu, entry, calls[entry.name])
    return actions


def _action(menu: QMenu, entry: Entry, call: Callable[[], object]) -> QAction:
    action = menu.addAction(entry.text)
    action.setObjectName(entry.name)
    if entry.keys:
        action.setShortcut(QKeySequence(entry.keys))
    action.triggered.connect(lambda: call())
    return action


def _add_samples(menu: QMenu, samples: Iterable[str], open_sample: Callable[[str], object]) -> None:
    for name in samples:
        title = name.replace("_", " ").replace("-", " ").capitalize()
        menu.addAction(title).triggered.connect(partial(open_sample, name))
