"""Text with the colours of the theme, written anew in those of another."""

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QTextBrowser

from insonify_viewer.errors import guard_override


class ThemedText(QTextBrowser):
    """Shows HTML that names colours of the theme, scrolled as before when it is written anew."""

    def __init__(self, name: str, tip: str, narrowest: int) -> None:
        super().__init__()
        self.setObjectName("budget")
        self.setAccessibleName(name)
        self.setToolTip(tip)
        self.setMinimumWidth(narrowest)

    def text(self) -> str:
        """HTML in the colours of the present theme."""
        raise NotImplementedError

    def write(self) -> None:
        """Show the text as it is now."""
        place = self.verticalScrollBar().value()
        self.setHtml(self.text())
        self.verticalScrollBar().setValue(place)

    @guard_override(None)
    def changeEvent(self, event: QEvent) -> None:
        """Write anew in the colours of another theme."""
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self.write()
