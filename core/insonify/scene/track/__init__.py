"""Track of the towed sonar: line, altitude or depth, speed and motion."""

from typing import Annotated, Self

from pydantic import model_validator

from insonify.scene.base import Coordinate, Declaration, KindOf, angle, parameter
from insonify.scene.track.motions import MOTIONS, MotionKind, SingleMotion
from insonify.scene.track.motions.lines import Straight


class Track(Declaration):
    """Straight track at constant speed, and the motion of the towfish about it."""

    start: tuple[Coordinate, Coordinate] = parameter((0.0, 0.0), "position of the first ping", "m", rare=True)
    heading: float = angle("direction of travel, counter-clockwise from east; 45T is 45° by the compass")
    altitude: float | None = parameter(
        None,
        "height above the mean bed (10 m when neither altitude nor depth is given)",
        "m",
        gt=0.0,
        le=11000.0,
        slider=(2.0, 50.0),
    )
    depth: float | None = parameter(
        None, "depth of the sonar, instead of its altitude", "m", ge=0.0, le=11000.0, slider=(0.0, 200.0)
    )
    speed: float = parameter(2.0, "speed over ground", "m/s", ge=1e-3, le=50.0, slider=(0.1, 5.0))
    pings: int = parameter(512, "number of pings", ge=1, le=100_000_000, slider=(64, 2048), log=True, rare=True)
    terrain_following: bool = parameter(
        False, "keep the altitude above the bed beneath, smoothed over one altitude to either side", rare=True
    )
    motion: Annotated[MotionKind, KindOf(MOTIONS, default="straight")] = parameter(
        Straight, "motion of the towfish about its line"
    )

    @model_validator(mode="after")
    def _one_height(self) -> Self:
        if self.altitude is not None and self.depth is not None:
            raise ValueError("altitude and depth both fix the sonar's height; give one of the two")
        if self.terrain_following and self.depth is not None:
            raise ValueError("terrain_following keeps an altitude, but depth fixes the height; give altitude instead")
        return self

    @property
    def motions(self) -> tuple[SingleMotion, ...]:
        """The motions of the towfish, one or several."""
        return self.motion.parts

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of motion of the towfish, each once; empty for a straight track."""
        return tuple(dict.fromkeys(motion.kind for motion in self.motions if motion.moves))

    @property
    def heave(self) -> float:
        """Greatest rise and sink of the towfish about its mean height, in metres."""
        return sum(motion.greatest_heave for motion in self.motions)
