"""A window to drag a file from, as from a file manager: `python drag_source.py FILE X Y SIZE`."""

from __future__ import annotations

import sys

from PySide6.QtCore import QMimeData, Qt, QUrl
from PySide6.QtGui import QDrag, QMouseEvent
from PySide6.QtWidgets import QApplication, QLabel


class Source(QLabel):
    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802
        if event.buttons() & Qt.MouseButton.LeftButton:
            mime, drag = QMimeData(), QDrag(self)
            mime.setUrls([QUrl.fromLocalFile(sys.argv[1])])
            drag.setMimeData(mime)
            print(drag.exec(Qt.DropAction.CopyAction), flush=True)  # and stays, to hand over what was dragged

    def paintEvent(self, event: object) -> None:  # noqa: N802
        super().paintEvent(event)
        print("shown", flush=True)


if __name__ == "__main__":
    application = QApplication([])
    source = Source("drag me")
    source.setGeometry(*(int(number) for number in (sys.argv[2], sys.argv[3], sys.argv[4], sys.argv[4])))
    source.show()
    application.exec()
