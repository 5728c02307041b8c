"""Text of files in widgets that obey some characters (HTML, & and tabs), and text in the colours of the theme."""

import html

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QLabel, QSizePolicy, QTextBrowser

from insonify.errors import plain_text
from insonify_viewer.errors import guard_override


def literal(text: str) -> str:
    """Return text for a widget that takes some for HTML, so that it shows every character as it is."""
    text = plain_text(text)
    return f"<span>{html.escape(text)}</span>".replace("\n", "<br>") if "<" in text else text


def entry_name(text: str) -> str:
    """Return text for a menu or a button: no character becomes a shortcut or a column."""
    return one_line(text).replace("&", "&&")


def window_title(text: str) -> str:
    """Return text for the title of a window, where ``[*]`` marks unsaved changes unless it is written twice."""
    return one_line(text).replace("[*]", "[*][*]")


def one_line(text: str) -> str:
    """Return text without control characters and on one line."""
    return plain_text(" ".join(text.split()))


class ElidedLabel(QLabel):
    """One line of text that ends in an ellipsis where there is no room for all of it."""

    def __init__(self, style: str) -> None:
        super().__init__()
        self.setObjectName(style)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._words = ""

    def say(self, words: str) -> None:
        """Show other words."""
        self._words = words
        self.setText(self.fontMetrics().elidedText(words, Qt.TextElideMode.ElideRight, self.width()))

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show as much as there is room for."""
        super().resizeEvent(event)
        self.say(self._words)


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
