"""Text of files in the window: every character is shown as it is, none is obeyed."""

import re

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QTextDocumentFragment
from PySide6.QtWidgets import QAbstractButton, QLabel, QListWidget, QMessageBox, QWidget

from insonify import simulate
from insonify.io.contacts import Contact, read_contacts, write_contacts
from insonify.io.records import write_record
from insonify.scene import edit
from insonify.surveys.lines.specification import SurveySpecification
from insonify_viewer.widgets.save_dialogs import ask_about_changes
from insonify_viewer.widgets.text import entry_name, literal, one_line, window_title

SHOWN = "<img src=x> R&D &amp; <b>loud"  # a name of a file as well: without a slash
HOSTILE = f"\x1b]0;owned\x07\u202e{SHOWN}[*]\u2066"
MARK = "img src"
OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def rich(text: str, form: Qt.TextFormat = Qt.TextFormat.AutoText) -> str:
    """Return what a widget shows of a text that may be HTML."""
    as_html = form is Qt.TextFormat.RichText or (form is Qt.TextFormat.AutoText and re.search("<[a-z!/]", text))
    return QTextDocumentFragment.fromHtml(text).toPlainText() if as_html else text


def without_shortcuts(text: str) -> str:
    """Return what a menu or a button shows of a text."""
    return re.sub("&(.)", r"\1", text)


def shown_texts(top: QWidget) -> list[tuple[str, str]]:
    """List every text that a window shows, with where it does."""
    found = [("title", top.windowTitle().replace("[*][*]", "[mark]").replace("[*]", "").replace("[mark]", "[*]"))]
    for widget in [top, *top.findChildren(QWidget)]:
        name = f"{type(widget).__name__} {widget.objectName()}"
        found.append((f"tip of {name}", rich(widget.toolTip())))
        if isinstance(widget, QLabel):
            found.append((name, rich(widget.text(), widget.textFormat())))
        if isinstance(widget, QAbstractButton):
            found.append((name, without_shortcuts(widget.text())))
        if isinstance(widget, QListWidget):
            entries = [widget.item(row) for row in range(widget.count())]
            found += [(name, entry.text()) for entry in entries] + [(name, rich(entry.toolTip())) for entry in entries]
    for action in top.findChildren(QAction):
        found += [("action", without_shortcuts(action.text())), ("tip of action", rich(action.toolTip()))]
    return found


def show_the_scene(viewer, tmp_path):
    """Show nothing but the scene: its title is in the title of the window."""


def say_an_error(viewer, tmp_path):
    """Show an error that quotes a file."""
    viewer.window.status.say(f"{HOSTILE}: does not exist", lasting=True)


def list_recent_files(viewer, tmp_path):
    """List a file among the recent ones."""
    viewer.window.settings.add_recent(str(tmp_path / f"{HOSTILE}.toml"))
    viewer.window.recent.fill()


def open_contacts(viewer, tmp_path):
    """Open a file of contacts, change one, and remove it: the history names it."""
    point = {"ping": 3, "side": "port", "range_bin": 40, "slant_range": 9.0}
    write_contacts(tmp_path / "contacts.csv", [Contact(name=HOSTILE, note=HOSTILE, source=HOSTILE, **point)] * 2)
    viewer.contacts.open(read_contacts(tmp_path / "contacts.csv"), "contacts.csv")
    viewer.contacts.edit(0, "note", "a rock")
    viewer.contacts.remove(1)


def keep_as_a(viewer, tmp_path):
    """Keep the record as A, beside which B is changed."""
    viewer.comparison.keep()
    viewer.session.settle({"track.altitude": 7.0})


def open_a_recording(viewer, tmp_path):
    """Open a record from a file with such a name."""
    path = tmp_path / f"{HOSTILE}.nc"
    write_record(path, [simulate(edit(viewer.session.scene, {"track.pings": 4})).assign_attrs(title=HOSTILE)])
    viewer.recordings.open(str(path))


def run_a_job(viewer, tmp_path):
    """Show a job that is named by the scene."""
    viewer.jobs.begin_work(f"chart of {HOSTILE}", lambda report: None)


CASES = [  # with the number of texts that each adds to those that are shown
    (show_the_scene, 4),
    (say_an_error, 2),
    (list_recent_files, 2),
    (open_contacts, 4),
    (keep_as_a, 1),
    (open_a_recording, 2),
    (run_a_job, 2),
]


def test_text_of_files_is_shown_as_it_is(open_viewer, small, tmp_path, qtbot):
    viewer, before = open_viewer(edit(small, {"title": HOSTILE, "description": HOSTILE})), set()
    for show, texts in CASES:
        show(viewer, tmp_path)
        qtbot.waitUntil(lambda: viewer.complete)
        qtbot.wait(50)
        marked = {(where, text) for where, text in shown_texts(viewer.window) if MARK in text}
        assert len(marked - before) >= texts, marked
        for where, text in marked:
            assert SHOWN in text, where
            assert not OBEYED.search(text), where
        before = marked


def test_a_question_shows_a_title_as_it_is(qtbot, monkeypatch):
    asked = []
    monkeypatch.setattr(QMessageBox, "question", lambda *words: asked.append(words[2]))
    ask_about_changes(None, [f"the scene “{HOSTILE}”"])
    assert SHOWN in rich(asked[0])
    assert not OBEYED.search(asked[0])


def test_text_of_files_is_made_plain():
    assert literal("a < b & c\x1b") == "<span>a &lt; b &amp; c</span>"
    assert literal("R&D\x9b") == "R&D"
    assert entry_name("R&D\tx\ny") == "R&&D x y"
    assert window_title("a[*]\x07") == "a[*][*]"
    assert one_line(" a\n\u202eb ") == "a b"


def test_declared_words_hold_no_control_characters(small):
    assert edit(small, {"title": HOSTILE}).title == "]0;owned" + SHOWN + "[*]"
    page = SurveySpecification.model_validate(
        {"base": "default", "title": HOSTILE, "lines": [{"start": [0, 0], "end": [9, 0]}]}
    )
    assert not OBEYED.search(page.title)
