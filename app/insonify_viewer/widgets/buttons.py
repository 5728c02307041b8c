"""Makers of widgets, push buttons, labels and actions, and icons in the colours of the theme."""

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

from PySide6.QtCore import QByteArray, QObject, QRectF, Qt
from PySide6.QtGui import QAction, QIcon, QImage, QKeySequence, QPainter, QPalette, QPixmap
from PySide6.QtSvg import QSvgRenderer
from PySide6.QtWidgets import QApplication, QCheckBox, QLabel, QPushButton, QSizePolicy, QToolButton, QWidget

from insonify.files import resources

SIDES = (20, 40, 80)  # px, for screens at once, twice and four times the scale
NAME = "icon_name"  # property that holds the name of the icon
Made = TypeVar("Made", bound=QObject)


def make(kind: type[Made], *given: Any, **properties: Any) -> Made:
    """Make a widget with properties of its class and of those before it, of which Qt's stubs know the former alone."""
    construct: Any = kind
    made: Made = construct(*given, **properties)
    return made


def push_button(
    text: str, tip: str, do: Callable[[], object] | None = None, *, style: str = "tool", wide: bool = False
) -> QPushButton:
    """Make a button that the Tab key reaches; a click leaves the keyboard where it is."""
    button = make(QPushButton, text, objectName=style, toolTip=tip, focusPolicy=Qt.FocusPolicy.TabFocus)
    if wide:
        button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
    if do is not None:
        button.clicked.connect(lambda: do())
    return button


def tick_box(text: str, tip: str) -> QCheckBox:
    """Make a box to tick that the Tab key reaches; a click leaves the keyboard to the record, where Space pauses."""
    return make(QCheckBox, text, toolTip=tip, focusPolicy=Qt.FocusPolicy.TabFocus)


def make_label(style: str, text: str = "", *, form: Qt.TextFormat = Qt.TextFormat.PlainText) -> QLabel:
    """Make a label that wraps its text and lets the person copy it."""
    copied = Qt.TextInteractionFlag.TextSelectableByMouse
    return make(QLabel, text, objectName=style, wordWrap=True, textFormat=form, textInteractionFlags=copied)


def make_action(
    owner: QWidget,
    text: str,
    tip: str,
    key: QKeySequence | QKeySequence.StandardKey | str = "",
    do: Callable[[], object] | None = None,
) -> QAction:
    """Make an action that calls a function, with its shortcut, which the tooltip names as the system writes it."""
    shortcut = QKeySequence(key)
    action = QAction(text, owner, shortcut=shortcut, toolTip=with_key(tip, shortcut))
    if do is not None:
        action.triggered.connect(lambda: do())
    return action


def with_key(tip: str, shortcut: QKeySequence) -> str:
    """Append a shortcut to a tooltip, as the system writes it."""
    key = shortcut.toString(QKeySequence.SequenceFormat.NativeText)
    return f"{tip} ({key})" if key else tip


def light(widget: QWidget, lit: bool) -> None:
    """Light a widget, or let it be as usual."""
    set_property(widget, "lit", lit)


def set_property(widget: QWidget, name: str, on: bool) -> None:
    """Set a property of a widget by which the style sheet draws it."""
    if bool(widget.property(name)) != on:
        widget.setProperty(name, on)
        # A style sheet reads a property only when the widget is polished.
        widget.style().unpolish(widget)
        widget.style().polish(widget)


def set_icon(owner: QAction | QToolButton, name: str) -> None:
    """Give an action or a button the icon of a name."""
    owner.setProperty(NAME, name)
    owner.setIcon(make_icon(name))


def refresh_icons(window: QWidget) -> None:
    """Draw the icons of a window again, in the colours of the palette as it is now."""
    owners: list[QAction | QToolButton] = [*window.findChildren(QAction), *window.findChildren(QToolButton)]
    for owner in owners:
        if name := owner.property(NAME):
            owner.setIcon(make_icon(name))


def make_icon(name: str) -> QIcon:
    """Draw an icon for every state of a button: usual, disabled, and checked on the accent colour."""
    palette, role, group = QApplication.palette(), QPalette.ColorRole, QPalette.ColorGroup
    icon = QIcon()
    for mode, state, colour in (
        (QIcon.Mode.Normal, QIcon.State.Off, palette.color(role.ButtonText)),
        (QIcon.Mode.Normal, QIcon.State.On, palette.color(role.HighlightedText)),
        (QIcon.Mode.Disabled, QIcon.State.Off, palette.color(group.Disabled, role.ButtonText)),
    ):
        for side in SIDES:
            icon.addPixmap(QPixmap.fromImage(_render(name, colour.name(), side)), mode, state)
    return icon


@cache
def _render(name: str, colour: str, side: int) -> QImage:
    image = QImage(side, side, QImage.Format.Format_ARGB32_Premultiplied)
    image.fill(Qt.GlobalColor.transparent)
    with QPainter(image) as painter:
        svg = (resources() / "icons" / f"{name}.svg").read_text(encoding="utf-8")
        drawing = QSvgRenderer(QByteArray(svg.replace("currentColor", colour).encode()))
        drawing.render(painter, QRectF(0, 0, side, side))
    return image
