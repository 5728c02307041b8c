"""A ping of a live tow."""

from typing import NamedTuple

import numpy as np

from insonify.arrays import Singles
from insonify.io.records.survey_log import LoggedPing


class LivePing(NamedTuple):
    """A ping of one towfish, as it is sent."""

    fish: int  # number of the towfish, from 0
    header: LoggedPing  # number, time, place on Earth and attitude
    intensity: Singles  # (2, bins) as a record has it, port first
    course: float  # over ground, in degrees clockwise from north
    pose: dict[str, float]  # place and attitude in the scene, in metres and degrees, by their names in a record

    @property
    def amplitudes(self) -> Singles:
        """Amplitudes near to far, (2, bins)."""
        return np.sqrt(self.intensity)
