"""Several motions at once."""

from typing import Annotated, Literal

from insonify.scene.base import KindOf, parameter
from insonify.scene.track.motions import MOTIONS, MotionKind, SingleMotion


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
