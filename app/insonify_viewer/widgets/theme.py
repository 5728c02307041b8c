"""Colours and style sheet of the window, dark or light, and the scale of its text."""

from enum import Enum

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
GROUND, RAISED, EDGE, TEXT, QUIET, ACCENT, MARK, FAINT, TRAIL = (QColor(dark) for dark, _ in COLOURS.values())
# Over records and pictures of the water, which stay dark in both themes; the halo sets marks off bright echoes.
OVER_WATER, MARK_IN_WATER, ACCENT_IN_WATER = COLOURS["TEXT"][0], COLOURS["MARK"][0], COLOURS["ACCENT"][0]
HALO = COLOURS["GROUND"][0]

STYLE = """
QMainWindow, QDockWidget, QScrollArea, QWidget#panel {{ background: {GROUND}; }}
QToolBar {{ background: {RAISED}; border: 0; border-bottom: 1px solid {EDGE}; padding: 3px 3px; spacing: 1px; }}
QToolBar QToolButton {{ padding: 4px 3px; border-radius: 4px; color: {TEXT}; }}
QToolBar QToolButton:hover {{ background: {EDGE}; }}
QToolBar QToolButton:checked {{ background: {ACCENT}; color: {GROUND}; }}
QToolBar QToolButton:disabled {{ color: {FAINT}; }}
QToolBar QLabel {{ color: {QUIET}; padding: 0 2px 0 4px; }}
QToolBar::separator {{ background: {EDGE}; width: 1px; margin: 4px 2px; }}
QStatusBar {{ background: {RAISED}; color: {QUIET}; border-top: 1px solid {EDGE}; }}
QStatusBar::item {{ border: 0; }}
QStatusBar QLabel {{ color: {TEXT}; padding: 0 6px; }}
QSplitter::handle {{ background: {EDGE}; }}
QSplitter::handle:hover {{ background: {ACCENT}; }}
QToolButton#heading {{ background: {RAISED}; border: 0; border-radius: 4px; color: {TEXT}; font-weight: 600;
    padding: 5px 6px; text-align: left; }}
QToolButton#heading:hover {{ background: {EDGE}; }}
QToolButton#remove, QToolButton#reset, QToolButton#copy, QToolButton#lock {{ background: {RAISED}; border: 0;
    border-radius: 4px; color: {QUIET}; padding: 0; }}
QToolButton#remove:hover, QToolButton#reset:hover, QToolButton#copy:hover, QToolButton#lock:hover {{ background: {EDGE};
    color: {ACCENT}; }}
QToolButton#link {{ background: {RAISED}; border: 0; border-radius: 4px; padding: 2px; }}
QToolButton#link:checked {{ background: {ACCENT}; }}
QToolButton#more {{ background: transparent; border: 0; color: {QUIET}; padding: 1px 2px; }}
QToolButton#more:hover {{ color: {ACCENT}; }}
QCheckBox::indicator {{ width: 0.92em; height: 0.92em; border: 1px solid {QUIET}; border-radius: 3px;
    background: {RAISED}; }}
QCheckBox::indicator:hover, QCheckBox::indicator:focus {{ border-color: {ACCENT}; }}
QCheckBox::indicator:checked {{ background: {ACCENT}; border-color: {ACCENT}; }}
QCheckBox::indicator:disabled {{ border-color: {EDGE}; }}
QRadioButton::indicator {{ width: 0.92em; height: 0.92em; border: 1px solid {QUIET}; border-radius: 0.5em;
    background: {RAISED}; }}
QRadioButton::indicator:hover, QRadioButton::indicator:focus {{ border-color: {ACCENT}; }}
QRadioButton::indicator:checked {{ background: {ACCENT}; border-color: {ACCENT}; }}
QRadioButton::indicator:disabled:!checked {{ border-color: {EDGE}; }}
QLabel#figure {{ color: {QUIET}; }}
QPushButton#file {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px; padding: 2px 6px;
    min-height: 18px; text-align: left; }}
QPushButton#file:hover {{ border-color: {ACCENT}; }}
QToolBar QToolButton::menu-indicator {{ image: none; }}
QMenu {{ background: {RAISED}; border: 1px solid {EDGE}; padding: 3px; }}
QMenu::item {{ padding: 4px 18px; border-radius: 3px; }}
QMenu::item:selected {{ background: {EDGE}; }}
QLabel#name {{ color: {QUIET}; }}
QLabel#name[changed="true"] {{ color: {TEXT}; font-style: italic; }}
QLabel#name[lit="true"], QLabel#choice[lit="true"], QLabel#tick[lit="true"] {{ color: {GROUND}; background: {ACCENT};
    border-radius: 3px; padding: 1px 4px; }}
QPushButton#tool[lit="true"] {{ color: {GROUND}; background: {ACCENT}; border-color: {ACCENT}; font-weight: 600; }}
QLabel#numbers {{ color: {TEXT}; }}
QLabel#choice {{ color: {TEXT}; font-weight: 600; }}
QLabel#change {{ color: {ACCENT}; }}
QTabBar {{ background: {GROUND}; qproperty-drawBase: 0; }}
QTabBar::tab {{ background: {GROUND}; color: {QUIET}; padding: 5px 14px; border: 0;
    border-bottom: 2px solid {EDGE}; }}
QTabBar::tab:selected {{ color: {TEXT}; border-bottom-color: {ACCENT}; }}
QTabBar::tab:hover {{ color: {TEXT}; }}
QFrame#tour {{ background: {RAISED}; border: 1px solid {ACCENT}; border-radius: 6px; }}
QPushButton#tool {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px; padding: 4px 12px; }}
QPushButton#small {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px; padding: 0 10px; }}
QPushButton#small:hover {{ border-color: {ACCENT}; }}
QDialogButtonBox {{ dialogbuttonbox-buttons-have-icons: 0; }}
QPushButton#tool:hover {{ border-color: {ACCENT}; }}
QPushButton:disabled {{ color: {FAINT}; }}
QLabel#about {{ color: {QUIET}; padding: 5px 4px 7px 6px; }}
QLineEdit#search, QLineEdit#line {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px;
    padding: 3px 6px; }}
QLineEdit#search:focus, QLineEdit#line:focus {{ border-color: {ACCENT}; }}
QLineEdit#value {{ background: transparent; border: 1px solid transparent; border-radius: 3px; padding: 1px 2px; }}
QLineEdit#value:hover, QLineEdit#value:focus {{ border-color: {EDGE}; background: {RAISED}; }}
QComboBox {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px; padding: 2px 6px; min-height: 18px; }}
QComboBox::drop-down {{ border: 0; width: 1.3em; }}
QComboBox::down-arrow {{ image: url({ARROW}); width: 0.8em; height: 0.8em; }}
QComboBox:hover {{ border-color: {ACCENT}; }}
QComboBox QAbstractItemView {{ background: {RAISED}; color: {TEXT}; selection-background-color: {EDGE};
    selection-color: {TEXT}; outline: 0; }}
QTextBrowser#budget {{ background: {GROUND}; color: {TEXT}; border: 0; selection-background-color: {EDGE};
    selection-color: {TEXT}; }}
QListWidget#contacts, QListWidget#scenes {{ background: {GROUND}; border: 1px solid {EDGE}; border-radius: 4px; }}
QListWidget#contacts::item:selected, QListWidget#scenes::item:hover, QListWidget#scenes::item:selected {{
    background: {EDGE}; color: {TEXT}; }}
QSlider::groove:horizontal {{ height: 3px; background: {EDGE}; border-radius: 1px; }}
QSlider::sub-page:horizontal {{ background: {TRAIL}; border-radius: 1px; }}
QSlider::sub-page:horizontal:disabled {{ background: {EDGE}; }}
QLabel#name:disabled {{ color: {FAINT}; }}
QSlider::handle:horizontal {{ background: {TEXT}; width: 11px; height: 11px; margin: -4px 0; border-radius: 5px; }}
QSlider::handle:horizontal:hover, QSlider::handle:horizontal:focus {{ background: {ACCENT}; }}
QSlider::handle:horizontal:disabled {{ background: {FAINT}; }}
QProgressBar {{ background: {GROUND}; border: 1px solid {EDGE}; border-radius: 3px; max-height: 9px;
    max-width: 120px; }}
QProgressBar#job {{ max-height: 16px; min-width: 220px; max-width: 320px; color: {TEXT}; text-align: center; }}
QFrame#job {{ border: 1px solid transparent; border-radius: 4px; }}
QFrame#job:focus, QProgressBar#job:focus {{ border-color: {ACCENT}; }}
QPushButton#tool:focus, QPushButton#small:focus, QPushButton#file:focus {{ border-color: {ACCENT}; }}
QProgressBar#job::chunk {{ background: {TRAIL}; }}
QProgressBar::chunk {{ background: {ACCENT}; }}
QScrollBar:vertical {{ background: {GROUND}; width: 9px; margin: 0; }}
QScrollBar::handle:vertical {{ background: {EDGE}; border-radius: 4px; min-height: 24px; }}
QScrollBar::add-line:vertical, QScrollBar::sub-line:vertical {{ height: 0; }}
QScrollBar:horizontal {{ background: {GROUND}; height: 9px; margin: 0; }}
QScrollBar::handle:horizontal {{ background: {EDGE}; border-radius: 4px; min-width: 24px; }}
QScrollBar::add-line:horizontal, QScrollBar::sub-line:horizontal {{ width: 0; }}
QToolTip {{ background: {RAISED}; color: {TEXT}; border: 1px solid {EDGE}; padding: 3px; }}
"""


def apply_theme(application: QApplication, theme: Theme = Theme.DARK) -> None:
    """Set style, colours and style sheet of the application; widgets are painted anew if these change."""
    light = is_light(theme)
    named = {"GROUND": GROUND, "RAISED": RAISED, "EDGE": EDGE, "TEXT": TEXT, "QUIET": QUIET, "ACCENT": ACCENT}
    named |= {"MARK": MARK, "FAINT": FAINT, "TRAIL": TRAIL}
    for name, colour in named.items():
        colour.setRgb(QColor(COLOURS[name][light]).rgb())
    arrow = (resources() / "icons" / "down.svg").as_posix()
    sheet = STYLE.format(ARROW=arrow, **{name: colour.name() for name, colour in named.items()})
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
