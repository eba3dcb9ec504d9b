"""What nobody expected of a window: exceptions, in whichever thread, and words of Qt and VTK."""

from __future__ import annotations

import logging
import sys
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QtMsgType, qInstallMessageHandler
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow


class Heard:
    """All that nobody expected: exceptions, in whichever thread, and words of Qt and VTK."""

    def __init__(self) -> None:
        self.complaints: list[str] = []

    @contextmanager
    def listen(self) -> Iterator[Heard]:
        """Listen for as long as the block runs."""
        handler = logging.Handler()
        handler.emit = self._take_record  # type: ignore[method-assign]
        hooks, window = (sys.excepthook, threading.excepthook), vtkOutputWindow.GetInstance()
        words = vtkStringOutputWindow()
        vtkOutputWindow.SetInstance(words)
        before = qInstallMessageHandler(self._take_message)
        sys.excepthook = lambda kind, error, trace: self.complaints.append(
            "".join(traceback.format_exception(kind, error, trace))[-1500:]
        )
        threading.excepthook = lambda told: self.complaints.append(f"thread: {told.exc_value!r}")
        logging.getLogger("idviewer").addHandler(handler)
        try:
            yield self
        finally:
            logging.getLogger("idviewer").removeHandler(handler)
            sys.excepthook, threading.excepthook = hooks
            qInstallMessageHandler(before)
            vtkOutputWindow.SetInstance(window)
            if words.GetOutput():
                self.complaints.append(f"VTK: {words.GetOutput()[:2000]}")

    def _take_record(self, record: logging.LogRecord) -> None:
        # The window logs a trace of what is a fault of the program's, and not of its input.
        if record.exc_info and record.exc_info[1] is not None:
            text = logging.Formatter().formatException(record.exc_info)
            self.complaints.append(f"log: {text[-1500:]}")

    def _take_message(self, kind: QtMsgType, _context: object, text: str) -> None:
        if kind not in (QtMsgType.QtDebugMsg, QtMsgType.QtInfoMsg):
            self.complaints.append(f"Qt: {text}")
