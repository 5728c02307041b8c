"""Questions whose answers take a while, of which only the newest counts."""

from collections.abc import Callable
from functools import partial
from typing import Any

Question = tuple[Any, ...]
Receive = Callable[[Any], None]


class NewestWins:
    """Asks what is wanted once, and shows the answer if that is still wanted when it comes; else it asks again."""

    # ``wanted`` returns the question, None for none; ``send`` passes ``work`` to the thread that answers it.
    # With ``in_turn`` there is one question at a time, and each answer is shown: a picture that follows a slider.

    def __init__(
        self,
        wanted: Callable[[], Question | None],
        send: Callable[[Callable[[], Any], Receive], None],
        work: Callable[..., Any],
        show: Receive,
        *,
        in_turn: bool = False,
    ) -> None:
        self._wanted, self._send, self._work, self._show, self._in_turn = wanted, send, work, show, in_turn
        self._asked: Question | None = None
        self.shown: Question | None = None

    @property
    def complete(self) -> bool:
        """Whether what is wanted is shown, or nothing is wanted."""
        wanted = self._wanted()
        return wanted is None or (self.shown == wanted and self._asked is None)

    def ask(self) -> bool:
        """Ask for what is wanted, unless it is shown or asked for already; whether it was asked."""
        wanted = self._wanted()
        if wanted is None or (self._asked is not None and self._in_turn) or wanted == (self._asked or self.shown):
            return False
        self._asked = wanted
        self._send(partial(self._work, *wanted), partial(self._take, wanted))
        return True

    def forget(self) -> None:
        """Forget what is shown and asked for."""
        self._asked = self.shown = None

    def _take(self, asked: Question, answer: Any) -> None:
        if self._asked == asked:
            self._asked = None
        newest = asked == self._wanted()
        if newest or self._in_turn:
            self.shown = asked
            self._show(answer)
        if not newest:
            self.ask()
