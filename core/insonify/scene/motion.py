"""How the fish strays from its line."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from insonify.scene.base import Choice, FilePath, kind_of, parameter


class Straight(Choice):
    """Level, at constant speed, without motion."""

    kind: Literal["straight"] = "straight"


class Oscillation(Choice):
    """A motion to and fro: amplitude · sin(2π t / period + phase), with t from the first ping on."""

    amplitude: float
    period: float = parameter(
        8.0, unit="s", description="time to and fro", ge=0.1, le=1e5, slider=(1.0, 60.0), log=True
    )
    phase: float = parameter(
        0.0,
        unit="°",
        description="how far the motion is at the first ping",
        ge=-360.0,
        le=360.0,
        slider=(-180.0, 180.0),
    )


class Sway(Oscillation):
    """To port and starboard of the line; the fish keeps its heading and crabs."""

    kind: Literal["sway"] = "sway"
    amplitude: float = parameter(
        0.5, unit="m", description="greatest distance to port of the line", ge=0.0, le=100.0, slider=(0.0, 5.0)
    )


class Heave(Oscillation):
    """Up and down."""

    kind: Literal["heave"] = "heave"
    amplitude: float = parameter(
        0.5, unit="m", description="greatest rise above the track's own height", ge=0.0, le=1000.0, slider=(0.0, 3.0)
    )


class Yaw(Oscillation):
    """The axis turns to port and starboard of the line; the course stays."""

    kind: Literal["yaw"] = "yaw"
    amplitude: float = parameter(
        2.0, unit="°", description="greatest turn of the axis to port", ge=0.0, le=60.0, slider=(0.0, 15.0)
    )


class Pitch(Oscillation):
    """The bow goes up and down."""

    kind: Literal["pitch"] = "pitch"
    amplitude: float = parameter(
        2.0, unit="°", description="greatest angle of the bow upwards", ge=0.0, le=60.0, slider=(0.0, 15.0)
    )


class Roll(Oscillation):
    """The port side goes up and down."""

    kind: Literal["roll"] = "roll"
    amplitude: float = parameter(
        3.0, unit="°", description="greatest angle of the port side upwards", ge=0.0, le=60.0, slider=(0.0, 15.0)
    )


class Turn(Choice):
    """The line bends into an arc of a circle and goes on straight."""

    kind: Literal["turn"] = "turn"
    rate: float = parameter(
        3.0, unit="°/s", description="rate of turn, to port if positive", ge=-90.0, le=90.0, slider=(-10.0, 10.0)
    )
    begin: float = parameter(
        10.0,
        unit="s",
        description="time of the first ping to the beginning of the turn",
        ge=0.0,
        le=1e8,
        slider=(0.0, 60.0),
    )
    duration: float = parameter(30.0, unit="s", description="how long it turns", ge=0.0, le=1e8, slider=(0.0, 120.0))


class Recorded(Choice):
    """As a file has it; what the file leaves out is as without it."""

    kind: Literal["recorded"] = "recorded"
    path: FilePath = parameter(
        description="CSV with a column time (s) and any of x, y, depth, altitude (m), heading, pitch, roll (°), "
        "or a record (.nc)",
        min_length=1,
    )


AnyMotion = (
    Annotated[Straight, Tag("straight")]
    | Annotated[Sway, Tag("sway")]
    | Annotated[Heave, Tag("heave")]
    | Annotated[Yaw, Tag("yaw")]
    | Annotated[Pitch, Tag("pitch")]
    | Annotated[Roll, Tag("roll")]
    | Annotated[Turn, Tag("turn")]
    | Annotated[Recorded, Tag("recorded")]
)
_by_kind = Discriminator(lambda value: kind_of(value, "straight"))


class Sum(Choice):
    """Several motions at once."""

    kind: Literal["sum"] = "sum"
    of: tuple[Annotated[AnyMotion, _by_kind], ...] = parameter(
        description="the motions, in any order", min_length=1, max_length=32
    )


Motion = Annotated[AnyMotion | Annotated[Sum, Tag("sum")], _by_kind]
