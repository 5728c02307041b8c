"""List of contacts with their pictures, and fields for name and note of the chosen one."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Signal
from PySide6.QtGui import QIcon, QPixmap
from PySide6.QtWidgets import QGridLayout, QLabel, QLineEdit, QListWidget, QListWidgetItem, QWidget

from insonify_viewer.state.contacts import Contact
from insonify_viewer.widgets.push_button import push_button

ICON = 56  # px
HINT = "Point at the record and press C, or pin a pixel and click Mark."


class ContactListView(QWidget):
    """Lists contacts, and signals what the person does to them."""

    mark_wanted = Signal()
    remove_wanted = Signal(int)
    jump_wanted = Signal(int)
    chosen = Signal(int)  # -1 for none
    edited = Signal(int, str, str)  # which, name of the field, text
    open_wanted = Signal()
    save_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.list = QListWidget()
        self.list.setObjectName("contacts")
        self.list.setAccessibleName("Contacts")
        self.list.setIconSize(QSize(ICON, ICON))
        self.list.setMinimumHeight(3 * ICON)
        self.list.setToolTip("A double click, or Enter, shows the contact in its record")
        self.list.currentRowChanged.connect(self._choose)
        self.list.itemActivated.connect(lambda item: self.jump_wanted.emit(self.list.row(item)))
        self.name, self.note = _line("Name of the contact"), _line("Note on the contact")
        self.name.editingFinished.connect(lambda: self._edit("name", self.name))
        self.note.editingFinished.connect(lambda: self._edit("note", self.note))
        self.mark = push_button("Mark", "Mark a contact at the pinned pixel; C marks one under the mouse")
        self.jump = push_button("Show", "Show the contact in its record")
        self.remove = push_button("Remove", "Remove the contact from the list")
        self.open = push_button("Open…", "Open a file of contacts in place of these")
        self.save = push_button("Save…", "Save the contacts as GeoJSON with their pictures, or as a CSV table")
        self.hint = QLabel(HINT)
        self.hint.setObjectName("about")
        self.hint.setWordWrap(True)
        self.mark.clicked.connect(self.mark_wanted)
        self.jump.clicked.connect(lambda: self.jump_wanted.emit(self.list.currentRow()))
        self.remove.clicked.connect(lambda: self.remove_wanted.emit(self.list.currentRow()))
        self.open.clicked.connect(self.open_wanted)
        self.save.clicked.connect(self.save_wanted)
        self._contacts: Sequence[Contact] = ()
        self._lay()
        self.show_contacts(())

    def show_contacts(self, contacts: Sequence[Contact]) -> None:
        """List contacts; the chosen one stays chosen, or the first new one if there are more than before."""
        row = self.list.currentRow()
        if len(contacts) > len(self._contacts):
            shared = zip(contacts, self._contacts, strict=False)
            row = next((number for number, (new, old) in enumerate(shared) if new is not old), len(self._contacts))
        self.list.blockSignals(True)
        for number, contact in enumerate(contacts):
            # An entry holds a picture: those that stay are not made again at every change of the scene.
            if number >= len(self._contacts) or contact is not self._contacts[number]:
                self.list.takeItem(number)
                self.list.insertItem(number, _item(contact))
        while self.list.count() > len(contacts):
            self.list.takeItem(self.list.count() - 1)
        self._contacts = tuple(contacts)
        self.list.setCurrentRow(min(row, len(contacts) - 1))
        self.list.blockSignals(False)
        self.hint.setVisible(not contacts)
        self.list.setVisible(bool(contacts))
        self.save.setEnabled(bool(contacts))
        self._choose(self.list.currentRow())

    def _choose(self, row: int) -> None:
        there = 0 <= row < len(self._contacts)
        for widget in (self.name, self.note, self.jump, self.remove):
            widget.setEnabled(there)
        self.name.setText(self._contacts[row].name if there else "")
        self.note.setText(self._contacts[row].note if there else "")
        self.chosen.emit(row if there else -1)

    def _edit(self, name: str, line: QLineEdit) -> None:
        row = self.list.currentRow()
        if 0 <= row < len(self._contacts) and line.text() != getattr(self._contacts[row], name):
            self.edited.emit(row, name, line.text())

    def _lay(self) -> None:
        grid = QGridLayout(self)
        grid.setContentsMargins(6, 6, 2, 6)
        grid.setSpacing(5)
        grid.addWidget(self.hint, 0, 0, 1, 3)
        grid.addWidget(self.list, 1, 0, 1, 3)
        for row, (text, line) in enumerate((("name", self.name), ("note", self.note)), start=2):
            label = QLabel(text)
            label.setObjectName("name")
            label.setBuddy(line)
            grid.addWidget(label, row, 0)
            grid.addWidget(line, row, 1, 1, 2)
        for column, button in enumerate((self.mark, self.jump, self.remove)):
            grid.addWidget(button, 4, column)
        grid.addWidget(self.open, 5, 0)
        grid.addWidget(self.save, 5, 1)


def _item(contact: Contact) -> QListWidgetItem:
    """Entry of a contact: its picture, its name and where it is."""
    place = f"ping {contact.ping}, {contact.side}, {contact.slant_range:.1f} m slant"
    item = QListWidgetItem("\n".join(filter(None, [contact.name, place, contact.note])))
    picture = QPixmap()
    if contact.snapshot and picture.loadFromData(contact.snapshot):
        item.setIcon(QIcon(picture))
    where = "" if contact.x is None or contact.y is None else f", x {contact.x:.2f} m, y {contact.y:.2f} m"
    item.setToolTip(f"{contact.name}: {place}{where}; {contact.source}")
    return item


def _line(name: str) -> QLineEdit:
    line = QLineEdit()
    line.setObjectName("line")
    line.setAccessibleName(name)
    line.setToolTip(name)
    line.returnPressed.connect(line.clearFocus)
    return line
