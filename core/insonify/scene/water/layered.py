"""Waters given by their properties at depths, declared or measured."""

import itertools
import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from insonify.arrays import Floats, Integers
from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.io.file_access import warn_of_file
from insonify.io.sound_speed_casts import Cast, read_cast
from insonify.scene.base import FilePath, angle, parameter
from insonify.scene.water import SoundSpeeds, WaterKind, speeds_by_depth
from insonify.scene.water.sound_speed import EQUATIONS, describe_range

# m/s, greatest error of the segments; their mean error, two thirds of it, is 6e-8 s over 100 m.
CURVE_TOLERANCE = 0.002
FINER = 0.1  # share of the tolerance that the sampling of a curve takes
MOST_PARTS = 4096  # samples of one interval between knots
# A summer thermocline, the default of layered waters.
DEPTHS = (0.0, 8.0, 16.0, 60.0)
SPEEDS = (1520.0, 1519.0, 1501.0, 1500.0)
MOST_POINTS = 10_000  # points of a profile
CAST_TOLERANCE = 0.02  # m/s, greatest error of the segments: the accuracy of a measured speed
Interpolation = Literal["linear", "pchip"]
Equation = Literal["paper", "mackenzie", "teos10"]
Depth = Annotated[float, Field(ge=0.0, le=12000.0)]
Distance = Annotated[float, Field(ge=-1e6, le=1e6)]
Speed = Annotated[float, Field(ge=1300.0, le=1700.0)]
Temperature = Annotated[float, Field(ge=-2.0, le=40.0)]
Salinity = Annotated[float, Field(ge=0.0, le=45.0)]


def approximate_by_segments(
    curve: Callable[[Floats], Floats], knots: Floats, tolerance: float
) -> tuple[Floats, Floats]:
    """Approximate a curve by straight segments; returns their ends."""
    parts = [_sampled(curve, low, high, FINER * tolerance) for low, high in itertools.pairwise(knots)]
    places = np.concatenate([*(part[:-1] for part in parts), knots[-1:]])
    values = curve(places)
    kept = thin_polyline(places, values, (1.0 - FINER) * tolerance)
    return places[kept], values[kept]


def _sampled(curve: Callable[[Floats], Floats], low: float, high: float, tolerance: float) -> Floats:
    """Divide an interval into equal parts, so many that their chords stay within the tolerance."""
    parts = 1
    while True:
        ends = np.linspace(low, high, parts + 1)
        within = np.linspace(low, high, 8 * parts + 1)
        error = float(np.abs(np.interp(within, ends, curve(ends)) - curve(within)).max())
        if error <= tolerance or parts >= MOST_PARTS:
            return ends
        # The error of a chord falls as the square of its length.
        parts = min(max(parts + 1, int(np.ceil(parts * np.sqrt(error / tolerance)))), MOST_PARTS)


def thin_polyline(places: Floats, values: Floats, tolerance: float) -> Integers:
    """Choose points; the segments between them pass all others within the tolerance (Douglas and Peucker 1973)."""
    kept = np.zeros(places.size, dtype=bool)
    kept[[0, -1]] = True
    pending = [(0, places.size - 1)]
    while pending:
        first, last = pending.pop()
        inner = slice(first + 1, last)
        chord = np.interp(places[inner], places[[first, last]], values[[first, last]])
        away = np.abs(values[inner] - chord)
        if away.size and away.max() > tolerance:
            worst = first + 1 + int(away.argmax())
            kept[worst] = True
            pending += [(first, worst), (worst, last)]
    return np.flatnonzero(kept)


def approximate_pchip(places: Floats, values: Floats, tolerance: float) -> tuple[Floats, Floats]:
    """Approximate the PCHIP curve through points, which does not overshoot as a spline does, by straight segments."""
    from scipy.interpolate import PchipInterpolator  # lazy: SciPy takes longer to import than a scene to read

    return approximate_by_segments(PchipInterpolator(places, values), places, tolerance)


