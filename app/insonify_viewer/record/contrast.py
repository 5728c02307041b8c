"""Contrast by which a record is shown, chosen from it while it fills."""

from __future__ import annotations

from typing import TYPE_CHECKING

from insonify.display.display_options import DisplayOptions
from insonify.display.picture import choose_contrast

if TYPE_CHECKING:
    from insonify_viewer.record.record import Record
    from insonify_viewer.record.waterfall_view import WaterfallView
    from insonify_viewer.state.session import Session

SAMPLED = 4  # every so many rows are looked at


class Contrast:
    """Shows a record by the display options, and chooses the ends of the palette where these leave them open."""

    def __init__(self, waterfall: WaterfallView, session: Session) -> None:
        self._waterfall, self._decibels = waterfall, session.display.decibels
        self.due = True
        session.displayed.connect(self._show)
        waterfall.show_display(session.display)

    def settle(self, record: Record, *, complete: bool) -> None:
        """Choose the contrast anew if it is due, for the last time when the record is complete."""
        if self.due:
            heard = record.amplitude[record.ping >= 0][::SAMPLED]
            self._waterfall.show_levels(choose_contrast(heard, decibels=self._decibels))
            self.due = not complete

    def _show(self, look: DisplayOptions) -> None:
        self._waterfall.show_display(look)
        if look.decibels is not self._decibels:
            self._decibels, self.due = look.decibels, True
            self.settle(self._waterfall.record, complete=True)
