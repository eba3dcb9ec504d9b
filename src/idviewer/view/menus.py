"""The menu bar as a table: what there is, under which name, by which key."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import NamedTuple

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu


class Entry(NamedTuple):
    """One line of a menu: `name` is the call it makes, `flat` whether it means something for a polygon."""

    name: str
    text: str
    keys: str = ""
    flat: bool = True


FLAT_VIEW = "A polygon is flat and looked straight down on"
NO_SLICES = "A polygon is flat: all of it is shown, and nothing is sliced"
LINE, SAMPLES = Entry("", ""), Entry("samples", "Open &sample")
MENUS: dict[str, tuple[Entry, ...]] = {
    "&File": (
        Entry("open", "&Open…", "Ctrl+O"),
        SAMPLES,
        LINE,
        Entry("picture", "&Save picture…", "Ctrl+S"),
        LINE,
        Entry("clear_cache", "&Clear cache"),
        LINE,
        Entry("quit", "&Quit", "Ctrl+Q"),
    ),
    "&Edit": (
        Entry("undo", "&Undo moving a vertex", "Ctrl+Z"),
        Entry("redo", "&Redo moving a vertex", "Ctrl+Shift+Z"),
    ),
    "&View": (
        Entry("reset", "&Reset view", "R"),
        LINE,
        Entry("front", "&Front", "1", flat=False),
        Entry("back", "&Back", "2", flat=False),
        Entry("left", "&Left", "3", flat=False),
        Entry("right", "R&ight", "4", flat=False),
        Entry("top", "&Top", "5", flat=False),
        Entry("bottom", "B&ottom", "6", flat=False),
        Entry("face", "Face the &plane", "0", flat=False),
        Entry("upright", "Another axis &upwards", "A", flat=False),
        LINE,
        Entry("handle", "Show or hide the &handles", "H"),
        Entry("controls", "Show &controls", "F9"),
    ),
    "&Slice": (
        Entry("plane_x", "Normal to &x", "X", flat=False),
        Entry("plane_y", "Normal to &y", "Y", flat=False),
        Entry("plane_z", "Normal to &z", "Z", flat=False),
        Entry("through", "&Through the source", "T", flat=False),
        LINE,
        Entry("forward", "Push &forward", "PgUp", flat=False),
        Entry("backward", "Push &backward", "PgDown", flat=False),
        Entry("far_forward", "Push far forward", "Shift+PgUp", flat=False),
        Entry("far_backward", "Push far backward", "Shift+PgDown", flat=False),
        LINE,
        Entry("add_plane", "&Add a plane", "Ctrl+N", flat=False),
        Entry("remove_plane", "&Remove the plane", "Ctrl+Backspace", flat=False),
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
    samples: Mapping[str, Iterable[str]],
    open_sample: Callable[[str], object],
) -> dict[str, QAction]:
    """Builds the menus; returns the actions by name.

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


def suit(actions: Mapping[str, QAction], flat: bool) -> None:
    """Disables what means nothing for a polygon, and says why; enables it for a body."""
    for title, entries in MENUS.items():
        reason = NO_SLICES if title == "&Slice" else FLAT_VIEW
        for entry in entries:
            if not entry.flat:
                actions[entry.name].setEnabled(not flat)
                actions[entry.name].setToolTip(reason if flat else "")


def _add_samples(
    menu: QMenu, samples: Mapping[str, Iterable[str]], open_sample: Callable[[str], object]
) -> None:
    for group, names in samples.items():
        menu.addSection(group)
        for name in names:
            title = name.replace("_", " ").replace("-", " ").capitalize()
            menu.addAction(title).triggered.connect(partial(open_sample, name))
