"""The window's dialogs. None blocks: each is shown and emits what was chosen."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QMessageBox,
    QPushButton,
    QSpinBox,
    QWidget,
)

from idviewer import __version__
from idviewer.core.io import readable_suffixes

ABOUT = """<h3>idviewer {version}</h3>
<p>Distances inside shapes: it carries a distance between points of a surface to the points inside,
and shows it on slices.</p>
<p>After R. M. Rustamov, Y. Lipman and T. Funkhouser, <i>Interior Distance Using Barycentric
Coordinates</i>, Computer Graphics Forum 28 (5), 2009.</p>"""


@dataclass(frozen=True)
class PictureRequest:
    """A picture to write: where, how large in pixels, and whether its background is transparent."""

    path: Path
    size: tuple[int, int]
    transparent: bool


class PictureDialog(QDialog):
    """Asks for size, background and name of a picture.

    Signals:
        chosen: a PictureRequest.
    """

    chosen = Signal(object)

    def __init__(self, shown: QSize, path: Path, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle("Save picture")
        self.size_choice, self.width_box, self.height_box = QComboBox(), _pixels(), _pixels()
        self.transparent = QCheckBox("Transparent background")
        self.path, self.browse = QLineEdit(str(path)), QPushButton("Browse…")
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Save | QDialogButtonBox.StandardButton.Cancel
        )
        for title, size in _sizes(shown).items():
            self.size_choice.addItem(f"{title} ({size.width()} × {size.height()})", size)
        self.size_choice.addItem("Custom", None)
        self._lay_out()
        self.size_choice.activated.connect(self._show_size)
        self.width_box.valueChanged.connect(self._show_custom)
        self.height_box.valueChanged.connect(self._show_custom)
        self.browse.clicked.connect(self._browse)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.size_choice.setCurrentIndex(0)
        self._show_size()

    def _lay_out(self) -> None:
        form = QFormLayout(self)
        form.setContentsMargins(16, 16, 16, 12)
        form.setSpacing(10)
        size, name = QHBoxLayout(), QHBoxLayout()
        for widget in (self.width_box, QLabel("×"), self.height_box, QLabel("pixels")):
            size.addWidget(widget)
        size.addStretch(1)
        name.addWidget(self.path, 1)
        name.addWidget(self.browse)
        form.addRow("Size", self.size_choice)
        form.addRow("", size)
        form.addRow("", self.transparent)
        form.addRow("File", name)
        form.addRow(self.buttons)
        self.path.setMinimumWidth(320)
        self.path.setPlaceholderText("name a file")

    def _show_size(self) -> None:
        size = self.size_choice.currentData()
        if size is not None:
            for box, value in ((self.width_box, size.width()), (self.height_box, size.height())):
                box.blockSignals(True)
                box.setValue(value)
                box.blockSignals(False)

    def _show_custom(self) -> None:
        self.size_choice.setCurrentIndex(self.size_choice.count() - 1)

    def _browse(self) -> None:
        dialog = QFileDialog(self, "Save picture", self.path.text(), "Pictures (*.png)")
        dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        dialog.setDefaultSuffix("png")
        dialog.fileSelected.connect(self.path.setText)
        dialog.open()

    def accept(self) -> None:
        """Emit the choice; a name without an ending gets .png. Where no file is named, go on asking."""
        path = Path(self.path.text().strip())
        with suppress(RuntimeError):  # of a user who has no home
            path = path.expanduser()
        if path.name in ("", ".."):
            self.path.setFocus()
            self.path.selectAll()
            return
        if not path.suffix:
            path = path.with_suffix(".png")
        size = (self.width_box.value(), self.height_box.value())
        super().accept()
        self.chosen.emit(PictureRequest(path, size, self.transparent.isChecked()))


def _sizes(shown: QSize) -> dict[str, QSize]:
    return {
        "As in the window": shown,
        "Twice the window": shown * 2,
        "4K": QSize(3840, 2160),
        "Full HD": QSize(1920, 1080),
    }


def _pixels() -> QSpinBox:
    return QSpinBox(minimum=16, maximum=16384)


def open_dialog(folder: str, parent: QWidget) -> QFileDialog:
    """Ask for a mesh or a polygon; its `fileSelected` says which."""
    dialog = QFileDialog(parent, "Open a mesh or a polygon", folder, shape_file_filter())
    dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
    return dialog


def shape_file_filter() -> str:
    """The lines of the dialog's filter: every suffix that a reader is for, by kind of shape."""
    meshes, polygons = (
        " ".join(f"*{suffix}" for suffix in readable_suffixes(dimension)) for dimension in (3, 2)
    )
    return f"Shapes ({meshes} {polygons});;Meshes ({meshes});;Polygons ({polygons});;All files (*)"


def about_dialog(parent: QWidget) -> QMessageBox:
    """A box that tells what this program is."""
    box = QMessageBox(parent)
    box.setWindowTitle("About idviewer")
    box.setTextFormat(Qt.TextFormat.RichText)
    box.setText(ABOUT.format(version=__version__))
    return box
