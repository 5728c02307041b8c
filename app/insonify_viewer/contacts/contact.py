"""A contact, and the list of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from insonify_viewer.session import Event, Mark

SIDES = ("port", "starboard")


@dataclass(frozen=True)
class Contact:
    """A point of a record with a name.

    Attributes
    ----------
    name, note : str
        As the person writes them.
    source : str
        Title of the scene, or name of the file of the recording.
    ping : int
    side : str
        ``port`` or ``starboard``.
    range_bin : int
    slant_range : float
        In metres.
    ground_range : float or None
        In metres; None in the water column.
    x, y : float or None
        Place in metres of the scene or of the recording's map; None where it is not known.
    longitude, latitude : float or None
        In degrees; None where the map is not known.
    snapshot : bytes
        Picture around it as PNG; empty if there is none.
    """

    name: str
    note: str
    source: str
    ping: int
    side: str
    range_bin: int
    slant_range: float
    ground_range: float | None = None
    x: float | None = None
    y: float | None = None
    longitude: float | None = None
    latitude: float | None = None
    snapshot: bytes = b""

    @property
    def mark(self) -> Mark:
        """Its bin."""
        return Mark(self.ping, SIDES.index(self.side), self.range_bin)


class ContactList:
    """The contacts of a session, in the order in which they were marked.

    Attributes
    ----------
    changed : Event
        Called after every change.
    file : str
        File that they were last read from or written to; empty if there is none.
    """

    def __init__(self) -> None:
        self.changed = Event()
        self.file = ""
        self._contacts: tuple[Contact, ...] = ()
        self._saved: tuple[Contact, ...] = ()

    def __len__(self) -> int:
        return len(self._contacts)

    def __getitem__(self, index: int) -> Contact:
        return self._contacts[index]

    @property
    def all(self) -> Sequence[Contact]:
        """Every contact."""
        return self._contacts

    @property
    def unsaved(self) -> bool:
        """Whether the contacts differ from those in their file."""
        return self._contacts != self._saved

    def add(self, contact: Contact) -> None:
        """Add a contact; one without a name gets the next number."""
        if not contact.name:
            taken = {each.name for each in self._contacts}
            free = next(f"contact {k}" for k in range(1, len(taken) + 2) if f"contact {k}" not in taken)
            contact = replace(contact, name=free)
        self._show((*self._contacts, contact))

    def edit(self, index: int, **changes: Any) -> None:
        """Change fields of a contact."""
        contacts = list(self._contacts)
        contacts[index] = replace(contacts[index], **changes)
        self._show(contacts)

    def remove(self, index: int) -> None:
        """Remove a contact."""
        self._show((*self._contacts[:index], *self._contacts[index + 1 :]))

    def open(self, contacts: Iterable[Contact], file: str) -> None:
        """Replace all contacts by those of a file."""
        self._saved, self.file = tuple(contacts), file
        self._show(self._saved)

    def mark_saved(self, file: str) -> None:
        """Note that the contacts are in a file as they are."""
        self._saved, self.file = self._contacts, file
        self.changed.emit()

    def _show(self, contacts: Iterable[Contact]) -> None:
        self._contacts = tuple(contacts)
        self.changed.emit()
