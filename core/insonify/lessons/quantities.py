"""Quantities that questions of lessons ask for: closed forms of a scene, or measured in a simulated record."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from insonify.arrays import Booleans, Dataset, Floats
from insonify.scene import Scene
from insonify.scene.seabed.materials.sediments import scattering_strength
from insonify.scene.sonar.beams.line_array import LineArray
from insonify.scene.water.sound_speed import teos10

if TYPE_CHECKING:
    from insonify.explanation.sonar_equation import SonarEquation

CHANNEL_SIDES = ("port", "starboard")
# −3 dB width of a line array, one-way and two-way, in wavelengths over its length (docs/theory/beam.md).
THREE_DECIBELS = {
    "uniform": (0.886, 0.638), "cosine": (1.189, 0.851), "hamming": (1.304, 0.929), "taylor": (1.125, 0.804),
}  # fmt: skip
TEMPERATURES = np.linspace(-2.0, 40.0, 421)  # °C, of sea water
DARK = 1e-3  # share of the brightest echo below which a bin counts as dark


class Quantity(NamedTuple):
    """A named quantity."""

    arguments: tuple[str, ...]  # names, with units in brackets
    meaning: str  # what it is, with its unit in brackets
    compute: Callable[..., float] | None = None  # closed form of (scene, *arguments)
    measure: Callable[..., float] | None = None  # the same from (scene, record, *arguments)


def _speed(scene: Scene) -> float:
    # lazy: loads Numba, and few questions need the sound speed
    from insonify.acoustics.water import recording_speed

    return recording_speed(scene)


def _sonar_speed(scene: Scene) -> float:
    # lazy: as above
    from insonify.acoustics.water import speed_at_sonar

    return speed_at_sonar(scene)


def _wavelength(scene: Scene) -> float:
    return _speed(scene) / scene.sonar.frequency


def _slant_range(scene: Scene, across: float, height: float) -> float:
    return math.hypot(across, scene.altitude - height)


def _ground_range(scene: Scene, slant_range: float) -> float:
    return math.sqrt(slant_range**2 - scene.altitude**2)


def _shadow_end(scene: Scene, across: float, height: float) -> float:
    """Slant range at which the ray over a point meets the bed: A / (A − h) times that of the point."""
    return _slant_range(scene, across, height) * scene.altitude / (scene.altitude - height)


def _round_height(scene: Scene, across: float, radius: float) -> float:
    """Height that the formula of a shadow gives for a round body on the bed, between the two rays that touch it."""
    above = scene.altitude - radius
    axis, half = math.atan2(above, across), math.asin(radius / math.hypot(across, above))
    return scene.altitude * (1.0 - math.sin(axis - half) / math.sin(axis + half))


def _beam_width(scene: Scene) -> float:
    """One-way full width in degrees; of an array to −3 dB in the far field, docs/theory/beam.md."""
    beam = scene.sonar.beam
    if isinstance(beam, LineArray):
        return math.degrees(THREE_DECIBELS[beam.taper][0] * _wavelength(scene) / beam.length)
    return float(getattr(beam, "width", 0.0))


def _recorded_width(scene: Scene) -> float:
    """Full width of the beam in degrees as a record has it, to −3 dB: two-way where the beam sends and receives."""
    beam = scene.sonar.beam
    if not getattr(beam, "two_way", False):
        return _beam_width(scene)
    if isinstance(beam, LineArray):
        return _beam_width(scene) * THREE_DECIBELS[beam.taper][1] / THREE_DECIBELS[beam.taper][0]
    return _beam_width(scene) / math.sqrt(2.0)  # a Gaussian times itself


def _along_resolution(scene: Scene, slant_range: float) -> float:
    beam = scene.sonar.beam
    length = beam.length if isinstance(beam, LineArray) else 0.0
    return max(length, slant_range * math.radians(_recorded_width(scene)))


def _ping_spacing(scene: Scene) -> float:
    return scene.track.speed / scene.sonar.ping_rate


@lru_cache(maxsize=8)
def _sonar_equation(scene: Scene, target_strength: float = 0.0) -> "tuple[SonarEquation, SonarEquation]":
    """Sonar equation over the record, and over several times its range."""
    # lazy: loads Numba, and few questions need levels
    from insonify.explanation.sonar_equation import solve_sonar_equation

    return solve_sonar_equation(scene, target_strength)


def _bed_level(scene: Scene, slant_range: float) -> float:
    near, _ = _sonar_equation(scene)
    return float(near.bed.decibels[near.bin_at(slant_range)])


def _noise_level(scene: Scene, slant_range: float) -> float:
    near, _ = _sonar_equation(scene)
    return float(near.disturbance[near.bin_at(slant_range)])


def _target_level(scene: Scene, target_strength: float, slant_range: float) -> float:
    near, _ = _sonar_equation(scene, target_strength)
    return float(near.target.decibels[near.bin_at(slant_range)])


def _backscatter(scene: Scene, grazing: float) -> float:
    """Strength of the first material of the bed by its law, dB re 1 m² per m²."""
    _, rows = scene.seabed.material.rows(scene.sonar.scattering_frequency)
    return 10.0 * math.log10(float(scattering_strength(rows[0], np.sin(np.radians(grazing)))))


def _looks_spread(_: Scene, looks: float) -> float:
    """Return the standard deviation of the level of the mean of looks, whose logarithm has the variance ψ′(n)."""
    from scipy.special import polygamma  # lazy: takes longer to import than most questions

    return 10.0 / math.log(10.0) * math.sqrt(float(polygamma(1, looks)))


def _sea_speed(_: Scene, temperature: float, salinity: float, depth: float) -> float:
    return float(teos10(temperature, salinity, depth))


def _sea_temperature(_: Scene, speed: float, salinity: float) -> float:
    return float(np.interp(speed, teos10(TEMPERATURES, salinity, 0.0), TEMPERATURES))


def _edges(scene: Scene) -> Floats:
    return np.linspace(0.0, scene.sonar.range, scene.sonar.bins + 1)


def _dark_stretch(scene: Scene, record: Dataset) -> tuple[float, float]:
    """Slant ranges between which the longest stretch without echo behind the first return lies."""
    # Of the ping abreast of the first target, on its side.
    across, along = scene.targets[0].position[1] - scene.track.start[1], scene.targets[0].position[0]
    ping = round((along - scene.track.start[0]) / _ping_spacing(scene))
    side = CHANNEL_SIDES[0] if across > 0.0 else CHANNEL_SIDES[1]
    edges, intensity = _edges(scene), record.intensity.isel(ping_time=ping).sel(channel=side).to_numpy()
    dark = np.flatnonzero(np.diff(np.concatenate([[1], (intensity > 0.0).astype(int), [1]])))
    starts, ends = dark[::2], dark[1::2]
    longest = int(np.argmax(np.where(edges[starts] > scene.altitude, ends - starts, 0)))
    return float(edges[starts[longest]]), float(edges[ends[longest]])


def _edge_of_echoes(scene: Scene, record: Dataset, order: int = 1) -> float:
    """Median over pings of the slant range of the first bin with an echo, or of the last with the order -1."""
    echo = record.intensity.to_numpy()[..., ::order] > 0.0
    return float(np.median(_edges(scene)[::order][echo.any(axis=0).argmax(axis=1)]))


def _between(measure: Callable[[Floats], float]) -> Callable[..., float]:
    """Measure the intensity between two slant ranges, (sides, pings, bins)."""

    def measured(scene: Scene, record: Dataset, near: float, far: float) -> float:
        centres = 0.5 * (_edges(scene)[1:] + _edges(scene)[:-1])
        return float(measure(record.intensity.to_numpy()[..., (centres >= near) & (centres <= far)]))

    return measured


def _contrast(within: Floats) -> float:
    """Spread of the mean over pings about a parabola of the logarithms, which takes off its fall with range."""
    mean = within.mean(axis=(0, 1))
    logarithm, place = np.log(np.maximum(mean, 1e-30)), np.linspace(-1.0, 1.0, mean.size)
    return float(np.std(logarithm - np.polyval(np.polyfit(place, logarithm, 2), place)))


def _along_contrast(within: Floats) -> float:
    louder = max(within, key=np.max)
    return float(louder.std(axis=0).mean() / louder.mean())


def _along_period(within: Floats) -> float:
    """Pings per wave at the peak of the spectrum along the track."""
    louder = max(within, key=np.max)
    power = np.square(np.abs(np.fft.rfft(louder - louder.mean(axis=0), axis=0))).sum(axis=1)
    return len(louder) / float(power.argmax())


def _slant(within: Floats) -> float:
    """Share by which waves that run to one side across range and track exceed those that run to the other."""
    louder = max(within, key=np.max)
    power = np.square(np.abs(np.fft.fft2(louder - louder.mean(axis=0))))
    half = power[:, 1 : (power.shape[1] + 1) // 2]  # waves of positive frequency over range
    up, down = half[1 : (len(half) + 1) // 2].sum(), half[len(half) // 2 + 1 :].sum()
    return float(abs(up - down) / (up + down))


def _loud(within: Floats) -> Booleans:
    """Whether the strongest bin of each ping exceeds a quarter of the greatest intensity, on the louder side."""
    strongest = max(within, key=np.max).max(axis=1)
    return np.asarray(strongest > 0.25 * strongest.max())


def _echoes(within: Floats) -> float:
    loud = _loud(within)
    return float(np.count_nonzero(np.diff(loud, prepend=False) & loud))


def _echo_range(scene: Scene, record: Dataset, near: float, far: float) -> float:
    """Slant range of the centre of the strongest bin between two slant ranges, of the mean over pings."""
    centres = 0.5 * (_edges(scene)[1:] + _edges(scene)[:-1])
    mean = record.intensity.to_numpy().mean(axis=1) * ((centres >= near) & (centres <= far))
    return float(centres[mean.max(axis=0).argmax()])


def _track(scene: Scene, record: Dataset) -> Floats:
    """Altitude of every ping as bottom tracking finds it."""
    # lazy: loads Numba
    from insonify.io.records.bottom_track import track_bottom

    return track_bottom(record.intensity.to_numpy(), scene.sonar.range / scene.sonar.bins)


_AT, _STRETCH = ("slant_range (m)",), ("near (m)", "far (m)")
_OVER = ("across (m)", "height (m)")
# Every name that an expression or a condition may call.
QUANTITIES: dict[str, Quantity] = {
    "altitude": Quantity((), "height of the sonar above the mean bed (m)", lambda scene: scene.altitude),
    "sound_speed": Quantity((), "sound speed that turns travel time into slant range (m/s)", _speed),
    "wavelength": Quantity((), "wavelength (m)", _wavelength),
    "absorption": Quantity(
        (), "absorption of the water one way, at the depth of the sonar (dB/km)",
        lambda scene: scene.water.absorption.decibels_per_km(
            scene.sonar.frequency, scene.seabed.depth - scene.altitude),
    ),
    "bin_length": Quantity((), "length of a bin (m)", lambda scene: scene.sonar.range / scene.sonar.bins),
    "ping_spacing": Quantity((), "distance that the towfish travels between two pings (m)", _ping_spacing),
    "fastest_ping_rate": Quantity(
        (), "ping rate at which a ping waits for the last echo of the one before (1/s)",
        lambda scene: 0.5 * _speed(scene) / scene.sonar.range,
    ),
    "first_return": Quantity(
        (), "slant range of the first echo of a level bed (m)", lambda scene: scene.altitude, _edge_of_echoes
    ),
    "slant_range": Quantity(_OVER, "slant range of a point at a height above the bed (m)", _slant_range),
    "ground_range": Quantity(_AT, "distance across the track of the bed at a slant range (m)", _ground_range),
    "swath": Quantity((), "width of level bed that both sides record (m)",
                      lambda scene: 2.0 * _ground_range(scene, scene.sonar.range)),
    "shadow_end": Quantity(_OVER, "slant range at which the shadow of a point ends (m)", _shadow_end,
                           lambda scene, record, *_: _dark_stretch(scene, record)[1]),
    "shadow_length": Quantity(_OVER, "length of the shadow of a point along the slant range (m)",
                              lambda *point: _shadow_end(*point) - _slant_range(*point),
                              lambda scene, record, *_: float(np.diff(_dark_stretch(scene, record))[0])),
    "round_height": Quantity(("across (m)", "radius (m)"), "height that its shadow gives of a round body (m)",
                             _round_height),
    "beam_width": Quantity((), "one-way width of the beam, of an array to −3 dB far away (°)", _beam_width),
    "recorded_width": Quantity(
        (), "width of the beam to −3 dB as a record has it, two-way where the beam sends and receives (°)",
        _recorded_width,
    ),
    "near_field": Quantity((), "slant range L²/λ within which an array is in its near field (m)",
                           lambda scene: getattr(scene.sonar.beam, "length", 0.0) ** 2 / _wavelength(scene)),
    "along_resolution": Quantity(_AT, "width of the recorded beam along the track (m)", _along_resolution),
    "across_resolution": Quantity((), "slant range between two echoes that the pulse resolves (m)",
                                  lambda scene: scene.sonar.pulse.cell(_speed(scene))),
    "pings_on": Quantity(("length (m)", *_AT), "pings that reach a target of a length along the track",
                         lambda scene, length, at: (length + _along_resolution(scene, at)) / _ping_spacing(scene)),
    "wave_height": Quantity((), "rms height of the waves of the sea surface (m)",
                            lambda scene: scene.water.surface.rms_height),
    "tracked_altitude": Quantity(
        (), "median altitude by bottom tracking, in the sound speed that the recorder counts with (m)",
        lambda scene: scene.altitude * _speed(scene) / _sonar_speed(scene),
        lambda *read: float(np.median(_track(*read))),
    ),
    "track_error": Quantity(
        (), "greatest difference between tracked and true altitude, of nineteen of twenty pings (m)",
        measure=lambda scene, record: float(
            np.quantile(np.abs(_track(scene, record) - record.platform_altitude.to_numpy()), 0.95)
        ),
    ),
    "bed_level": Quantity(_AT, "echo of a level bed at a slant range, by the sonar equation (dB)", _bed_level),
    "noise_level": Quantity(_AT, "noise and reverberation at a slant range (dB)", _noise_level),
    "target_level": Quantity(("target strength (dB)", *_AT), "echo of a target at a slant range (dB)", _target_level),
    "bed_reach": Quantity((), "slant range up to which the bed exceeds noise and reverberation (m)",
                          lambda scene: _sonar_equation(scene)[1].farthest(_sonar_equation(scene)[1].bed)),
    "backscatter": Quantity(("grazing (°)",), "strength of the bed's first material (dB)", _backscatter),
    "looks_spread": Quantity(("looks",), "standard deviation of the level of the mean of looks (dB)", _looks_spread),
    "sea_speed": Quantity(("temperature (°C)", "salinity (g/kg)", "depth (m)"),
                          "sound speed of sea water by TEOS-10 (m/s)", _sea_speed),
    "sea_temperature": Quantity(("sound speed (m/s)", "salinity (g/kg)"),
                                "temperature at which water has a sound speed at the surface (°C)", _sea_temperature),
    "single_step": Quantity(("number",), "step between numbers in single precision, there",
                            lambda _, number: float(np.spacing(np.float32(number)))),
    "power": Quantity(("base", "exponent"), "power", lambda _, base, exponent: base**exponent),
    "radians": Quantity(("angle (°)",), "angle (rad)", lambda _, angle: math.radians(angle)),
    "arcsin": Quantity(("sine",), "angle (°)", lambda _, sine: math.degrees(math.asin(sine))),
    "sin": Quantity(("angle (°)",), "sine", lambda _, angle: math.sin(math.radians(angle))),
    "cos": Quantity(("angle (°)",), "cosine", lambda _, angle: math.cos(math.radians(angle))),
    "tan": Quantity(("angle (°)",), "tangent", lambda _, angle: math.tan(math.radians(angle))),
    "arccos": Quantity(("cosine",), "angle (°)", lambda _, cosine: math.degrees(math.acos(cosine))),
    "sqrt": Quantity(("number",), "square root", lambda _, number: math.sqrt(number)),
    "log10": Quantity(("number",), "logarithm to base 10", lambda _, number: math.log10(number)),
    "last_return": Quantity((), "slant range of the last echo (m)",
                            measure=lambda scene, record: _edge_of_echoes(scene, record, -1)),
    "echo_range": Quantity(_STRETCH, "slant range of the strongest echo between two slant ranges (m)",
                           measure=_echo_range),
    "level": Quantity(_STRETCH, "mean intensity between two slant ranges (dB)",
                      measure=_between(lambda within: 10.0 * math.log10(float(within.mean())))),
    "contrast": Quantity(_STRETCH, "relative spread of the intensity between two slant ranges about its fall",
                         measure=_between(_contrast)),
    "dark_share": Quantity(_STRETCH, "share of bins between two slant ranges that are dark",
                           measure=_between(lambda within: float((within < DARK * within.max()).mean()))),
    "along_contrast": Quantity(_STRETCH, "relative spread of the intensity along the track between two slant ranges",
                               measure=_between(_along_contrast)),
    "along_period": Quantity(_STRETCH, "pings from band to band along the track between two slant ranges",
                             measure=_between(_along_period)),
    "loud_pings": Quantity(_STRETCH, "pings with a strong echo between two slant ranges, on the louder side",
                           measure=_between(lambda within: float(np.count_nonzero(_loud(within))))),
    "loudest_ping": Quantity(_STRETCH, "number of the ping with the strongest echo between two slant ranges",
                             measure=_between(lambda within: float(within.max(axis=(0, 2)).argmax()))),
    "slant": Quantity(_STRETCH, "share by which slanted waves of one side exceed those of the other, 0 to 1",
                      measure=_between(_slant)),
    "echoes": Quantity(_STRETCH, "strong echoes apart along the track between two slant ranges, on the louder side",
                       measure=_between(_echoes)),
}  # fmt: skip
