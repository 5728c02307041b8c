"""Timer that calls a function once, a moment after it was asked for."""

from collections.abc import Callable

from PySide6.QtCore import QObject, QTimer


class Later(QTimer):
    """Calls the last function that it was given, a time after the last request or, not ``anew``, after the first."""

    def __init__(self, parent: QObject, milliseconds: int, *, anew: bool = True) -> None:
        super().__init__(parent, singleShot=True, interval=milliseconds)
        self._anew = anew
        self._call: Callable[[], object] = lambda: None
        self.timeout.connect(lambda: self._call())

    def call(self, do: Callable[[], object]) -> None:
        """Call a function later, in place of one that waits."""
        self._call = do
        if self._anew or not self.isActive():
            self.start()
