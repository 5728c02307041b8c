"""Questions before files are written, and the picture of a window."""

import errno
from collections.abc import Mapping, Sequence
from enum import Enum
from pathlib import Path

from PySide6.QtCore import QMarginsF, QSizeF, QUrl
from PySide6.QtGui import QImage, QPageLayout, QPageSize, QPdfWriter, QPixmap, QTextDocument
from PySide6.QtWidgets import QFileDialog, QMessageBox, QWidget

from insonify.io.atomic import replacing
from insonify.io.records import RECORDS
from insonify_viewer.widgets.text import literal

PICTURE = ".png"
QUICK = 80  # "quality" of a PNG, by which Qt compresses it: a third of the time of the usual one for 4 % more bytes
PRINTED, SCREEN = 150, 96  # dots per inch of a printed page, and those that pictures in a text count by
MARGIN = 8  # of a text, on both sides together, px of the screen
Formats = Sequence[tuple[str, str]]  # names and suffixes


class Answer(Enum):
    """What becomes of unsaved changes."""

    SAVE = QMessageBox.StandardButton.Save
    DISCARD = QMessageBox.StandardButton.Discard
    CANCEL = QMessageBox.StandardButton.Cancel


def record_formats() -> list[tuple[str, str]]:
    """Names and suffixes of the formats in which a record is written, with its picture."""
    names = {suffix: each.description for each in RECORDS.formats() for suffix in each.suffixes}
    return [*((names[suffix], suffix) for suffix in RECORDS.writable()), ("picture", PICTURE)]


def ask_about_changes(window: QWidget, changed: Sequence[str]) -> Answer:
    """Ask what becomes of unsaved changes of one thing or of several, all at once; closing the question cancels."""
    what = " and ".join(changed)
    sentence = f"{what[:1].upper()}{what[1:]} {'has' if len(changed) == 1 else 'have'} changes that are not saved."
    buttons = QMessageBox.StandardButton
    pressed = QMessageBox.question(
        window,
        "Unsaved changes",
        literal(sentence),
        buttons.Save | buttons.Discard | buttons.Cancel,
        buttons.Save,
    )
    return Answer(pressed) if pressed in (buttons.Save, buttons.Discard) else Answer.CANCEL


def ask_about_jobs(window: QWidget, running: int) -> bool:
    """Ask whether jobs that run are to be stopped, since the window closes."""
    what = "A job is" if running == 1 else f"{running} jobs are"
    buttons = QMessageBox.StandardButton
    question = f"{what} still running. Stop and close the window? What is finished stays."
    return (
        QMessageBox.question(window, "Jobs are running", question, buttons.Discard | buttons.Cancel) is buttons.Discard
    )


def ask_where_to_save(window: QWidget, title: str, suggestion: str, formats: Formats) -> Path | None:
    """Ask for the file to write; None if no file was named."""
    filters = {f"{name} (*{suffix})": suffix for name, suffix in formats}
    named, picked = QFileDialog.getSaveFileName(window, title, suggestion, ";;".join(filters))
    if not named:
        return None
    path = Path(named)
    if path.suffix.lower() in filters.values():
        return path
    path = path.with_name(path.name + filters.get(picked, formats[0][1]))
    if not path.exists():
        return path
    question = f"{path.name} exists already. Replace it?"  # the dialog asked about the name without the suffix
    answer = QMessageBox.question(window, "Replace the file?", literal(question))
    return path if answer is QMessageBox.StandardButton.Yes else None


def save_picture(window: QWidget, path: Path) -> None:
    """Write a picture of the window as PNG."""
    save_pixmap(window.grab(), path)


def save_pixmap(picture: QPixmap, path: Path) -> None:
    """Write a picture as PNG."""
    with replacing(path) as beside:
        if not picture.save(str(beside), "PNG", QUICK):
            raise OSError(errno.EIO, "the picture cannot be written", str(path))


def print_markdown(text: str, pictures: Mapping[str, QPixmap], path: Path) -> None:
    """Print a text in Markdown as PDF on pages of A4, with the pictures that it names as wide as the page."""
    with replacing(path) as beside:
        writer = QPdfWriter(str(beside))
        writer.setPageSize(QPageSize(QPageSize.PageSizeId.A4))
        writer.setPageMargins(QMarginsF(20.0, 20.0, 20.0, 20.0), QPageLayout.Unit.Millimeter)
        writer.setResolution(PRINTED)
        document = QTextDocument()
        document.setMarkdown(text)  # before the pictures, which it would remove
        document.documentLayout().setPaintDevice(writer)
        document.setPageSize(QSizeF(writer.width(), writer.height()))
        for name, picture in pictures.items():
            opaque = picture.toImage().convertToFormat(QImage.Format.Format_RGB32)
            opaque.setDevicePixelRatio(opaque.width() / (writer.width() * SCREEN / PRINTED - MARGIN))
            document.addResource(QTextDocument.ResourceType.ImageResource, QUrl(name), opaque)
        document.markContentsDirty(0, document.characterCount())  # the pictures have their size now
        document.print_(writer)
        del writer  # which ends the file
        if not beside.exists() or beside.stat().st_size == 0:
            raise OSError(errno.EIO, "the page cannot be written", str(path))
