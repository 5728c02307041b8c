"""The description of the scene, with links to values to try."""

from __future__ import annotations

import html
from collections.abc import Sequence

from PySide6.QtCore import QEvent, Qt
from PySide6.QtWidgets import QLabel

from insonify.scene.links import Link
from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.widgets.folding_box import FoldingBox
from insonify_viewer.widgets.theme import ACCENT

BACK = "↩ "  # before the words of a link that leads back


class AboutBox(FoldingBox):
    """The description of the scene, under a heading that folds."""

    def __init__(self) -> None:
        self.label = QLabel()
        self.label.setObjectName("about")
        self.label.setWordWrap(True)
        self.label.setTextFormat(Qt.TextFormat.RichText)
        flag = Qt.TextInteractionFlag
        self.label.setTextInteractionFlags(
            flag.TextSelectableByMouse | flag.LinksAccessibleByMouse | flag.LinksAccessibleByKeyboard
        )
        self.label.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the keyboard where it is
        self.label.setAccessibleName("About this scene")
        self.label.linkHovered.connect(self._explain)
        self._shown: tuple[Sequence[str | Link], Sequence[bool]] = ((), ())
        super().__init__("About this scene", self.label, unfolded=True)

    @property
    def words(self) -> str:
        """The text without its links."""
        return "".join(part if isinstance(part, str) else part.words for part in self._shown[0])

    def say(self, parts: Sequence[str | Link], tried: Sequence[bool]) -> None:
        """Show a description; links whose value is tried at present lead back. Without one, hide the heading too."""
        self._shown = (parts, tried)
        text, number = "", 0
        for part in parts:
            if isinstance(part, str):
                text += html.escape(part)
                continue
            words = html.escape(BACK * tried[number] + part.words)
            text += f'<a href="{number}" style="color: {ACCENT.name()}">{words}</a>'
            number += 1
        if text != self.label.text():
            start, length = self.label.selectionStart(), len(self.label.selectedText())
            self.label.setText(text)
            if self.label.hasFocus() and start >= 0:
                self.label.setSelection(start, length)  # the Tab key goes on from the link that was followed
        self.setVisible(bool(parts))

    @guard_override(None)
    def changeEvent(self, event: QEvent) -> None:
        """Colour the links by another theme."""
        if event.type() is QEvent.Type.StyleChange and self._shown[0]:
            self.say(*self._shown)
        super().changeEvent(event)

    def _explain(self, number: str) -> None:
        """Say in the tooltip what the link under the mouse does."""
        links = [part for part in self._shown[0] if isinstance(part, Link)]
        if not number:
            self.label.setToolTip("")
        elif self._shown[1][int(number)]:
            self.label.setToolTip("Click to go back to the value before")
        else:
            self.label.setToolTip(f"Click to try {links[int(number)].path} = {_shown(links[int(number)].value)}")


def _shown(value: object) -> str:
    """Write a value as people write it in a scene."""
    return str(value.get("kind", value)) if isinstance(value, dict) else f"{value}"
