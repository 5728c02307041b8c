"""Windows and panels of their own are worked by the keyboard alone, links in texts too."""

from collections.abc import Callable

import pytest
from controls import accessible_name, controls_of, place_of, takes_keyboard
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QLabel, QWidget
from test_menus import activate

from insonify.scene import edit, load_scene
from insonify_viewer.panels.jobs.view import DatasetQuestion
from insonify_viewer.window.help_dialogs import OTHER_KEYS, AboutDialog, KeysDialog
from insonify_viewer.window.scene_menu import SceneGallery

DIALOGS: dict[str, Callable[[QWidget], QWidget]] = {
    "about": AboutDialog,
    "keys": lambda window: KeysDialog(window, window.menus.all, OTHER_KEYS),
    "gallery": SceneGallery,
    "data set": lambda window: DatasetQuestion(["mines"], window),
}

MOST = 400  # more than any window has controls


def walk(window: QWidget, qtbot) -> set[QWidget]:
    """Press Tab until the keyboard comes round, and return every widget that had it."""
    qtbot.waitUntil(window.isActiveWindow)
    qtbot.keyClick(window, Qt.Key.Key_Tab)
    first = QApplication.focusWidget()
    reached: set[QWidget] = {first}
    for _ in range(MOST):
        qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Tab)
        focus = QApplication.focusWidget()
        if focus is first and len(reached) > 1:
            break
        reached.add(focus)
    return reached


def in_reach(window: QWidget) -> set[QWidget]:
    """Controls of a window that are shown and enabled."""
    return {child for child in controls_of(window) if child.isVisible() and child.isEnabled()}


def assert_walked(window: QWidget, qtbot):
    wanted, reached = in_reach(window), walk(window, qtbot)
    assert wanted
    assert [place_of(child) for child in wanted - reached] == []
    speaking = wanted | {child for child in window.findChildren(QWidget) if takes_keyboard(child)}
    assert [place_of(child) for child in speaking if not accessible_name(child) and not is_silent(child)] == []


def is_silent(widget: QWidget) -> bool:
    """Whether a widget is a text without words."""
    return isinstance(widget, QLabel) and not widget.text()


@pytest.mark.parametrize("name", ["chart", "jobs"])
def test_tab_reaches_every_control_of_a_window(name, viewer, qtbot):
    viewer.window.open_panel(name)
    window = viewer.panels[name].widget
    activate(window, qtbot)
    assert_walked(window, qtbot)


def test_every_control_of_a_question_has_a_tooltip(open_viewer, small):
    question = DIALOGS["data set"](open_viewer(small).window)
    answers = question.buttons.buttons()
    controls = [control for control in controls_of(question) if control not in answers]
    assert len(controls) == 5
    assert [place_of(control) for control in controls if not control.toolTip()] == []


@pytest.mark.parametrize("name", DIALOGS)
def test_tab_reaches_every_control_of_a_dialog(name, open_viewer, small, qtbot):
    dialog = DIALOGS[name](open_viewer(small).window)
    dialog.show()
    activate(dialog, qtbot)
    assert_walked(dialog, qtbot)
    qtbot.keyClick(dialog, Qt.Key.Key_Escape)
    assert not dialog.isVisible()


@pytest.mark.parametrize("name", ["water", "lessons", "pixel", "comparison"])
def test_tab_reaches_every_control_of_an_opened_panel(name, viewer, qtbot):
    activate(viewer.window, qtbot)
    viewer.window.open_panel(name)
    qtbot.waitUntil(viewer.panels[name].widget.isVisible)
    wanted, reached = in_reach(viewer.panels[name].widget), walk(viewer.window, qtbot)
    assert [place_of(child) for child in wanted - reached] == []


def test_tab_reaches_the_buttons_of_contacts(viewer, qtbot):
    activate(viewer.window, qtbot)
    viewer.window.open_panel("record")
    contacts = viewer.panels["record"].view.contacts
    wanted = in_reach(contacts)
    assert wanted
    assert [place_of(child) for child in wanted - walk(viewer.window, qtbot)] == []


def test_links_of_a_description_are_followed_by_the_keyboard(open_viewer, qtbot):
    scene = edit(load_scene("default"), {"sonar.bins": 100, "track.pings": 128})
    viewer = open_viewer(scene)
    activate(viewer.window, qtbot)
    label = next(each for each in viewer.window.findChildren(QLabel, "about") if "<a href" in each.text())
    followed = []
    label.linkActivated.connect(followed.append)
    assert label in walk(viewer.window, qtbot)
    label.previousInFocusChain().setFocus()
    while QApplication.focusWidget() is not label:
        qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Tab)
    for number in range(label.text().count("<a href")):
        qtbot.keyClick(label, Qt.Key.Key_Tab)
        qtbot.keyClick(label, Qt.Key.Key_Return)
        assert followed == [str(each) for each in range(number + 1)]
        assert QApplication.focusWidget() is label
