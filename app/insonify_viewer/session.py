"""Session: the scene, its modelling, the history of both, and the marked point; without widgets."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from insonify.display.display_options import DisplayOptions
from insonify.scene import Scene, SceneError, edit
from insonify_viewer.dependent_edits import add_dependent_edits
from insonify_viewer.modelling import Modelling

UNDO_DEPTH = 200


class Event:
    """A list of callbacks that are called together."""

    def __init__(self) -> None:
        self._listeners: list[Callable[..., None]] = []

    def connect(self, listener: Callable[..., None]) -> None:
        """Add a callback; callbacks run in the order they were added."""
        self._listeners.append(listener)

    def emit(self, *values: Any) -> None:
        """Call every callback with these values."""
        for listener in self._listeners:
            listener(*values)


@dataclass(frozen=True)
class Mark:
    """A bin of the record.

    Attributes
    ----------
    ping : int
        Number of the ping.
    side : int
        0 for port, 1 for starboard.
    bin : int
        Range bin, counted from the sonar.
    """

    ping: int
    side: int
    bin: int


@dataclass(frozen=True)
class _State:
    scene: Scene
    modelling: Modelling


class Session:
    """The scene on screen, its modelling, and the history of both.

    An edit under way (a slider being dragged) is provisional: every move starts from the last settled scene, so that
    the dependent edits of a move vanish when the slider returns. Settling makes one step of undo of the whole drag.

    Parameters
    ----------
    scene : Scene
        Scene to start with.

    Attributes
    ----------
    changed : Event
        Called with (scene, settled) after every change.
    said : Event
        Called with one sentence for the person.
    marked : Event
        Called with the marked point of the record, or None.
    displayed : Event
        Called with the display options of the records.
    file : str
        File of the person's own that the scene was last read from or written to; empty if there is none.
    """

    def __init__(self, scene: Scene) -> None:
        self.changed, self.said, self.marked, self.displayed = Event(), Event(), Event(), Event()
        self._display = DisplayOptions()
        self._scene, self._settled = scene, _State(scene, Modelling())
        self._past: list[_State] = []
        self._future: list[_State] = []
        self._mark: Mark | None = None
        self._saved = {"": scene}
        self.file = ""

    @property
    def scene(self) -> Scene:
        """The current scene, provisional edits included."""
        return self._scene

    @property
    def modelling(self) -> Modelling:
        """The modelling of the scene."""
        return self._settled.modelling

    @property
    def mark(self) -> Mark | None:
        """The marked point of the record."""
        return self._mark

    @property
    def display(self) -> DisplayOptions:
        """Display options of the simulated record and of recordings."""
        return self._display

    def show(self, **options: Any) -> None:
        """Change some of the display options; they are no part of the scene, and no step of undo."""
        display = self._display._replace(**options)
        if display != self._display:
            self._display = display
            self.displayed.emit(display)

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to undo."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to redo."""
        return bool(self._future)

    def drag(self, changes: Mapping[str, Any]) -> bool:
        """Apply changes provisionally to the last settled scene; return whether they are valid."""
        scene = self._edited(changes)
        if scene is None:
            return False
        if scene != self._scene:
            self._scene = scene
            self.changed.emit(scene, False)
        return True

    def settle(self, changes: Mapping[str, Any] | None = None) -> bool:
        """Apply changes finally, or those of the drag under way; return whether they are valid."""
        scene = self._scene if changes is None else self._edited(changes)
        if scene is None:
            # The widget that asked must return to the valid value.
            self.changed.emit(self._scene, True)
            return False
        self._turn_to(_State(scene, self.modelling))
        return True

    @property
    def unsaved(self) -> bool:
        """Whether the scene differs from every one that was opened or saved, as it is in its file now."""
        return self._scene not in self._saved.values()

    def mark_saved(self, file: str) -> None:
        """Note that the scene is in a file as it is."""
        self._saved[file] = self._scene
        self.file = file
        self.changed.emit(self._scene, True)

    def open(self, scene: Scene, file: str = "", *, bundled: bool = False) -> None:
        """Replace the scene, with no choice forced, as one step of undo.

        Parameters
        ----------
        scene : Scene
            Scene to turn to.
        file : str
            File that it was read from; a scene without one counts as not saved.
        bundled : bool
            Whether that file comes with the program, and is not to be written.
        """
        if file:
            self._saved[file] = scene
        self.file = "" if bundled else file
        self._turn_to(_State(scene, self.modelling.automatic))

    def model(self, modelling: Modelling) -> None:
        """Change the modelling, as one step of undo."""
        self._turn_to(_State(self._settled.scene, modelling))

    def turn_to(self, scene: Scene, modelling: Modelling) -> None:
        """Turn to a scene and its modelling as both were before, as one step of undo."""
        self._turn_to(_State(scene, modelling))

    def undo(self) -> None:
        """Go back one step."""
        if self._past:
            self._future.append(self._settled)
            self.said.emit("")
            self._show(self._past.pop())

    def take_back(self) -> None:
        """Return from a scene that cannot be simulated, without a step to redo."""
        if self._scene == self._settled.scene and self._past:
            self._settled = self._past.pop()
        self._show(self._settled)

    def redo(self) -> None:
        """Go forward one step."""
        if self._future:
            self._past.append(self._settled)
            self.said.emit("")
            self._show(self._future.pop())

    def point_at(self, mark: Mark | None) -> None:
        """Mark a point of the record."""
        if mark != self._mark:
            self._mark = mark
            self.marked.emit(mark)

    def _turn_to(self, state: _State) -> None:
        if state != self._settled:
            self._past = [*self._past, self._settled][-UNDO_DEPTH:]
            self._future = []
        self._show(state)

    def _show(self, state: _State) -> None:
        self._scene, self._settled = state.scene, state
        self.changed.emit(state.scene, True)

    def _edited(self, changes: Mapping[str, Any]) -> Scene | None:
        """Edit the settled scene; report an invalid edit and return None for it."""
        try:
            complete, remark = add_dependent_edits(self._settled.scene, changes)
            scene = edit(self._settled.scene, complete)
        except SceneError as error:
            self.said.emit(str(error))
            return None
        self.said.emit(remark)
        return scene
