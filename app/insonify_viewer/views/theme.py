"""Colours and style sheet of the window: dark, with one copper accent."""

from __future__ import annotations

from PySide6.QtGui import QColor, QPalette
from PySide6.QtWidgets import QApplication

GROUND, RAISED, EDGE = "#121a22", "#1b2631", "#2d3c4a"
TEXT, QUIET, ACCENT = "#dbe3ea", "#8ea0b1", "#e2a458"
MARK = "#38d6ff"  # distinct from sand and from every palette

STYLE = f"""
QMainWindow, QDockWidget, QScrollArea, QWidget#panel {{ background: {GROUND}; }}
QToolBar {{ background: {RAISED}; border: 0; border-bottom: 1px solid {EDGE}; padding: 3px 3px; spacing: 1px; }}
QToolBar QToolButton {{ padding: 4px 3px; border-radius: 4px; color: {TEXT}; }}
QToolBar QToolButton:hover {{ background: {EDGE}; }}
QToolBar QToolButton:checked {{ background: {ACCENT}; color: {GROUND}; }}
QToolBar QToolButton:disabled {{ color: #566573; }}
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
QToolButton#more {{ background: transparent; border: 0; color: {QUIET}; padding: 1px 2px; }}
QToolButton#more:hover {{ color: {ACCENT}; }}
QCheckBox::indicator {{ width: 11px; height: 11px; border: 1px solid {QUIET}; border-radius: 3px;
    background: {RAISED}; }}
QCheckBox::indicator:hover, QCheckBox::indicator:focus {{ border-color: {ACCENT}; }}
QCheckBox::indicator:checked {{ background: {ACCENT}; border-color: {ACCENT}; }}
QCheckBox::indicator:disabled {{ border-color: {EDGE}; }}
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
QPushButton#tool {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px; padding: 4px 12px; }}
QPushButton#tool:hover {{ border-color: {ACCENT}; }}
QPushButton:disabled {{ color: #566573; }}
QLabel#about {{ color: {QUIET}; padding: 5px 4px 7px 6px; }}
QLineEdit#search {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px; padding: 3px 6px; }}
QLineEdit#search:focus {{ border-color: {ACCENT}; }}
QLineEdit#value {{ background: transparent; border: 1px solid transparent; border-radius: 3px; padding: 1px 2px; }}
QLineEdit#value:hover, QLineEdit#value:focus {{ border-color: {EDGE}; background: {RAISED}; }}
QComboBox {{ background: {RAISED}; border: 1px solid {EDGE}; border-radius: 4px; padding: 2px 6px; min-height: 18px; }}
QComboBox:hover {{ border-color: {ACCENT}; }}
QComboBox QAbstractItemView {{ background: {RAISED}; color: {TEXT}; selection-background-color: {EDGE};
    selection-color: {TEXT}; outline: 0; }}
QTreeWidget#budget {{ background: {GROUND}; color: {TEXT}; border: 0; selection-background-color: {EDGE};
    selection-color: {TEXT}; outline: 0; }}
QSlider::groove:horizontal {{ height: 3px; background: {EDGE}; border-radius: 1px; }}
QSlider::sub-page:horizontal {{ background: #9a7445; border-radius: 1px; }}
QSlider::sub-page:horizontal:disabled {{ background: {EDGE}; }}
QLabel#name:disabled {{ color: #566573; }}
QSlider::handle:horizontal {{ background: {TEXT}; width: 11px; height: 11px; margin: -4px 0; border-radius: 5px; }}
QSlider::handle:horizontal:hover, QSlider::handle:horizontal:focus {{ background: {ACCENT}; }}
QSlider::handle:horizontal:disabled {{ background: #566573; }}
QProgressBar {{ background: {GROUND}; border: 1px solid {EDGE}; border-radius: 3px; max-height: 9px;
    max-width: 120px; }}
QProgressBar#job {{ max-height: 16px; min-width: 220px; max-width: 320px; color: {TEXT}; text-align: center; }}
QProgressBar#job::chunk {{ background: #9a7445; }}
QProgressBar::chunk {{ background: {ACCENT}; }}
QScrollBar:vertical {{ background: {GROUND}; width: 9px; margin: 0; }}
QScrollBar::handle:vertical {{ background: {EDGE}; border-radius: 4px; min-height: 24px; }}
QScrollBar::add-line:vertical, QScrollBar::sub-line:vertical {{ height: 0; }}
QToolTip {{ background: {RAISED}; color: {TEXT}; border: 1px solid {EDGE}; padding: 3px; }}
"""


def apply_theme(application: QApplication) -> None:
    """Set style, colours and style sheet of the application."""
    application.setStyle("Fusion")
    palette = QPalette()
    role = QPalette.ColorRole
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
        palette.setColor(QPalette.ColorGroup.Disabled, one, QColor("#566573"))
    application.setPalette(palette)
    application.setStyleSheet(STYLE)
