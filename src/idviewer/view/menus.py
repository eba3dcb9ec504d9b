"""The menu bar as a table: entries, names and keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import NamedTuple

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu


class Entry(NamedTuple):
    """One line of a menu: `name` is the call it makes, `in_2d` whether it means something for a polygon."""

    name: str
    text: str
    keys: str = ""
    in_2d: bool = True


NO_3D_VIEWS_TIP = "A polygon is in_2d and looked straight down on"
NO_SLICES_TIP = "A polygon is in_2d: all of it is shown, and nothing is sliced"
MENU_SEPARATOR, SAMPLES_MENU = Entry("", ""), Entry("samples", "Open &sample")
MENUS: dict[str, tuple[Entry, ...]] = {
    "&File": (
        Entry("open", "&Open…", "Ctrl+O"),
        SAMPLES_MENU,
        MENU_SEPARATOR,
        Entry("picture", "&Save picture…", "Ctrl+S"),
        MENU_SEPARATOR,
        Entry("clear_cache", "&Clear cache"),
        MENU_SEPARATOR,
        Entry("quit", "&Quit", "Ctrl+Q"),
    ),
    "&Edit": (
        Entry("undo", "&Undo moving a vertex", "Ctrl+Z"),
        Entry("redo", "&Redo moving a vertex", "Ctrl+Shift+Z"),
    ),
    "&View": (
        Entry("reset", "&Reset view", "R"),
        MENU_SEPARATOR,
        Entry("front", "&Front", "1", in_2d=False),
        Entry("back", "&Back", "2", in_2d=False),
        Entry("left", "&Left", "3", in_2d=False),
        Entry("right", "R&ight", "4", in_2d=False),
        Entry("top", "&Top", "5", in_2d=False),
        Entry("bottom", "B&ottom", "6", in_2d=False),
        Entry("face", "Face the &plane", "0", in_2d=False),
        Entry("upright", "Another axis &upwards", "A", in_2d=False),
        MENU_SEPARATOR,
        Entry("handle", "Show or hide the &handles", "H"),
        Entry("controls", "Show &controls", "F9"),
        Entry("health", "&Health…", "F8", in_2d=False),
    ),
    "&Slice": (
        Entry("plane_x", "Normal to &x", "X", in_2d=False),
        Entry("plane_y", "Normal to &y", "Y", in_2d=False),
        Entry("plane_z", "Normal to &z", "Z", in_2d=False),
        Entry("through", "&Through the source", "T", in_2d=False),
        MENU_SEPARATOR,
        Entry("forward", "Push &forward", "PgUp", in_2d=False),
        Entry("backward", "Push &backward", "PgDown", in_2d=False),
        Entry("far_forward", "Push far forward", "Shift+PgUp", in_2d=False),
        Entry("far_backward", "Push far backward", "Shift+PgDown", in_2d=False),
        MENU_SEPARATOR,
        Entry("add_plane", "&Add a plane", "Ctrl+N", in_2d=False),
        Entry("remove_plane", "&Remove the plane", "Ctrl+Backspace", in_2d=False),
    ),
    "&Compute": (
        Entry("at_barycentroid", "&Source at the barycentroid", "Shift+B"),
        Entry("barycentroid", "Show or hide the &barycentroid", "B"),
        Entry("quantity", "Distance or &potential", "U"),
        MENU_SEPARATOR,
        Entry("cancel", "&Cancel", "Esc"),
        Entry("resume", "Compute &again", "F5"),
    ),
    "&Help": (Entry("keys", "&Keys and mouse", "F1"), Entry("about", "&About idviewer")),
}


def fill_menu_bar(
    window: QMainWindow,
    calls: Mapping[str, Callable[[], object]],
    samples: Mapping[str, Iterable[str]],
    open_sample: Callable[[str], object],
) -> dict[str, QAction]:
    """Build the menus and return the actions by name.

    Args:
        window: whose menu bar is filled.
        calls: one callable for each entry's name.
        samples: names of the bundled shapes by the title of their group.
        open_sample: called with the name of a bundled shape.
    """
    actions: dict[str, QAction] = {}
    for title, entries in MENUS.items():
        menu = window.menuBar().addMenu(title)
        menu.setToolTipsVisible(True)
        for entry in entries:
            if entry is MENU_SEPARATOR:
                menu.addSeparator()
            elif entry is SAMPLES_MENU:
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


def enable_for(actions: Mapping[str, QAction], in_2d: bool) -> None:
    """Disable what means nothing for a polygon, and say why; enable it for a body."""
    for title, entries in MENUS.items():
        reason = NO_SLICES_TIP if title == "&Slice" else NO_3D_VIEWS_TIP
        for entry in entries:
            if not entry.in_2d:
                actions[entry.name].setEnabled(not in_2d)
                actions[entry.name].setToolTip(reason if in_2d else "")


def _add_samples(
    menu: QMenu, samples: Mapping[str, Iterable[str]], open_sample: Callable[[str], object]
) -> None:
    for group, names in samples.items():
        menu.addSection(group)
        for name in names:
            title = name.replace("_", " ").replace("-", " ").capitalize()
            menu.addAction(title).triggered.connect(partial(open_sample, name))
