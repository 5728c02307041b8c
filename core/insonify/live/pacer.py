"""Times of pings on a monotonic clock, and how late the pings were."""

import time
from collections.abc import Callable

import numpy as np

SECOND = 10**9  # ns
STEP, STEPS = 100_000, 10_000  # ns, and number of steps of the histogram of latenesses, which ends at 1 s


class Pacer:
    """Waits for pings, each of which is due a whole number of periods after the first: no wait adds to the next.

    A tow that is more than a second behind skips pings, which are counted in ``missed``. One that is faster than real
    time skips none: its clock is put back.
    """

    def __init__(
        self,
        rate: float,
        *,
        skips: bool = True,
        clock: Callable[[], int] = time.monotonic_ns,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        self._rate, self._skips, self._clock, self._sleep = rate, skips, clock, sleep
        self.waited = self.missed = 0
        self._late = np.zeros(STEPS, np.int64)  # pings by their lateness; a tow of any length takes no more
        self.restart(0)

    def restart(self, ping: int) -> None:
        """Let a ping be due now, after a pause."""
        self._begun, self._first = self._clock(), ping

    def due(self, ping: int) -> int:
        """Time at which a ping is due, in nanoseconds of the clock; rounded once, so that the error does not grow."""
        return self._begun + round((ping - self._first) * SECOND / self._rate)

    def wait(self, ping: int) -> int:
        """Sleep until a ping is due, and return it; a later one if it should have been sent over a second ago."""
        if (behind := self._clock() - self.due(ping)) > SECOND:
            if self._skips:
                skipped = int(behind * self._rate / SECOND)
                self.missed, ping = self.missed + skipped, ping + skipped
            else:
                self.restart(ping)
        while (left := self.due(ping) - self._clock()) > 0:
            self._sleep(left / SECOND)
        self.waited += 1
        self._late[min(-left // STEP, STEPS - 1)] += 1
        return ping

    def lateness(self, share: float) -> float:
        """Lateness in milliseconds that a share of the pings did not exceed."""
        return float((np.searchsorted(self._late.cumsum(), share * self.waited) + 1) * STEP / 1e6)
