"""Failures of beams: too few planes, too few pings, a cone taken for a wedge."""

from __future__ import annotations

import math
from functools import lru_cache
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from insonify.accuracy.stability.case import Approach, StabilityCase, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, add_panel
from insonify.accuracy.stability.level_scenes import make_level_scene, make_pose
from insonify.acoustics.flat_bed import along_track_width
from insonify.acoustics.resolution_cell import bin_centres
from insonify.display.style import FAINT, INK
from insonify.kernels.beam.pattern import ring_responses
from insonify.planning import plan
from insonify.scene import Scene, edit, load_scene
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify.scene.sonar.beams.fan import FanBeam
from insonify.scene.targets.sphere import Sphere
from insonify.simulation import prepare, simulate
from insonify.tracers import sweep

Curve = NDArray[np.float64]
WIDE = {"sonar.beam": {"kind": "fan", "width": 2.5}}
FARTHEST = 3  # which of the balls of the scene that combs
AS_WIDE = 3.0  # °, of a fan that at far ranges is wider than the way between two pings
SLOWLY = 0.1  # of the speed
FAR_BINS = 200
SHOWN = 18.0  # m along the track
ALTITUDE, SQUINT, AWAY = 10.0, 15.0, 1.1  # m; °; altitudes beyond which light is compared
LENGTH = 1.0  # m, of an array
LAX = 1.0  # a tolerance that lets planes lie farther apart than a ball is wide


class Pass(NamedTuple):
    """A ball that passes through the beam."""

    along: Curve  # place along the track from abreast of it, m
    few: Curve  # its echo over the bed's, by few planes
    planned: Curve  # and by those planned
    counts: tuple[int, int]  # of both planes
    width: float  # of the beam there, m


@lru_cache(maxsize=1)
def _past_a_ball() -> Pass:
    scene = load_scene("breaks-comb")
    ball, beam, sonar = scene.targets[FARTHEST], scene.sonar.beam, scene.sonar
    assert isinstance(ball, Sphere)
    assert isinstance(beam, FanBeam)
    x, y = ball.position[:2]
    near = math.hypot(y, scene.altitude - ball.radius) - ball.radius
    echo = slice(*(int(r * sonar.bins / sonar.range) for r in (near - ball.radius, near + 2.0 * ball.radius)))
    pings, alone = np.arange(scene.track.pings), edit(scene, {"targets": [ball]})
    bed = prepare(edit(scene, {"targets": []})).intensity(pings[:1])[0, 0, echo].sum()
    some = [prepare(alone, tolerance=LAX), prepare(alone)]
    few, planned = (one.intensity(pings)[:, 0, echo].sum(axis=1) / bed - 1.0 for one in some)
    counts = some[0].plan.planes, some[1].plan.planes
    return Pass(some[0].poses(pings).x - x, few, planned, counts, near * math.radians(beam.width))


def _comb(echo: Curve) -> float:
    """Greatest swing of the echo within the beam, over its mean there."""
    passed = _past_a_ball()
    inside = np.abs(passed.along) < 0.35 * passed.width
    return float(100.0 * np.ptp(echo[inside]) / passed.planned[inside].mean())


def _draw_comb(figure: Figure) -> None:
    passed = _past_a_ball()
    axes = add_panel(
        figure, x="distance along the track from the sphere (m)", y="echo of the sphere over that of the bed"
    )
    for echo, colour, words in (
        (passed.few, WRONG, f"{passed.counts[0]} planes"),
        (passed.planned, RIGHT, f"the plan's {passed.counts[1]} planes"),
    ):
        axes.plot(passed.along, echo, ".-", color=colour, linewidth=1.0, markersize=3, label=words)
    axes.set_xlim(-passed.width, passed.width)
    add_legend(axes)


@lru_cache(maxsize=1)
def _towed_over_ripples() -> tuple[Curve, Curve, Curve]:
    """Far bins of a record of ripples over their mean, pings by bins: by a knife, by a fan, by a knife towed slowly."""
    scene = load_scene("breaks-beats")
    fan, slow = {"kind": "fan", "width": AS_WIDE}, SLOWLY * scene.track.speed
    changes: tuple[dict[str, Any], ...] = ({}, {"sonar.beam": fan}, {"track.speed": slow})
    return tuple(_over_mean(edit(scene, one)) for one in changes)  # type: ignore[return-value]


