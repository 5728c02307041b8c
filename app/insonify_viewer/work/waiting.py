"""What the record waits for, and how much of it is done."""

from dataclasses import dataclass
from typing import NamedTuple

DELAY = 0.4  # s, of missing pings before they count as waited for
FEW = 16  # missing pings that a running tow always has


class Waiting(NamedTuple):
    """What the worker does at present, for which the record waits."""

    what: str = ""  # in words; empty for nothing
    share: float | None = None  # share done; None while it is not known


@dataclass
class WaitingWatch:
    """Decides whether the record waits, from looks at it at any times."""

    _number: int = -1
    _arrived: int = -1
    _since: float | None = None
    _at_first: int = 0

    def look(
        self, now: float, *, number: int, arrived: int, missing: int, shown: int, running: bool, activity: Waiting
    ) -> Waiting | None:
        """Return what the record waits for; None while it does not wait, or not for long."""
        if missing <= (FEW if running else 0):
            self._since = None
            return None
        if self._since is None or arrived != self._arrived:
            self._since, self._at_first = now, missing
        self._arrived = arrived
        if number != self._number:
            self._number, self._at_first = number, missing
        self._at_first = max(self._at_first, missing)
        if now - self._since < DELAY:
            return None
        if activity.what:
            return activity
        return Waiting(f"simulating pings, {shown - missing} of {shown}", 1.0 - missing / self._at_first)
