"""Every control of the window explains itself, has a name for screen readers, and is worked by the keyboard alone."""

from itertools import product

import pytest
from controls import accessible_name, activate, assert_side_by_side, bring_to_front, controls_of, focusable, place_of
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QCheckBox, QLabel, QLineEdit, QPushButton, QSlider, QTabBar, QWidget

from insonify.scene import load_scene
from insonify_viewer.application import enlarge_text, has_opengl
from insonify_viewer.panels.jobs.view.questions import DatasetQuestion, FolderQuestion, SurveyQuestion
from insonify_viewer.panels.parameters.view.section_box import SectionBox
from insonify_viewer.state.fields import NumberField
from insonify_viewer.state.sections import sections_of
from insonify_viewer.widgets.field_rows import Combo
from insonify_viewer.window.help_dialogs import AboutDialog, KeysDialog
from insonify_viewer.window.new_scene import NewScene
from insonify_viewer.window.scene_menu import scene_gallery


@pytest.fixture
def viewer(open_viewer, small):
    return open_viewer(small)  # with the tabs that it has at first


def test_every_control_has_a_tooltip_a_name_and_the_keyboard(viewer, qtbot):
    window = viewer.window
    for name in viewer.panels:
        window.open_panel(name)
    for box in viewer.panels["parameters"].view.findChildren(SectionBox):
        box.unfold(True)
    controls = controls_of(window)
    assert len(controls) > 250
    assert [place_of(control) for control in controls if not control.toolTip()] == []
    assert [place_of(control) for control in controls if not accessible_name(control)] == []
    assert [place_of(child) for child in controls if not child.focusPolicy() & Qt.FocusPolicy.TabFocus] == []
    numbers = [child for child in controls if child.objectName() == "value" or type(child).__name__ == "_Slider"]
    assert len(numbers) > 100
    assert {"beam width", "sphere 2 position x", "bed depth"} <= {accessible_name(control) for control in numbers}
    for control in numbers:
        sentence, _, rest = control.toolTip().rpartition(" (")
        unit, _, extent = rest.partition("; ")
        assert len(sentence) > 8, control.toolTip()
        assert unit, control.toolTip()
        assert "to" in extent or "from" in extent, control.toolTip()
    # A choice of kinds says what each is.
    beam = next(combo for combo in window.findChildren(Combo) if combo.accessibleName().endswith("beam"))
    tips = [beam.itemData(place, Qt.ItemDataRole.ToolTipRole) for place in range(beam.count())]
    assert all(tip and tip.endswith(".") for tip in tips)
    assert beam.toolTip().endswith(f"{beam.currentText()}: {tips[beam.currentIndex()]}")
    # Views, tabs and scroll areas have names too; a text is named by its words, and one without words says nothing.
    kinds = {type(child).__name__ for child in focusable(window)}
    assert {"WaterfallView", "RecordAView", "RayPlot", "QTabBar", "ParametersView", "ScrollColumn"} <= kinds
    assert "QtInteractor" in kinds or not has_opengl()
    assert [place_of(child) for child in focusable(window) if not accessible_name(child)] == []
    assert all(tabs.accessibleName() for tabs in window.findChildren(QTabBar))


def test_a_range_is_that_of_the_bounds_or_of_the_slider_and_a_number_without_unit_says_so():
    words = ("sonar.frequency", "frequency", "carrier frequency", "Hz")
    for bounds, slider, text in (
        ((1e3, 2e6), (5e4, 1.2e6), "1 kHz to 2 MHz"),
        ((0.0, None), (5e4, 1.2e6), "slider from 50 kHz to 1.2 MHz"),
        ((0.0, None), None, "from 0 Hz"),
        ((None, 10.0), None, "up to 10 Hz"),
        ((None, None), None, "any number"),
    ):
        number = NumberField(*words, 0, 4e5, slider, log=True, integer=False, bounds=bounds)
        assert number.about == f"carrier frequency (Hz; {text})"
    number = NumberField("seed", "seed", "seed", "", 0, 1, None, log=False, integer=True, bounds=(0, 9))
    assert number.about == "seed (no unit; 0 to 9)"


def test_links_are_followed_by_the_keyboard_and_space_acts_on_what_has_it(viewer, qtbot):
    """Space acts on the focused tick, is a letter in the search, and pauses the tow elsewhere."""
    window = viewer.window
    activate(window, qtbot)
    label = next(each for each in window.findChildren(QLabel, "about") if "<a href" in each.text())
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
    paused = window.pause.isChecked()
    tick = next(child for child in window.findChildren(QCheckBox) if child.isVisible())
    before = tick.isChecked()
    tick.setFocus()
    qtbot.keyClick(tick, Qt.Key.Key_Space)
    assert (tick.isChecked(), window.pause.isChecked()) == (not before, paused)
    for elsewhere in (window.waterfall, next(child for child in window.findChildren(QSlider) if child.isVisible())):
        paused = window.pause.isChecked()
        elsewhere.setFocus()
        qtbot.keyClick(elsewhere, Qt.Key.Key_Space)
        assert window.pause.isChecked() is not paused
    paused, line = window.pause.isChecked(), window.findChild(QLineEdit, "search")
    line.setFocus()
    qtbot.keyClicks(line, "beam width")
    assert (line.text(), window.pause.isChecked()) == ("beam width", paused)