def _over_mean(scene: Scene) -> Curve:
    record = simulate(scene).intensity.values[0, :, -FAR_BINS:].astype(np.float64)
    return np.asarray(record / record.mean(axis=0) - 1.0)


def _beats(record: Curve) -> float:
    """Contrast along a fast tow of all wavelengths beyond four ripples."""
    scene = load_scene("breaks-beats")
    apart, waves = scene.track.speed / scene.sonar.ping_rate, np.fft.rfft(record, axis=0)
    long = np.abs(np.fft.rfftfreq(record.shape[0], apart)) < 0.25 / _ripple(scene)
    return float(100.0 * np.fft.irfft(waves * long[:, None], record.shape[0], axis=0).std())


def _ripple(scene: Scene) -> float:
    """Metres from crest to crest along the track."""
    relief = scene.seabed.relief
    assert isinstance(relief, Fractal)
    return float(relief.period / relief.peaks[0][0])


def _draw_beats(figure: Figure) -> None:
    scene = load_scene("breaks-beats")
    apart, first = scene.track.speed / scene.sonar.ping_rate, 1.0 - FAR_BINS / scene.sonar.bins
    words = f"knife, pings {apart:g} m apart", f"fan of {AS_WIDE:g}°", f"knife, {SLOWLY * apart:g} m apart"
    for place, record, title, colour, step in zip(
        (131, 132, 133), _towed_over_ripples(), words, (WRONG, RIGHT, RIGHT), (apart, apart, SLOWLY * apart)
    ):
        axes = add_panel(figure, place, x="along the track (m)", y="slant range (m)" if place == 131 else " ")
        shown = record[: round(SHOWN / step)].T
        frame = (0.0, shown.shape[1] * step, first * scene.sonar.range, scene.sonar.range)
        axes.imshow(shown, cmap="gray", vmin=-1.0, vmax=1.0, extent=frame, origin="lower", aspect="auto")
        axes.set_title(title, fontsize=9.5, color=colour, loc="left")
        axes.grid(False)


def _sparse() -> Scene:
    balls = [{"kind": "sphere", "position": [1.0 + 2.0 * k, 15.0], "radius": 0.1} for k in range(5)]
    beam = {"kind": "fan", "width": 0.5}
    return make_level_scene({"targets": balls, "sonar.beam": beam, "sonar.ping_rate": 1.0, "track.pings": 6})


@lru_cache(maxsize=1)
def _missed() -> float:
    """Count the balls without which the record is the same."""
    whole = simulate(_sparse()).intensity.values
    balls = _sparse().targets
    without = (edit(_sparse(), {"targets": [plain for plain in balls if plain != ball]}) for ball in balls)
    return float(sum(np.array_equal(whole, simulate(scene).intensity.values) for scene in without))


def _missed_unsaid() -> float:
    said = any("can be missed" in entry.reason for entry in plan(_sparse()).entries)
    return 0.0 if said else _missed()


@lru_cache(maxsize=1)
def _widths() -> tuple[Curve, Curve, Curve, Curve]:
    """Slant range, and the arc of a level bed within a beam of 2.5°: as a plane's wedge, as a cone, and by count."""
    arrays = prepare(make_level_scene(WIDE)).arrays
    r = np.array([10.2, 10.5, 11.0, 12.0, 14.0, 18.0, 25.0, 40.0])
    x = np.sqrt(r**2 - 100.0)
    azimuth = (np.arange(2_000_000) + 0.5) / 2_000_000 * 0.5 * math.pi
    inside = [np.mean(xk / rk * np.sin(azimuth) <= math.sin(arrays.half_width)) for xk, rk in zip(x, r)]
    return r, x * 2.0 * arrays.half_width, along_track_width(arrays, x, r), math.pi * x * np.array(inside)


def _width_off(widths: Curve) -> float:
    return float(100.0 * np.abs(widths / _widths()[3] - 1.0).max())


