"""Contacts of a session, and their file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from psygnal import Signal

from insonify_viewer.state.contacts import Contact
from insonify_viewer.state.session import Session


class ContactList:
    """Contacts of a session in the order of marking, and their file; each change is a step of undo."""

    changed = Signal()

    def __init__(self, session: Session) -> None:
        self.file = ""
        self._session = session
        self._saved: dict[str, tuple[Contact, ...]] = {"": ()}
        session.contacts_changed.connect(lambda: self.changed.emit())

    def __len__(self) -> int:
        return len(self.all)

    def __getitem__(self, index: int) -> Contact:
        return self.all[index]

    @property
    def all(self) -> tuple[Contact, ...]:
        """Every contact."""
        return self._session.contacts

    @property
    def unsaved(self) -> bool:
        """Whether the contacts differ from those of every file that was opened or saved, as it is now."""
        return self.all not in self._saved.values()

    def add(self, contact: Contact) -> None:
        """Add a contact; one without a name gets the next number."""
        if not contact.name:
            taken = {each.name for each in self.all}
            free = next(f"contact {k}" for k in range(1, len(taken) + 2) if f"contact {k}" not in taken)
            contact = replace(contact, name=free)
        self._session.list_contacts((*self.all, contact), f"{contact.name} marked")

    def edit(self, index: int, field: str, text: str) -> None:
        """Change the name of a contact, or the note on it."""
        contact = self.all[index]
        change: dict[str, Any] = {field: text}
        name = f"{contact.name} renamed" if field == "name" else f"{field} on {contact.name}"
        self._session.list_contacts((*self.all[:index], replace(contact, **change), *self.all[index + 1 :]), name)

    def remove(self, index: int) -> None:
        """Remove a contact."""
        others = (*self.all[:index], *self.all[index + 1 :])
        self._session.list_contacts(others, f"{self.all[index].name} removed")

    def open(self, contacts: Iterable[Contact], file: str) -> None:
        """Replace all contacts by those of a file, or by some that are in none if its name is empty."""
        opened = tuple(contacts)
        if file:
            self._saved[file] = opened
        self.file = file
        if opened == self.all:
            self.changed.emit()  # no step, but the list is that of the file now
        self._session.list_contacts(opened, f"open {Path(file).name or 'contacts'}")

    def mark_saved(self, file: str) -> None:
        """Note that the contacts are in a file as they are."""
        self._saved[file] = self.all
        self.file = file
        self.changed.emit()
