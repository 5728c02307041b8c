"""Jobs are begun, followed and stopped by the keyboard alone, and screen readers hear what they are."""

import time
from collections.abc import Callable

import pytest
from controls import accessible_name
from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QApplication, QFileDialog, QWidget
from test_jobs import PATIENCE, advanced, jobs_of
from test_menus import activate

from insonify.scene import edit
from insonify_viewer.panels.jobs import view as jobs_window
from insonify_viewer.work.jobs import State


@pytest.fixture
def endless_work(small):
    """A scene whose record takes minutes."""
    return edit(small, {"sonar.beam": "knife", "track.pings": 1_000_000})


def focus() -> QWidget:
    """Widget that has the keyboard."""
    held = QApplication.focusWidget()
    assert held is not None
    return held


def press(qtbot, key: Qt.Key, modifier=Qt.KeyboardModifier.NoModifier):
    qtbot.keyClick(focus(), key, modifier)


def begin_waiting(viewer, title: str):
    """Begin work that ends when it is stopped."""

    def work(report: Callable[[float], None]):
        while True:
            time.sleep(0.02)
            report(0.4)

    return viewer.jobs.begin_work(title, work)


def test_a_record_is_begun_followed_and_stopped(open_viewer, endless_work, qtbot, tmp_path, monkeypatch):
    viewer = open_viewer(endless_work)
    path = tmp_path / "record.nc"
    monkeypatch.setattr(jobs_window, "ask_where_to_save", lambda *_: path)
    activate(viewer.window, qtbot)
    qtbot.keyClick(viewer.window, Qt.Key.Key_J, Qt.KeyboardModifier.ControlModifier)
    view = viewer.panels["jobs"].widget
    activate(view, qtbot)
    assert focus() is view.record
    press(qtbot, Qt.Key.Key_Return)
    (job,) = viewer.jobs.jobs
    qtbot.waitUntil(lambda: advanced(job), timeout=PATIENCE)
    (row,) = view.rows
    for _ in range(5):  # past the other buttons
        press(qtbot, Qt.Key.Key_Tab)
    assert focus() is row
    heard = accessible_name(row)
    assert heard.startswith("writing record.nc: ")
    assert "of 1000000 pings" in heard
    press(qtbot, Qt.Key.Key_Tab)
    assert focus() is row.stop
    assert accessible_name(row.stop) == "Stop: writing record.nc"
    press(qtbot, Qt.Key.Key_Return)
    assert focus() is row, "the keyboard stays at the job that was stopped"
    qtbot.waitUntil(lambda: not job.running, timeout=10_000)
    assert job.state is State.STOPPED
    assert "stopped" in accessible_name(row)
    assert list(tmp_path.iterdir()) == []
    press(qtbot, Qt.Key.Key_L, Qt.KeyboardModifier.AltModifier)
    qtbot.waitUntil(lambda: not view.rows)  # a button that is pressed by its letter is shown pressed for a moment
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert not view.isVisible()


def test_keys_go_from_job_to_job_in_the_order_in_which_they_stand(viewer, qtbot):
    view = jobs_of(viewer)
    activate(view, qtbot)
    for title in ("first", "second", "third"):
        begin_waiting(viewer, title)
    first, second, third = view.rows
    qtbot.waitUntil(first.isVisible)
    view.forget.setFocus()
    order = []
    for _ in range(6):
        press(qtbot, Qt.Key.Key_Tab)
        order.append(focus())
    assert order == [third, third.stop, second, second.stop, first, first.stop]
    first.setFocus()
    press(qtbot, Qt.Key.Key_Up)
    assert focus() is second
    press(qtbot, Qt.Key.Key_Delete)
    qtbot.waitUntil(lambda: not viewer.jobs.jobs[1].running, timeout=10_000)
    assert [job.state for job in viewer.jobs.jobs] == [State.RUNNING, State.STOPPED, State.RUNNING]
    for job in viewer.jobs.running:
        job.stop()
    qtbot.waitUntil(lambda: not viewer.jobs.running, timeout=10_000)


def test_the_bar_of_the_window_opens_the_list_and_stops_the_newest(viewer, qtbot):
    activate(viewer.window, qtbot)
    older, newer = begin_waiting(viewer, "older"), begin_waiting(viewer, "newer")
    bar = viewer.window.jobs
    qtbot.waitUntil(bar.isVisible)
    bar.setFocus(Qt.FocusReason.TabFocusReason)
    assert bar.focusPolicy() & Qt.FocusPolicy.TabFocus
    heard = QAccessible.queryAccessibleInterface(bar)
    qtbot.waitUntil(lambda: heard.text(QAccessible.Text.Description).startswith("newer"))
    qtbot.keyClick(bar, Qt.Key.Key_Delete)
    qtbot.waitUntil(lambda: not newer.running, timeout=10_000)
    assert older.running
    qtbot.keyClick(bar, Qt.Key.Key_Return)
    view = viewer.panels["jobs"].widget
    qtbot.waitUntil(view.isVisible)
    older.stop()
    qtbot.waitUntil(lambda: not older.running, timeout=10_000)


def test_a_file_is_named_by_the_keyboard(open_viewer, endless_work, qtbot, tmp_path):
    """Through the dialog itself: its field has the keyboard, and Return saves."""
    viewer = open_viewer(endless_work)
    view = jobs_of(viewer)
    activate(view, qtbot)
    QApplication.setAttribute(Qt.ApplicationAttribute.AA_DontUseNativeDialogs)

    def answer():
        dialog, focused = QApplication.activeModalWidget(), QApplication.focusWidget()
        # The keyboard may come to the dialog later than the dialog to the screen.
        if not isinstance(dialog, QFileDialog) or focused is None or not dialog.isAncestorOf(focused):
            QTimer.singleShot(50, answer)
            return
        qtbot.keyClicks(focus(), str(tmp_path / "record.nc"))
        qtbot.keyClick(focus(), Qt.Key.Key_Return)

    QTimer.singleShot(50, answer)
    press(qtbot, Qt.Key.Key_Return)
    (job,) = viewer.jobs.jobs
    assert job.result == tmp_path / "record.nc"
    job.stop()
    qtbot.waitUntil(lambda: not job.running, timeout=PATIENCE)