def _draw_widths(figure: Figure) -> None:
    r, wedge, cone, counted = _widths()
    axes = add_panel(figure, x="slant range, 10 m above the bed (m)", y="bed within the beam (m)")
    axes.plot(r, wedge, color=WRONG, label="wedge between two planes, x θ")
    axes.plot(r, cone, color=RIGHT, label="cone about the track, near r θ")
    axes.plot(r, counted, "o", color=INK, markersize=3, label="counted azimuth by azimuth")
    add_legend(axes)


def _draw_sparse(figure: Figure) -> None:
    scene = _sparse()
    half, apart = math.radians(0.25), scene.track.speed / scene.sonar.ping_rate
    axes = add_panel(figure, x="along the track (m)", y="across (m)")
    for ping in range(scene.track.pings):
        x = ping * apart
        axes.fill([x, x - 25.0 * half, x + 25.0 * half], [0.0, 25.0, 25.0], color=FAINT, alpha=0.35, linewidth=0)
    places = np.array([target.position[:2] for target in scene.targets])
    axes.plot(places[:, 0], places[:, 1], "o", color=WRONG, markersize=5, label="targets that no beam meets")
    axes.fill([], [], color=FAINT, alpha=0.35, label="beams of the pings")
    reason = next(entry.reason for entry in plan(scene).entries if "can be missed" in entry.reason)
    axes.set_title("\n".join(wrap(f"the plan: {reason}", 110)), fontsize=8.5, color=RIGHT, loc="left")
    axes.set_ylim(-9.0, 26.0)
    add_legend(axes, "lower right")


@lru_cache(maxsize=1)
def _lights() -> tuple[Curve, Curve, Curve]:
    """Slant range, and light of a level bed over what it is: averaged over the sines of a squinting beam, and here."""
    beam = {"kind": "gaussian", "width": 3.0, "squint": SQUINT}
    arrays = prepare(make_level_scene({"sonar.beam": beam, "sonar.law": "light"})).arrays
    r = bin_centres(arrays)
    shown = r > AWAY * ALTITUDE
    pose = make_pose(0.0, 0.0, ALTITUDE)
    own = sweep.trace(arrays, pose, planes=64)[0, 0].astype(np.float64)[shown] * r[shown] / ALTITUDE
    level = np.sqrt(1.0 - (ALTITUDE / r[shown, None]) ** 2)
    azimuth = math.pi * ((np.arange(4001) + 0.5) / 4001 - 0.5)
    off = (level * np.sin(azimuth) - math.sin(math.radians(SQUINT))) / math.sin(math.radians(1.5))
    response = 0.25 ** (off * off)
    # The beam's azimuths over the integral of its response over sines, ds / level.
    plain = response.sum(axis=1) / (response * np.cos(azimuth)).sum(axis=1)
    return r[shown], plain, own


def _light_off(light: Curve) -> float:
    return float(100.0 * np.abs(light - 1.0).max())


def _draw_lights(figure: Figure) -> None:
    r, plain, own = _lights()
    axes = add_panel(figure, x="slant range, 10 m above the bed (m)", y="light of a level bed, over H/r")
    axes.plot(r, plain, color=WRONG, label="average over sines")
    axes.plot(r, own, color=RIGHT, label="average over azimuths")
    axes.axhline(1.0, color=INK, linewidth=0.6)
    add_legend(axes)


@lru_cache(maxsize=1)
def _near_field() -> tuple[Curve, Curve, Curve, Curve]:
    """Ranges, and azimuth that a line array takes in: by its pattern far away, by its table here, by its elements."""
    far_away = {"sonar.range": 100.0, "sonar.ping_rate": 5.0}
    scene = make_level_scene({"sonar.beam": {"kind": "array", "length": LENGTH}, **far_away})
    arrays = prepare(scene).arrays
    r, wavelength = np.geomspace(10.0, 90.0, 12), arrays.water.reference / scene.sonar.frequency
    own = np.zeros(r.size)
    ring_responses(arrays.pattern, np.sqrt(r**2 - 1.0), r, own)
    sine = np.linspace(-0.3, 0.3, 24_001)
    place = ((np.arange(256) + 0.5) / 256 - 0.5) * LENGTH
    far = np.sinc(LENGTH / wavelength * sine) ** 4
    near = []
    for one in r:
        way = np.hypot(one * sine[:, None] - place, one * np.sqrt(1.0 - sine[:, None] ** 2)) - one
        near.append(np.abs(np.exp(2j * np.pi / wavelength * way).mean(axis=1)) ** 4)
    step = sine[1] - sine[0]
    return r, np.full(r.size, far.sum() * step), own, np.array(near).sum(axis=1) * step


