"""What the person inspects: a pinned pixel of the record, a picked place of the scene, and what is drawn of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from insonify_viewer.state.session import Event, Mark

if TYPE_CHECKING:
    from insonify_viewer.record.waterfall_view import WaterfallView
    from insonify_viewer.seabed.controller import SeabedController

Points = NDArray[np.float64]
Place = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class SoundDrawing:
    """The sound of one pixel in three dimensions, in local coordinates, m."""

    rays: tuple[Points, ...]  # ways of the sound that is heard, and of the sound that something keeps from the bed
    blocked: tuple[Points, ...]
    heard: Points  # (n, 2, 3) stretches of bed and targets that echo in the pixel, and of bed that is hidden
    hidden: Points


class Inspection:
    """Pinned pixel, picked place, and their pictures."""

    def __init__(self) -> None:
        self.pinned, self.picked, self.lit, self.drawn = Event(), Event(), Event(), Event()
        self._mark: Mark | None = None

    @property
    def mark(self) -> Mark | None:
        """The pinned pixel."""
        return self._mark

    def connect(self, waterfall: WaterfallView, seabed: SeabedController) -> None:
        """Follow clicks into both views, and show in both what is inspected."""
        waterfall.clicked.connect(self.pin)
        self.pinned.connect(waterfall.show_pin)
        self.lit.connect(waterfall.show_lit)
        self.drawn.connect(seabed.show_sound)
        self.picked.connect(seabed.show_pick)
        seabed.picked.connect(self.pick)

    def pin(self, mark: Mark | None) -> None:
        """Pin a pixel; the pinned one, clicked again, or None, is let go."""
        self._mark = None if mark == self._mark else mark
        if self._mark is None:
            self.drawn.emit(None)
        self.pinned.emit(self._mark)

    def pick(self, place: Place | None) -> None:
        """Pick a place of the bed or of a target."""
        self.lit.emit(())
        self.picked.emit(place)

    def clear(self) -> None:
        """Let go of pixel and place."""
        self.pin(None)
        self.pick(None)
