"""Clock of the tow: the newest ping, and the ping on top of the screen."""

from __future__ import annotations

SPEEDS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


class TowClock:
    """Counts pings at the ping rate times a speed; a paused clock can look back."""

    def __init__(self, newest: int) -> None:
        self.running = True
        self.speed = 1.0
        self._position = float(newest)
        self._back = 0

    @property
    def newest(self) -> int:
        """Newest ping sent."""
        return int(self._position)

    @property
    def top(self) -> int:
        """Ping on top of the screen: the newest, or an earlier one when looking back."""
        return self.newest - self._back

    def advance(self, seconds: float, ping_rate: float) -> bool:
        """Count the pings of some seconds; return whether a new ping was sent."""
        if not self.running:
            return False
        before = self.newest
        self._position += seconds * ping_rate * self.speed
        return self.newest > before

    def run(self, running: bool) -> None:
        """Run on from the ping on top of the screen, or pause."""
        self.running = running
        if running and self._back:
            self._position, self._back = float(self.top), 0

    def look_back(self, pings: int) -> None:
        """Move the paused screen back by some pings, within those that were sent."""
        if not self.running:
            self._back = min(max(self._back + pings, 0), self.newest)

    def go_to(self, ping: int) -> None:
        """Pause, and put a ping on top of the screen; pings up to it count as sent."""
        self.running = False
        self._position = max(self._position, float(ping))
        self._back = self.newest - ping

    def restart(self, newest: int) -> None:
        """Start again at a ping."""
        self._position, self._back = float(newest), 0