def _width_of_array_off(width: Curve) -> float:
    return float(100.0 * np.abs(width / _near_field()[3] - 1.0).max())


def _draw_near_field(figure: Figure) -> None:
    r, far, own, right = _near_field()
    axes = add_panel(figure, x="slant range (m)", y="width of the beam, two ways (°)", title=f"array of {LENGTH:g} m")
    for width, look, colour, words in (
        (far, "-", WRONG, "pattern of the far field"),
        (own, "-", RIGHT, "pattern for each range"),
        (right, "o", INK, "element by element"),
    ):
        axes.plot(r, np.degrees(width), look, color=colour, markersize=3, label=words)
    axes.set_yscale("log")
    add_legend(axes)


THEME = StabilityTheme("Beams", 8, (
    StabilityCase(
        "Too few planes across a fan",
        "A target narrower than the distance between two planes returns an echo only where a plane meets it.",
        "variation of a small sphere's echo within the beam", "%",
        Approach("Uses as few planes as a tolerance of 1 allows.",
                 lambda: _comb(_past_a_ball().few), 100.0),
        Approach("Lets the plan choose by the size of the sphere and the beam width there.",
            lambda: _comb(_past_a_ball().planned), 30.0),
        _draw_comb,
        "breaks-comb",
    ),
    StabilityCase(
        "Pings that beat with ripples",
        "A knife-edge beam samples one line per ping; ripples about as long as the distance between lines alias to "
        "bands many times as long.",
        "contrast along the track of bands longer than four ripples", "%",
        Approach("Samples lines one ripple length apart.",
                 lambda: _beats(_towed_over_ripples()[0]), 50.0),
        Approach("Uses a fan wider than the distance between two pings.",
            lambda: _beats(_towed_over_ripples()[1]), 20.0),
        _draw_beats,
        "breaks-beats",
    ),
    StabilityCase(
        "Pings too far apart",
        "The sonar moves by more than its beam width between two pings.",
        "targets missed without a message", "of 5",
        Approach("Simulates the scene without a check.", _missed, 3.0),
        Approach("States in the plan up to which range a narrow target can be missed.", _missed_unsaid, 0.0),
        _draw_sparse,
    ),
    StabilityCase(
        "A cone taken for a wedge",
        "A beam is a cone about the track: at slant range r it covers r θ of the bed, not x θ.",
        "error of the along-track width", "%",
        Approach("Takes ground range times the beam's angle.", lambda: _width_off(_widths()[1]), 30.0),
        Approach("Takes all azimuths with cos θ · |sin φ| within the beam.", lambda: _width_off(_widths()[2]), 0.01),
        _draw_widths,
    ),
    StabilityCase(
        "Light through a beam that squints",
        "Law light averages over the beam, and off athwart equal steps of the sine are unequal steps of azimuth.",
        f"error of the light of a level bed, squint of {SQUINT:g}°", "%",
        Approach("Divides by the integral of the response over sines.", lambda: _light_off(_lights()[1]), 5.0),
        Approach("Divides by its integral over azimuths.", lambda: _light_off(_lights()[2]), 1.0),
        _draw_lights,
    ),
    StabilityCase(
        "The near field of a line array",
        "Nearer than the square of its length over the wavelength, an array hears a stretch as wide as itself.",
        f"error of the width of the beam of an array of {LENGTH:g} m, from 10 m to 90 m", "%",
        Approach("Takes the pattern of the far field.", lambda: _width_of_array_off(_near_field()[1]), 50.0),
        Approach("Tabulates the pattern range by range, by Fresnel's approximation.",
                 lambda: _width_of_array_off(_near_field()[2]), 2.0),
        _draw_near_field,
    ),
))  # fmt: skip
