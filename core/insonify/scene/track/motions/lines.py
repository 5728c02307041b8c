"""Lines of a tow: straight, and with a turn; and several motions at once."""

from typing import Annotated, Literal

from insonify.scene.base import KindOf, parameter
from insonify.scene.track.motions import MOTIONS, MotionKind, SingleMotion, Turning


class SumOfMotions(MotionKind):
    """Several motions at once."""

    rank = 90
    kind: Literal["sum"] = "sum"
    of: tuple[Annotated[SingleMotion, KindOf(MOTIONS, SingleMotion, default="straight")], ...] = parameter(
        description="the motions, in any order", min_length=1, max_length=32
    )

    @property
    def parts(self) -> tuple[SingleMotion, ...]:
        """The motions in declared order."""
        return self.of


class Straight(SingleMotion):
    """A level tow at constant speed."""

    rank = 10
    moves = False
    keeps_line = True
    kind: Literal["straight"] = "straight"


class Turn(SingleMotion):
    """A turn: the line bends into an arc of a circle and then continues straight."""

    rank = 70
    kind: Literal["turn"] = "turn"
    rate: float = parameter(3.0, "rate of turn, to port if positive", "°/s", ge=-90.0, le=90.0, slider=(-10.0, 10.0))
    begin: float = parameter(
        10.0, "time from the first ping to the beginning of the turn", "s", ge=0.0, le=1e8, slider=(0.0, 60.0)
    )
    duration: float = parameter(30.0, "duration of the turn", "s", ge=0.0, le=1e8, slider=(0.0, 120.0))

    @property
    def turning(self) -> Turning:
        """Begin and duration (s) of the bend, and its rate (°/s, to port)."""
        return self.begin, self.duration, self.rate