def check_order(what: str, instead: str, places: tuple[float, ...]) -> tuple[float, ...]:
    """Return places, or raise ValueError if they do not increase."""
    if not 2 <= len(places) <= MOST_POINTS:
        raise ValueError(f"must have from 2 to {MOST_POINTS} points, not {len(places)}; {instead}")
    for before, after in itertools.pairwise(places):
        if after <= before:
            fault = f"has {before:g} m twice" if after == before else f"goes from {before:g} back to {after:g} m"
            raise ValueError(f"must increase, but {what} {fault}; sort it in increasing order without duplicates")
    return places


DOWNWARDS = AfterValidator(partial(check_order, "depth", "for one sound speed use kind 'uniform'"))
ONWARDS = AfterValidator(partial(check_order, "distance", "for horizontally uniform water use kind 'profile'"))


class LayeredWater(WaterKind):
    """Water of properties given at depths, constant above the first and below the last."""

    depth: Annotated[tuple[Depth, ...], DOWNWARDS] = parameter(
        DEPTHS, "depths at which the properties are given, downwards", "m", slider=(0.0, 100.0)
    )


def interpolation() -> Any:
    """Declare how a sound speed is interpolated between depths."""
    return parameter("linear", "interpolation between the depths: linear, or smooth without overshoot", rare=True)


def check_length(what: str, count: int, depth: tuple[float, ...]) -> None:
    """Raise ValueError for a column without exactly one value for each depth."""
    if count != len(depth):
        numbers = f"{count} number{'s' * (count != 1)}"
        raise ValueError(f"{what} has {numbers} for {len(depth)} depths; give one for each depth")


class ProfileWater(LayeredWater, kind="profile", rank=20):
    """Water of given speeds at given depths."""

    table: ClassVar[frozenset[str]] = frozenset({"depth", "sound_speed"})
    sound_speed: tuple[Speed, ...] = parameter(SPEEDS, "speed of sound at those depths", "m/s", slider=(1400.0, 1600.0))
    interpolation: Interpolation = interpolation()

    @model_validator(mode="after")
    def _one_speed_a_depth(self) -> Self:
        check_length("sound_speed", len(self.sound_speed), self.depth)
        return self

    def sound_speeds(self) -> SoundSpeeds:
        """Speed between the depths, linear or along a curve."""
        if self.interpolation == "linear":
            return speeds_by_depth(self.depth, self.sound_speed)
        return speeds_by_depth(*approximate_pchip(np.array(self.depth), np.array(self.sound_speed), CURVE_TOLERANCE))


class HydrographyWater(LayeredWater, kind="hydrography", rank=30):
    """Water of given temperature and salinity, linear between the depths; the speed follows from an equation."""

    table: ClassVar[frozenset[str]] = frozenset({"depth", "temperature", "salinity"})
    temperature: tuple[Temperature, ...] = parameter(
        (18.0, 17.6, 11.6, 11.0), "temperature at those depths", "°C", slider=(0.0, 30.0)
    )
    salinity: Salinity | tuple[Salinity, ...] = parameter(
        35.0, "practical salinity at those depths, or one number for all", slider=(0.0, 40.0)
    )
    equation: Equation = parameter("teos10", "equation of sound speed", rare=True)

    @model_validator(mode="after")
    def _one_value_a_depth(self) -> Self:
        check_length("temperature", len(self.temperature), self.depth)
        if isinstance(self.salinity, tuple):
            check_length("salinity", len(self.salinity), self.depth)
        return self

    def sound_speeds(self) -> SoundSpeeds:
        """Speed by the equation from temperature and salinity that are linear between the depths."""
        depth = np.array(self.depth)
        salinity = np.broadcast_to(np.asarray(self.salinity, dtype=np.float64), depth.shape)

        def speed(places: Floats) -> Floats:
            temperature = np.interp(places, depth, np.array(self.temperature))
            return EQUATIONS[self.equation](temperature, np.interp(places, depth, salinity), places)

        return speeds_by_depth(*approximate_by_segments(speed, depth, CURVE_TOLERANCE))

    def describe_limits(self, frequency: float) -> Iterator[str]:
        """Describe values outside the range of the equation of sound speed."""
        yield from describe_range(self.equation, self.temperature, self.salinity, self.depth)


