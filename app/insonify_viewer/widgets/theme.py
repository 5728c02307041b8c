"""Colours and style sheet of the window, dark or light, and the scale of its text."""

from enum import Enum
from string import Template

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QGuiApplication, QPalette
from PySide6.QtWidgets import QApplication, QWidget

from insonify.files import resources

LARGE = 1.6  # size of the text in a lecture over the usual one
USUAL_LINE = 14  # px, height of a line of text for which lengths in pixels are given


class Theme(Enum):
    """Colours of the window."""

    SYSTEM = "system"
    DARK = "dark"
    LIGHT = "light"


# Of the dark and of the light theme.
COLOURS = {
    "GROUND": ("#121a22", "#f5f7f9"),
    "RAISED": ("#1b2631", "#e7ecf1"),
    "EDGE": ("#2d3c4a", "#bcc7d1"),
    "TEXT": ("#dbe3ea", "#17212b"),
    "QUIET": ("#8ea0b1", "#475665"),
    "ACCENT": ("#e2a458", "#8f4f0c"),
    "MARK": ("#38d6ff", "#00668f"),  # distinct from sand and from every palette
    "FAINT": ("#566573", "#8794a1"),
    "TRAIL": ("#9a7445", "#c79a63"),
}
# Views hold these objects; `apply_theme` changes them in place, so that the next paint shows another theme.
SHOWN = {name: QColor(dark) for name, (dark, _) in COLOURS.items()}
GROUND, RAISED, EDGE, TEXT, QUIET, ACCENT, MARK, FAINT, TRAIL = SHOWN.values()
# Over records and pictures of the water, which stay dark in both themes; the halo sets marks off bright echoes.
OVER_WATER, MARK_IN_WATER, ACCENT_IN_WATER = COLOURS["TEXT"][0], COLOURS["MARK"][0], COLOURS["ACCENT"][0]
HALO = COLOURS["GROUND"][0]


def apply_theme(application: QApplication, theme: Theme = Theme.DARK) -> None:
    """Set style, colours and style sheet of the application; widgets are painted anew if these change."""
    light = is_light(theme)
    for name, colour in SHOWN.items():
        colour.setRgb(QColor(COLOURS[name][light]).rgb())
    arrow = (resources() / "icons" / "down.svg").as_posix()
    style = Template((resources() / "window" / "style.qss").read_text(encoding="utf-8"))
    sheet = style.substitute(ARROW=arrow, **{name: colour.name() for name, colour in SHOWN.items()})
    if application.styleSheet() == sheet:
        return
    if application.styleSheet():
        # Replacing a sheet polishes a widget once for each of its ancestors; removing and setting one, once each.
        application.setStyleSheet("")
    else:
        application.setStyle("Fusion")
    application.setPalette(_palette())
    application.setStyleSheet(sheet)


def is_light(theme: Theme) -> bool:
    """Whether a theme is light; the system's is dark where the system names none."""
    if theme is Theme.SYSTEM:
        return QGuiApplication.styleHints().colorScheme() == Qt.ColorScheme.Light
    return theme is Theme.LIGHT


def _palette() -> QPalette:
    palette, role = QPalette(), QPalette.ColorRole
    for roles, colour in (
        ((role.Window, role.Base, role.ToolTipBase), GROUND),
        ((role.Button, role.AlternateBase), RAISED),
        ((role.WindowText, role.Text, role.ButtonText, role.ToolTipText), TEXT),
        ((role.Highlight, role.Link), ACCENT),
        ((role.HighlightedText,), GROUND),
        ((role.PlaceholderText,), QUIET),
    ):
        for one in roles:
            palette.setColor(one, QColor(colour))
    for one in (role.WindowText, role.Text, role.ButtonText):
        palette.setColor(QPalette.ColorGroup.Disabled, one, QColor(FAINT))
    return palette


def text_scale(widget: QWidget) -> float:
    """Height of a line of a widget's text over the usual one."""
    return widget.fontMetrics().height() / USUAL_LINE


def lecture_scale(widget: QWidget) -> float:
    """Factor by which a lecture enlarges a widget's text; text that is large already stays as it is."""
    return max(LARGE / text_scale(widget), 1.0)


def scaled(widget: QWidget, pixels: int) -> int:
    """Length that holds as many letters of a widget as a length in pixels holds of the usual ones."""
    return round(pixels * text_scale(widget))
