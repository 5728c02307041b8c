"""Quantities that questions of lessons ask for: closed forms of a scene, or measured in a simulated record."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from insonify.arrays import Dataset, Floats
from insonify.scene import Scene
from insonify.scene.sonar.beams.line_array import LineArray

CHANNEL_SIDES = ("port", "starboard")
# −3 dB width of a line array, one-way, in wavelengths over its length (docs/theory/beam.md).
THREE_DECIBELS = {"uniform": 0.886, "cosine": 1.189, "hamming": 1.304, "taylor": 1.125}
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


def _wavelength(scene: Scene) -> float:
    return _speed(scene) / scene.sonar.frequency


def _slant_range(scene: Scene, across: float, height: float) -> float:
    return math.hypot(across, scene.altitude - height)


def _ground_range(scene: Scene, slant_range: float) -> float:
    return math.sqrt(slant_range**2 - scene.altitude**2)


def _shadow_end(scene: Scene, across: float, height: float) -> float:
    """Slant range at which the ray over a point meets the bed: A / (A − h) times that of the point."""
    return _slant_range(scene, across, height) * scene.altitude / (scene.altitude - height)


def _beam_width(scene: Scene) -> float:
    """One-way full width in degrees; of an array to −3 dB in the far field, docs/theory/beam.md."""
    beam = scene.sonar.beam
    if isinstance(beam, LineArray):
        return math.degrees(THREE_DECIBELS[beam.taper] * _wavelength(scene) / beam.length)
    return float(getattr(beam, "width", 0.0))


def _near_field(scene: Scene) -> float:
    beam = scene.sonar.beam
    return beam.length**2 / _wavelength(scene) if isinstance(beam, LineArray) else 0.0


def _along_resolution(scene: Scene, slant_range: float) -> float:
    beam = scene.sonar.beam
    length = beam.length if isinstance(beam, LineArray) else 0.0
    return max(length, slant_range * math.radians(_beam_width(scene)))


def _ping_spacing(scene: Scene) -> float:
    return scene.track.speed / scene.sonar.ping_rate


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


def _echoes(within: Floats) -> float:
    """Count the stretches of the track in which the strongest bin exceeds a quarter of its greatest intensity."""
    strongest = max(within, key=np.max).max(axis=1)
    loud = strongest > 0.25 * strongest.max()
    return float(np.count_nonzero(np.diff(loud, prepend=False) & loud))


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
    "beam_width": Quantity((), "one-way width of the beam, of an array to −3 dB far away (°)", _beam_width),
    "near_field": Quantity((), "slant range L²/λ within which an array is in its near field (m)", _near_field),
    "along_resolution": Quantity(_AT, "width of the beam along the track (m)", _along_resolution),
    "across_resolution": Quantity((), "slant range between two echoes that the pulse resolves (m)",
                                  lambda scene: scene.sonar.pulse.cell(_speed(scene))),
    "pings_on": Quantity(("length (m)", *_AT), "pings that reach a target of a length along the track",
                         lambda scene, length, at: (length + _along_resolution(scene, at)) / _ping_spacing(scene)),
    "sin": Quantity(("angle (°)",), "sine", lambda _, angle: math.sin(math.radians(angle))),
    "cos": Quantity(("angle (°)",), "cosine", lambda _, angle: math.cos(math.radians(angle))),
    "tan": Quantity(("angle (°)",), "tangent", lambda _, angle: math.tan(math.radians(angle))),
    "arccos": Quantity(("cosine",), "angle (°)", lambda _, cosine: math.degrees(math.acos(cosine))),
    "sqrt": Quantity(("number",), "square root", lambda _, number: math.sqrt(number)),
    "log10": Quantity(("number",), "logarithm to base 10", lambda _, number: math.log10(number)),
    "last_return": Quantity((), "slant range of the last echo (m)",
                            measure=lambda scene, record: _edge_of_echoes(scene, record, -1)),
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
    "echoes": Quantity(_STRETCH, "strong echoes apart along the track between two slant ranges, on the louder side",
                       measure=_between(_echoes)),
}  # fmt: skip
