"""Shows what can be undone and redone, and the title with the star of unsaved changes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from insonify_viewer.state.contact_list import ContactList
    from insonify_viewer.state.session import Session
    from insonify_viewer.window.main_window import MainWindow
    from insonify_viewer.window.saving import Saving


class HistoryController:
    """Connects undo and redo of a window with the one history of its session."""

    def __init__(self, session: Session, contacts: ContactList, saving: Saving, window: MainWindow) -> None:
        self._session, self._saving, self._window = session, saving, window
        window.history.undone.connect(session.undo)
        window.history.redone.connect(session.redo)
        session.changed.connect(self._follow_scene)
        session.displayed.connect(lambda _: self._show())
        contacts.changed.connect(self._show)
        self._show()

    def _follow_scene(self, _scene: Any, settled: bool) -> None:
        if settled:
            self._show()

    def _show(self) -> None:
        self._window.show_title(self._session.scene.title, unsaved=self._saving.unsaved)
        self._window.history.show_edits(self._session.undoable, self._session.redoable)
