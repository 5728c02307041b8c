"""What the person inspects: a pinned pixel of the record, a picked place of the scene, and what is drawn of both."""

from dataclasses import dataclass

from psygnal import Signal

from insonify.arrays import Floats
from insonify.io.contacts import SIDES, Contact

Place = tuple[float, float, float]


@dataclass(frozen=True)
class Mark:
    """A bin of the record."""

    ping: int  # number of the ping
    side: int  # 0 for port, 1 for starboard
    bin: int  # range bin, counted from the sonar

    @property
    def side_name(self) -> str:
        """Name of the side."""
        return SIDES[self.side]


def mark_of(contact: Contact) -> Mark:
    """Bin of a contact."""
    return Mark(contact.ping, SIDES.index(contact.side), contact.range_bin)


@dataclass(frozen=True, eq=False)
class SoundDrawing:
    """The sound of one pixel in three dimensions, in local coordinates, m."""

    rays: tuple[Floats, ...]  # rays of the sound that returns, and of the sound that something keeps from the bed
    blocked: tuple[Floats, ...]
    echoing: Floats  # (n, 2, 3) stretches of bed and targets that echo in the pixel, and of bed that is hidden
    hidden: Floats


class Inspection:
    """Pinned pixel, picked place, and their pictures."""

    pinned = Signal(object)  # the `Mark`, or None
    picked = Signal(object)  # the `Place`, or None
    lit = Signal(tuple)  # pixels of the record that are lit
    drawn = Signal(object)  # the `SoundDrawing`, or None

    def __init__(self) -> None:
        self.mark: Mark | None = None

    def pin(self, mark: Mark | None) -> None:
        """Pin a pixel; the pinned one, clicked again, or None, is let go."""
        self.mark = None if mark == self.mark else mark
        if self.mark is None:
            self.drawn.emit(None)
        self.pinned.emit(self.mark)

    def pick(self, place: Place | None) -> None:
        """Pick a place of the bed or of a target."""
        self.lit.emit(())
        self.picked.emit(place)

    def clear(self) -> None:
        """Let go of pixel and place."""
        self.pin(None)
        self.pick(None)