class SectionWater(LayeredWater, kind="section", rank=50):
    """Water that varies horizontally: sound speed profiles along a line through the scene's (0, 0)."""

    table: ClassVar[frozenset[str]] = frozenset({"distance", "depth", "sound_speed"})
    varies_along = True
    distance: Annotated[tuple[Distance, ...], ONWARDS] = parameter(
        (0.0, 200.0), "places of the profiles along the line", "m", slider=(-100.0, 100.0)
    )
    sound_speed: tuple[tuple[Speed, ...], ...] = parameter(
        (SPEEDS, (1520.0, 1520.0, 1515.0, 1500.0)),
        "speed of sound: for every distance, a list over the depths",
        "m/s",
        slider=(1400.0, 1600.0),
    )
    heading: float = angle("direction of the line, counter-clockwise from east; 45T is 45° by the compass")

    @model_validator(mode="after")
    def _one_profile_a_distance(self) -> Self:
        if len(self.sound_speed) != len(self.distance):
            raise ValueError(
                f"sound_speed has {len(self.sound_speed)} profiles for {len(self.distance)} distances; give one each"
            )
        for number, profile in enumerate(self.sound_speed):
            check_length(f"sound_speed.{number}", len(profile), self.depth)
        return self

    def sound_speeds(self) -> SoundSpeeds:
        """Speeds of the profiles along the line."""
        return SoundSpeeds(
            np.array(self.depth), np.array(self.sound_speed), np.array(self.distance), math.radians(self.heading)
        )


@kept_until_changed(maxsize=4)
def _read_cast_once(path: str) -> Cast:
    cast = read_cast(path)
    warn_of_file(path, cast.remarks)
    return cast


class CastWater(WaterKind, kind="cast", rank=40):
    """Water measured by an instrument cast."""

    path: FilePath = parameter(description="measured cast: Sea-Bird .cnv, .asvp, .svp or CSV", min_length=1)
    interpolation: Interpolation = interpolation()
    equation: Equation | None = parameter(
        None,
        "equation of sound speed from temperature and salinity (when left out, the cast's own speed if it "
        "has one, otherwise teos10)",
        rare=True,
    )

    def sound_speeds(self) -> SoundSpeeds:
        """Measured speed, reduced to few points."""
        cast = _read_cast_once(self.path)
        speed = self._speeds_of(cast)
        if self.interpolation == "pchip" and cast.depth.size > 1:
            return speeds_by_depth(*approximate_pchip(cast.depth, speed, CAST_TOLERANCE))
        kept = thin_polyline(cast.depth, speed, CAST_TOLERANCE)
        return speeds_by_depth(cast.depth[kept], speed[kept])

    def remarks(self) -> tuple[str, ...]:
        """Rows of the file that are left out, and why."""
        return _read_cast_once(self.path).remarks

    def describe_limits(self, frequency: float) -> Iterator[str]:
        """Describe measurements outside the range of the equation of sound speed, where one is used."""
        cast = _read_cast_once(self.path)
        if cast.temperature is not None and cast.salinity is not None and (self.equation or cast.sound_speed is None):
            yield from describe_range(self.equation or "teos10", cast.temperature, cast.salinity, cast.depth)

    def _speeds_of(self, cast: Cast) -> Floats:
        """Sound speed of a cast, or by an equation from its temperature and salinity."""
        if cast.sound_speed is not None and self.equation is None:
            speed = cast.sound_speed
        elif cast.temperature is None or cast.salinity is None:
            raise SceneError(
                f"water.equation: {self.equation!r} needs temperature and salinity, which {self.path!r} lacks; "
                "leave it out to take the cast's own speed"
            )
        else:
            speed = EQUATIONS[self.equation or "teos10"](cast.temperature, cast.salinity, cast.depth)
        wrong = np.flatnonzero(~((speed >= 1300.0) & (speed <= 1700.0)))
        if wrong.size:
            raise SceneError(
                f"water.path: {self.path!r} gives {speed[wrong[0]]:.6g} m/s at {cast.depth[wrong[0]]:.4g} m, no "
                "possible speed of sound in water (1300 to 1700 m/s); correct or remove that row"
            )
        return np.asarray(speed)