def test_large_text_has_room_and_fits_a_window(open_viewer, small, qtbot, qapp):
    usual = qapp.font().pointSizeF()
    enlarge_text(qapp, 200)
    assert qapp.font().pointSizeF() == 2.0 * usual
    viewer = open_viewer(small)
    window = viewer.window
    qapp.processEvents()
    metrics = window.waterfall.fontMetrics()
    panel = window.panels["parameters"].widget
    names = {label.text() for label in panel.findChildren(QLabel, "name") if label.isVisible()}
    assert {"altitude", "beam width", "pulse duration"} <= names
    bar = next(bar for bar in window.findChildren(QTabBar) if bar.isVisible() and bar.count() > 2)
    assert bar.sizeHint().width() <= panel.width()
    field = panel.findChild(QLineEdit, "value")
    assert field.width() > field.fontMetrics().horizontalAdvance("400.5 kHz")
    plot = window.waterfall.plot_area
    assert plot.left() - 9 >= metrics.horizontalAdvance("1000 m")
    assert plot.top() >= metrics.height()
    assert window.waterfall._scaled(16) >= metrics.height()
    # A window of any size shows its views and the lessons side by side.
    lessons = viewer.panels["lessons"].widget
    for shown, (width, height) in product(([], [lessons]), ((900, 540), (1920, 1000))):
        if shown:
            window.open_panel("lessons")
        window.resize(width, height)
        qtbot.waitUntil(lambda width=width: window.width() == width)
        qtbot.wait(100)
        assert (window.width(), window.height()) == (width, height)
        assert_side_by_side(window, panel, window.waterfall, *shown)
        assert window.seabed.isVisible() is (width == 1920)
        if shown:
            buttons = [child for child in lessons.findChildren(QPushButton) if child.isVisible()]
            assert all(button.width() >= button.sizeHint().width() for button in buttons)
        if width == 900:
            panel.horizontalScrollBar().setValue(panel.horizontalScrollBar().maximum())
            fields = (field for field in panel.findChildren(QLineEdit, "value") if field.isVisible())
            field = next(field for field in fields if field.isEnabled() and not field.visibleRegion().isNull())
            assert field.mapTo(window, field.rect().bottomRight()).x() < width, "it scrolls sideways"


def walk(window: QWidget, qtbot) -> set[QWidget]:
    """Press Tab until the keyboard comes round, and return every widget that had it."""
    qtbot.waitUntil(window.isActiveWindow)
    qtbot.keyClick(window, Qt.Key.Key_Tab)
    first = QApplication.focusWidget()
    reached: set[QWidget] = {first}
    for _ in range(400):  # more than any window has controls
        qtbot.keyClick(QApplication.focusWidget(), Qt.Key.Key_Tab)
        focus = QApplication.focusWidget()
        if focus is first and len(reached) > 1:
            break
        reached.add(focus)
    return reached


def find_walked(top: QWidget, window: QWidget, qtbot) -> set[QWidget]:
    """Find the shown and enabled controls below a widget; check that Tab reaches them all and that all have names."""
    wanted = {child for child in controls_of(top) if child.isVisible() and child.isEnabled()}
    assert [place_of(child) for child in wanted - walk(window, qtbot)] == []
    assert [place_of(child) for child in wanted | focusable(top) if not accessible_name(child)] == []
    return wanted


def test_tab_reaches_every_control_in_view_of_an_opened_panel_a_window_and_a_dialog(viewer, qtbot):
    window = viewer.window
    activate(window, qtbot)
    for panel in ("parameters", "plan", "record"):
        bring_to_front(window, panel)
        kinds = {type(child).__name__ for child in find_walked(window, window, qtbot)}
        assert {"QToolButton", "QComboBox", "_Slider", "QLineEdit"} <= kinds
    for name in ("water", "lessons", "pixel", "comparison", "record"):
        viewer.window.open_panel(name)
        panel = viewer.panels[name].view.contacts if name == "record" else viewer.panels[name].widget
        qtbot.waitUntil(panel.isVisible)
        assert find_walked(panel, viewer.window, qtbot) or name != "record"
    for name in ("chart", "jobs"):
        viewer.window.open_panel(name)
        window = viewer.panels[name].widget
        activate(window, qtbot)
        assert find_walked(window, window, qtbot)
        window.close()
    window, scene = viewer.window, load_scene("default")
    dialogs = [make(window) for make in (AboutDialog, scene_gallery, NewScene)]
    dialogs += [KeysDialog(window, window.menus.all), SurveyQuestion(scene, window)]
    dialogs.append(DatasetQuestion(["mines"], sections_of(scene), window))
    for dialog in dialogs:
        dialog.show()
        activate(dialog, qtbot)
        assert find_walked(dialog, dialog, qtbot)
        qtbot.keyClick(dialog, Qt.Key.Key_Escape)
        assert not dialog.isVisible()
        if isinstance(dialog, FolderQuestion):
            controls = set(controls_of(dialog)) - set(dialog.buttons.buttons())
            assert len(controls) >= 5
            assert [place_of(control) for control in controls if not control.toolTip()] == []
