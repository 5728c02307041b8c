"""Session: the scene, its modelling, contacts, their history, and the marked point; without widgets."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from psygnal import Signal

from insonify.display.display_options import DisplayOptions
from insonify.io.contacts import Contact
from insonify.scene import Scene, SceneError, edit
from insonify.scene_edits import add_dependent_edits
from insonify_viewer.state.fields import name_display, name_edit
from insonify_viewer.state.history import History, Modelling, State
from insonify_viewer.state.inspection import Mark

EDITS = {"note": "note on", "classification": "class of"}  # names of edits of contacts


class Session:
    """The scene on screen, its modelling, the contacts, and the one history of all."""

    # An edit under way (a slider being dragged) is provisional: every move starts from the last settled scene, so that
    # the dependent edits of a move vanish when the slider returns. Settling makes one step of undo of the whole drag.

    changed = Signal(object, bool)  # the scene, and False while a slider moves
    said = Signal(str)  # a sentence for the status bar
    marked = Signal(object)  # the `Mark` under the mouse, or None
    displayed = Signal(object)  # the `DisplayOptions`
    refused = Signal(object)  # the `SceneError` of an edit
    contacts_changed = Signal()

    def __init__(self, scene: Scene) -> None:
        self.scene = scene  # the current scene, provisional edits included
        self.history = History(State(scene, Modelling(), scene))
        self._dragged = ""
        self.mark: Mark | None = None  # the marked point of the record
        self._saved = {"": scene}
        self.file = ""

    @property
    def modelling(self) -> Modelling:
        """The modelling of the scene."""
        return self.history.present.modelling

    @property
    def display(self) -> DisplayOptions:
        """Display options of the simulated record and of recordings."""
        return self.history.present.display

    def show(self, name: str = "", **options: Any) -> None:
        """Change some of the display options, by a step of undo that takes up further changes of the same."""
        # While edits of the scene or of contacts can be redone, it is no step of its own: they stay.
        display = self.display._replace(**options)
        if display != self.display:
            self.history.show(display, name or name_display(self.display, display))
            self.displayed.emit(display)

    def show_first(self, **options: Any) -> None:
        """Begin with display options of an earlier start, without a step of undo."""
        self.history.show_first(self.display._replace(**options))
        self.displayed.emit(self.display)

    @property
    def opened(self) -> Scene:
        """The scene as it was opened, to which fields are reset."""
        return self.history.present.opened

    def drag(self, changes: Mapping[str, Any]) -> bool:
        """Apply changes provisionally to the last settled scene; return whether they are valid."""
        scene = self._edited(changes)
        if scene is None:
            return False
        if scene != self.scene:
            self._dragged = name_edit(scene, changes)
            self.scene = scene
            self.changed.emit(scene, False)
        return True

    def settle(self, changes: Mapping[str, Any] | None = None, name: str = "", said: str = "") -> bool:
        """Apply changes finally, or those of the drag under way; return whether they are valid."""
        scene = self.scene if changes is None else self._edited(changes, said)
        if scene is None:
            # The widget that asked must return to the valid value.
            self.changed.emit(self.scene, True)
            return False
        name = name or (self._dragged if changes is None else name_edit(scene, changes))
        self._turn_to(scene=scene, edit=name)
        return True

    def list_contacts(self, contacts: Iterable[Contact], name: str) -> None:
        """Put other contacts in place of the present ones, as one step of undo of a name; a drag goes on."""
        before = self.history.present
        self.history.turn_to(replace(before, contacts=tuple(contacts), edit=name))
        self._announce_contacts(before)

    @property
    def unsaved(self) -> bool:
        """Whether the scene differs from every one that was opened or saved, as it is in its file now."""
        return self.scene not in self._saved.values()

    def count_as_saved(self, name: str, scene: Scene) -> None:
        """Count a scene as saved that is kept elsewhere than in a file of its own."""
        self._saved[name] = scene

    def mark_saved(self, file: str) -> None:
        """Note that the scene is in a file as it is."""
        self._saved[file] = self.scene
        self.file = file
        self.changed.emit(self.scene, True)

    def open(self, scene: Scene, file: str = "", *, bundled: bool = False) -> None:
        """Replace the scene, with no choice forced, as one step of undo."""
        if file:
            self._saved[file] = scene
        self.file = "" if bundled else file
        self._turn_to(scene=scene, modelling=self.modelling.automatic, opened=scene, edit=f"open {scene.title}")

    def model(self, modelling: Modelling) -> None:
        """Change the modelling, as one step of undo."""
        subjects = {subject for subject, _ in {*modelling.forced} ^ {*self.modelling.forced}}
        name = ", ".join(sorted(subjects)) if subjects else "tolerance"
        self._turn_to(modelling=modelling, edit=name)

    def turn_to(self, scene: Scene, modelling: Modelling, name: str = "") -> None:
        """Turn to a scene and its modelling as both were before, as one step of undo."""
        self._turn_to(scene=scene, modelling=modelling, edit=name or f"back to {scene.title}")

    def undo(self, steps: int = 1) -> None:
        """Go back some steps."""
        self._step(-steps)

    def redo(self, steps: int = 1) -> None:
        """Go forward some steps."""
        self._step(steps)

    def take_back(self) -> None:
        """Return from a scene that cannot be simulated, without a step to redo."""
        if self.scene == self.history.present.scene:
            self.history.take_back()
        self._show_scene()

    def point_at(self, mark: Mark | None) -> None:
        """Mark a point of the record."""
        if mark != self.mark:
            self.mark = mark
            self.marked.emit(mark)

    def _step(self, steps: int) -> None:
        """Move through the history, and announce what differs there."""
        before = self.history.present
        if not self.history.step(steps):
            return
        self.said.emit("")
        self._announce_contacts(before)
        now = self.history.present
        if now.display != before.display:
            self.displayed.emit(now.display)
        if now.scene is not self.scene or (now.modelling, now.opened) != (before.modelling, before.opened):
            self._show_scene()

    def _turn_to(self, **changes: Any) -> None:
        """Change the present state by one step, and show its scene, in place of one that is dragged."""
        self.history.turn_to(replace(self.history.present, **changes))
        self._show_scene()

    def _show_scene(self) -> None:
        self.scene = self.history.present.scene
        self.changed.emit(self.scene, True)

    def _announce_contacts(self, before: State) -> None:
        if self.history.present.contacts != before.contacts:
            self.contacts_changed.emit()

    def _edited(self, changes: Mapping[str, Any], said: str = "") -> Scene | None:
        """Edit the settled scene; report an invalid edit and return None for it."""
        try:
            complete, remark = add_dependent_edits(self.history.present.scene, changes)
            scene = edit(self.history.present.scene, complete)
        except SceneError as error:
            self.refused.emit(error)
            return None
        self.said.emit("; ".join(filter(None, (said, remark))))
        return scene


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
        """Every contact, in the order of marking."""
        return self._session.history.present.contacts

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

    def edit(self, index: int, field: str, value: object) -> None:
        """Change a field of a contact."""
        contact = self.all[index]
        change: dict[str, Any] = {field: value}
        name = f"{contact.name} renamed" if field == "name" else f"{EDITS.get(field, f'{field} of')} {contact.name}"
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
