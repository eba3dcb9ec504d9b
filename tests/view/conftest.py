"""Windows are tested under Xvfb with Mesa's software renderer, and must leave nothing behind."""

from __future__ import annotations

import gc
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pytestqt.qtbot import QtBot

if TYPE_CHECKING:
    from PySide6.QtWidgets import QWidget
    from tests.view.mouse import Mouse

# Before Qt's first look at them.
os.environ["QT_QPA_PLATFORM"] = "xcb"
os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
os.environ.pop("WAYLAND_DISPLAY", None)

NO_XVFB = (
    "the window tests need Xvfb, and there is none: `make test` installs it, or `apt-get install xvfb`; "
    "to watch them on your own screen instead, run pytest with --no-xvfb"
)
PATIENCE = 300_000
"""Milliseconds for whatever a test waits for, the compilation of kernels included."""
PASSED: pytest.StashKey[bool] = pytest.StashKey()


@pytest.fixture(scope="session", autouse=True)
def screen(pytestconfig: pytest.Config, xvfb: object) -> None:
    """Fails every test of this folder, and skips none, where there is no Xvfb."""
    wanted_real_screen = pytestconfig.getoption("--no-xvfb") and "DISPLAY" in os.environ
    if xvfb is None and not wanted_real_screen:
        pytest.fail(NO_XVFB, pytrace=False)


@pytest.fixture(scope="session", autouse=True)
def own_settings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Keeps what windows remember (recent files, sizes) out of the user's own settings."""
    folder = tmp_path_factory.mktemp("settings")
    os.environ["XDG_CONFIG_HOME"] = str(folder)
    return folder


class PatientBot(QtBot):
    """Gives a busy machine time: what it waits for fails a test by never coming, not by coming late."""

    def waitUntil(self, callback: Callable[[], bool | None], *, timeout: int = PATIENCE) -> None:  # noqa: N802
        """As pytest-qt's, whose 5 seconds are few while other programs run."""
        super().waitUntil(callback, timeout=timeout)

    def waitExposed(self, widget: QWidget, *, timeout: int = PATIENCE) -> AbstractContextManager[None]:  # noqa: N802
        """Likewise."""
        return super().waitExposed(widget, timeout=timeout)


@pytest.fixture
def qtbot(qapp: object, request: pytest.FixtureRequest) -> QtBot:
    """In place of pytest-qt's own."""
    return PatientBot(request)


@pytest.fixture
def mouse(qtbot: QtBot) -> Iterator[Mouse]:
    """The X server's mouse and keyboard."""
    from tests.view.mouse import Mouse

    mouse = Mouse(qtbot)
    yield mouse
    mouse.close()


@pytest.fixture(scope="session", autouse=True)
def seen_again() -> Iterator[None]:
    """Lets the collector see at the end what the tests of this folder have hidden from it."""
    yield
    gc.unfreeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """Remembers whether a test passed: one that failed keeps its windows alive in the traceback."""
    report = yield
    if report.when == "call":
        item.stash[PASSED] = report.passed
    return report


@pytest.fixture(autouse=True)
def no_leaks(request: pytest.FixtureRequest, screen: None) -> Iterator[None]:
    """After each test nothing that it made may live on: no window, interactor, render window or thread."""
    gc.collect()
    gc.freeze()  # what lives already is out of the collector's sight: looking through all of it takes seconds
    before = _living()
    yield
    _finish_qt()
    if request.node.stash.get(PASSED, False):
        gc.collect()
        left = {name for key, name in _living().items() if key not in before}
        if left:
            pytest.fail(f"left behind by the test: {', '.join(sorted(left))}", pytrace=False)


def _living() -> dict[int, str]:
    """What a test must not leave behind, by identity, as far as the collector sees it."""
    from PySide6.QtWidgets import QApplication
    from pyvistaqt import QtInteractor
    from shiboken6 import getCppPointer
    from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkRenderWindowInteractor

    kinds = (QtInteractor, vtkRenderWindow, vtkRenderWindowInteractor)
    found = [thing for thing in gc.get_objects() if _is(thing, kinds)] + threading.enumerate()
    widgets = QApplication.topLevelWidgets() if QApplication.instance() else []
    # Python's wrapper of a widget that Qt owns may be made anew at each look; the widget stays where it is.
    return {id(thing): _describe(thing) for thing in found} | {
        getCppPointer(widget)[0]: _describe(widget) for widget in widgets
    }


def _is(thing: object, kinds: tuple[type, ...]) -> bool:
    # By type: isinstance asks proxies for their class, and dead weak proxies answer with an error.
    return issubclass(type(thing), kinds)


def _describe(thing: object) -> str:
    name = f" {thing.name!r}" if isinstance(thing, threading.Thread) else ""
    return f"{type(thing).__name__}{name}"


def _finish_qt() -> None:
    """Runs what Qt has pending, deletions asked for with deleteLater included."""
    from PySide6.QtCore import QEvent
    from PySide6.QtWidgets import QApplication

    application = QApplication.instance()
    for _ in range(2 if application else 0):
        application.processEvents()
        application.sendPostedEvents(None, QEvent.Type.DeferredDelete)
