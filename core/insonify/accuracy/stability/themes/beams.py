"""Failures of beams and of paths by the sea surface: too few planes and pings, a cone taken for a wedge, two legs."""

import math
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, Measured, Quantity, StabilityTheme
from insonify.accuracy.stability.drawing import RIGHT, WRONG, add_legend, common, inked, ours, panel
from insonify.accuracy.stability.level_scenes import (
    arrays_over,
    ball_at,
    level_arrays,
    make_level_scene,
    make_pose,
    sweep_port,
)
from insonify.acoustics.flat_bed import along_track_width
from insonify.acoustics.resolution_cell import bin_centres
from insonify.acoustics.sea_surface import make_surface_multipath
from insonify.arrays import Floats
from insonify.display.style import FAINT
from insonify.kernels.beam.pattern import ring_responses
from insonify.kernels.common.types import LIGHT, NO_DECAY, SceneArrays, still_water
from insonify.planning import plan
from insonify.scene import Scene, edit, load_scene
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify.scene.sonar.beams import FanBeam
from insonify.scene.targets.bodies import Sphere
from insonify.scene.water.surfaces import WAYS, FlatSurface, RoughSurface
from insonify.simulation import prepare, simulate

BEAMS = StabilityTheme("Beams", 8)
FARTHEST = 3  # index of the farthest ball of the scene
LAX = 1.0  # tolerance at which planes may lie farther apart than a ball is wide
ALIKE = {"target_planes": "0"}  # no planes for targets alone


def _worst_error(values: Floats, exact: Floats | float) -> float:
    """Greatest deviation from exact values, in per cent."""
    return float(100.0 * np.abs(values / exact - 1.0).max())


@BEAMS.case(
    "Too few planes across a fan",
    "A target narrower than the distance between two planes returns an echo only where a plane meets it.",
    Quantity("variation of a small sphere's echo within the beam", "%"),
    failing=Approach("Uses as few planes as a tolerance of 1 allows, alike whatever lies in the beam.", 100.0),
    right=Approach("Lays planes across the sphere as close as its size requires, others by the plan.", 30.0),
    scene="breaks-comb",
)
def _few_planes() -> Measured:
    scene = load_scene("breaks-comb")
    ball, beam, sonar = scene.targets[FARTHEST], scene.sonar.beam, scene.sonar
    assert isinstance(ball, Sphere)
    assert isinstance(beam, FanBeam)
    x, y = ball.position[:2]
    near = math.hypot(y, scene.altitude - ball.radius) - ball.radius
    echo = slice(*(int(r * sonar.bins / sonar.range) for r in (near - ball.radius, near + 2.0 * ball.radius)))
    pings, alone = np.arange(scene.track.pings), edit(scene, {"targets": [ball]})
    bed = prepare(edit(scene, {"targets": []})).intensity(pings[:1])[0, 0, echo].sum()
    coarse, planned = simulations = [prepare(alone, tolerance=LAX, forced=ALIKE), prepare(alone)]
    few, many = (one.intensity(pings)[:, 0, echo].sum(axis=1) / bed - 1.0 for one in simulations)
    along, width = coarse.poses(pings).x - x, near * math.radians(beam.width)
    inside = np.abs(along) < 0.35 * width
    dots: dict[str, Any] = {"style": ".-", "linewidth": 1.0, "markersize": 3}
    return Measured.by(lambda one: 100.0 * np.ptp(one[inside]) / many[inside].mean(), few, many, panel(
        common(along, few, f"{coarse.plan.planes} planes", **dots),
        ours(along, many, f"the plan's {planned.plan.planes} planes", **dots),
        x="distance along the track from the sphere (m)", y="echo of the sphere over that of the bed",
        xlim=(-width, width),
    ))  # fmt: skip


FAR_BINS = 200


def _contrast(scene: Scene) -> Floats:
    """Far bins of the port record over their mean, less 1, pings by bins."""
    record = simulate(scene).intensity.values[0, :, -FAR_BINS:].astype(np.float64)
    return np.asarray(record / record.mean(axis=0) - 1.0)


@BEAMS.case(
    "Pings that beat with ripples",
    "A knife-edge beam samples one line per ping; ripples about as long as the distance between lines alias to "
    "bands many times as long.",
    Quantity("contrast along the track of bands longer than four ripples", "%"),
    failing=Approach("Samples lines one ripple length apart.", 50.0),
    right=Approach("Uses a fan wider than the distance between two pings.", 20.0),
    scene="breaks-beats",
)
def _beats() -> Measured:
    scene, width, slowly = load_scene("breaks-beats"), 3.0, 0.1
    relief, apart = scene.seabed.relief, scene.track.speed / scene.sonar.ping_rate
    assert isinstance(relief, Fractal)
    fan = {"sonar.beam": {"kind": "fan", "width": width}}
    records = [_contrast(edit(scene, change)) for change in ({}, fan, {"track.speed": slowly * scene.track.speed})]

    def contrast(record: Floats) -> float:
        """Contrast of all wavelengths beyond four ripples, in per cent."""
        waves = np.fft.rfft(record, axis=0)
        long = np.abs(np.fft.rfftfreq(record.shape[0], apart)) < 0.25 / (relief.period / relief.peaks[0][0])
        return float(100.0 * np.fft.irfft(waves * long[:, None], record.shape[0], axis=0).std())

    def draw(figure: Figure) -> None:
        first = 1.0 - FAR_BINS / scene.sonar.bins
        titles = f"knife, pings {apart:g} m apart", f"fan of {width:g}°", f"knife, {slowly * apart:g} m apart"
        steps, colours = (apart, apart, slowly * apart), (WRONG, RIGHT, RIGHT)
        for place, (record, title, colour, step) in enumerate(zip(records, titles, colours, steps), 131):
            y = "slant range (m)" if place == 131 else " "
            axes = panel(x="along the track (m)", y=y, place=place)(figure)
            shown = record[: round(18.0 / step)].T
            frame = (0.0, shown.shape[1] * step, first * scene.sonar.range, scene.sonar.range)
            axes.imshow(shown, cmap="gray", vmin=-1.0, vmax=1.0, extent=frame, origin="lower", aspect="auto")
            axes.set_title(title, fontsize=9.5, color=colour, loc="left")
            axes.grid(False)

    return Measured.by(contrast, records[0], records[1], draw)


@BEAMS.case(
    "Pings too far apart",
    "The sonar moves by more than its beam width between two pings.",
    Quantity("targets missed without a message", "of 5"),
    failing=Approach("Simulates the scene without a check.", 3.0),
    right=Approach("States in the plan up to which range a narrow target can be missed.", 0.0),
)
def _sparse() -> Measured:
    balls = [{"kind": "sphere", "position": [1.0 + 2.0 * k, 15.0], "radius": 0.1} for k in range(5)]
    fan = {"sonar.beam": {"kind": "fan", "width": 0.5}, "sonar.ping_rate": 1.0, "track.pings": 6}
    scene = make_level_scene({"targets": balls, **fan})
    whole = simulate(scene).intensity.values
    without = [edit(scene, {"targets": [one for one in scene.targets if one != ball]}) for ball in scene.targets]
    missed = float(sum(np.array_equal(whole, simulate(one).intensity.values) for one in without))
    reason = next((entry.reason for entry in plan(scene).entries if "can be missed" in entry.reason), "")

    def draw(figure: Figure) -> None:
        half, apart = math.radians(0.25), scene.track.speed / scene.sonar.ping_rate
        x, y = np.array([target.position[:2] for target in scene.targets]).T
        axes = panel(
            common(x, y, "targets that no beam meets", "o", markersize=5),
            x="along the track (m)", y="across (m)", legend="",
        )(figure)  # fmt: skip
        for place in np.arange(scene.track.pings) * apart:
            corners = [place, place - 25.0 * half, place + 25.0 * half], [0.0, 25.0, 25.0]
            axes.fill(*corners, color=FAINT, alpha=0.35, linewidth=0)
        axes.fill([], [], color=FAINT, alpha=0.35, label="beams of the pings")
        axes.set_title("\n".join(wrap(f"the plan: {reason}", 110)), fontsize=8.5, color=RIGHT, loc="left")
        axes.set_ylim(-9.0, 26.0)
        add_legend(axes, "lower right")

    return Measured(missed, 0.0 if reason else missed, draw)


@BEAMS.case(
    "A cone taken for a wedge",
    "A beam is a cone about the track: at slant range r it covers r θ of the bed, not x θ.",
    Quantity("error of the along-track width", "%"),
    failing=Approach("Takes ground range times the beam's angle.", 30.0),
    right=Approach("Takes all azimuths with cos θ · |sin φ| within the beam.", 0.01),
)
def _wedge() -> Measured:
    arrays = level_arrays({"sonar.beam": {"kind": "fan", "width": 2.5}})
    r = np.array([10.2, 10.5, 11.0, 12.0, 14.0, 18.0, 25.0, 40.0])
    x = np.sqrt(r**2 - 100.0)
    azimuth = (np.arange(2_000_000) + 0.5) / 2_000_000 * 0.5 * math.pi
    inside = [np.mean(xk / rk * np.sin(azimuth) <= math.sin(arrays.half_width)) for xk, rk in zip(x, r)]
    wedge, cone, counted = x * 2.0 * arrays.half_width, along_track_width(arrays, x, r), math.pi * x * np.array(inside)
    return Measured.by(lambda width: _worst_error(width, counted), wedge, cone, panel(
        common(r, wedge, "wedge between two planes, x θ"),
        ours(r, cone, "cone about the track, near r θ"),
        inked(r, counted, "counted azimuth by azimuth", "o", markersize=3),
        x="slant range, 10 m above the bed (m)", y="bed within the beam (m)",
    ))  # fmt: skip


ALTITUDE, SQUINT = 10.0, 15.0  # m above the bed, °


@BEAMS.case(
    "Light through a beam that squints",
    "Law light averages over azimuths; in a squinting beam, equal steps of the sine are unequal steps of azimuth.",
    Quantity(f"error of the light of a level bed, squint of {SQUINT:g}°", "%"),
    failing=Approach("Divides by the integral of the response over sines.", 5.0),
    right=Approach("Divides by its integral over azimuths.", 1.0),
)
def _light() -> Measured:
    beam = {"kind": "gaussian", "width": 3.0, "squint": SQUINT}
    arrays = level_arrays({"sonar.beam": beam, "sonar.law": "light"})
    r = bin_centres(arrays)
    shown = r > 1.1 * ALTITUDE
    r = r[shown]
    # Light of a level bed is H/r.
    own = sweep_port(arrays, make_pose(0.0, 0.0, ALTITUDE), planes=64)[shown] * r / ALTITUDE
    level = np.sqrt(1.0 - (ALTITUDE / r[:, None]) ** 2)
    azimuth = math.pi * ((np.arange(4001) + 0.5) / 4001 - 0.5)
    off = (level * np.sin(azimuth) - math.sin(math.radians(SQUINT))) / math.sin(math.radians(1.5))
    response = 0.25 ** (off * off)
    # The beam's azimuths over the integral of its response over sines, ds / level.
    plain = response.sum(axis=1) / (response * np.cos(azimuth)).sum(axis=1)
    return Measured.by(lambda light: _worst_error(light, 1.0), plain, own, panel(
        common(r, plain, "average over sines"),
        ours(r, own, "average over azimuths"),
        inked(None, 1.0, linewidth=0.6),
        x="slant range, 10 m above the bed (m)", y="light of a level bed, over H/r",
    ))  # fmt: skip


LENGTH = 1.0  # m, of an array


@BEAMS.case(
    "The near field of a line array",
    "Nearer than the square of its length over the wavelength, the beam of an array is as wide as the array itself.",
    Quantity(f"error of the width of the beam of an array of {LENGTH:g} m, from 10 m to 90 m", "%"),
    failing=Approach("Takes the pattern of the far field.", 50.0),
    right=Approach("Tabulates the pattern range by range, by Fresnel's approximation.", 2.0),
)
def _near_field() -> Measured:
    beam = {"kind": "array", "length": LENGTH}
    scene = make_level_scene({"sonar.beam": beam, "sonar.range": 100.0, "sonar.ping_rate": 5.0})
    arrays = prepare(scene).arrays
    r, wavelength = np.geomspace(10.0, 90.0, 12), arrays.water.reference / scene.sonar.frequency
    own = np.zeros(r.size)
    ring_responses(arrays.pattern, np.sqrt(r**2 - 1.0), r, own)
    sine = np.linspace(-0.3, 0.3, 24_001)
    place, step = ((np.arange(256) + 0.5) / 256 - 0.5) * LENGTH, sine[1] - sine[0]
    far, near = np.full(r.size, (np.sinc(LENGTH / wavelength * sine) ** 4).sum() * step), []
    for one in r:  # element by element
        way = np.hypot(one * sine[:, None] - place, one * np.sqrt(1.0 - sine[:, None] ** 2)) - one
        near.append(np.abs(np.exp(2j * np.pi / wavelength * way).mean(axis=1)) ** 4)
    exact = np.array(near).sum(axis=1) * step
    return Measured.by(lambda width: _worst_error(width, exact), far, own, panel(
        common(r, np.degrees(far), "pattern of the far field", markersize=3),
        ours(r, np.degrees(own), "pattern for each range", markersize=3),
        inked(r, np.degrees(exact), "element by element", "o", markersize=3),
        x="slant range (m)", y="width of the beam, two ways (°)", title=f"array of {LENGTH:g} m", log="y",
    ))  # fmt: skip


SEA_SURFACE = StabilityTheme("Paths by the sea surface", 13)
DEPTH = 20.0  # m, of the sonar beneath the sea surface
RAISED = 2.0 * DEPTH  # m, of the sonar's image in the surface above the sonar


def _surface_echo(arrays: SceneArrays, wind_speed: float = 0.0) -> Floats:
    """Echo of one side out by the surface and back straight, (bins,), without the record's spreading."""
    switches = {way: way == "surface_bottom" for way in WAYS}
    sea = RoughSurface(**switches, wind_speed=wind_speed) if wind_speed > 0.0 else FlatSurface(**switches)
    bare = arrays._replace(range_factor=np.ones(arrays.bins), range_decay=NO_DECAY)
    under = bare._replace(water=still_water(surface=ALTITUDE + DEPTH), multipath=make_surface_multipath(sea))
    pose = make_pose(0.0, 0.0, ALTITUDE)
    return sweep_port(under, pose, planes=1) - sweep_port(bare, pose, planes=1)


def _pair_range(x: Floats | float) -> Floats:
    """Slant range of a level bed's echo out by the surface and back straight."""
    return 0.5 * np.asarray(np.hypot(x, ALTITUDE) + np.hypot(x, ALTITUDE + RAISED))


END, LAST, WIND = 40.0, 0.5, 8.0  # m, end of a record, and how much of it counts; m/s


@SEA_SURFACE.case(
    "Waves at a record's end",
    "A wave trough shortens the path of an echo that would arrive after the end of the record over a calm sea.",
    Quantity(f"echo missing from the last {LAST:g} m of the record", "%"),
    failing=Approach("Follows the bed up to the end of the record over a calm sea.", 5.0),
    right=Approach("Follows it up to the last echo that the lowest facet of the sea returns in time.", 0.1),
)
def _waves() -> Measured:
    def over(heights: Floats, end: float) -> SceneArrays:
        changes = {"sonar.range": end, "sonar.bins": round(20.0 * end)}
        return arrays_over(heights, 0.1, x0=-0.2, y0=0.0, changes=changes)

    level = np.zeros((1201, 4))
    seen = np.where(_pair_range(0.1 * np.arange(1201, dtype=np.float64)) <= END, 0.0, np.nan)
    calm, short, long = over(np.tile(seen[:, None], 4), END), over(level, END), over(level, END + 20.0)
    plain, own, exact = (_surface_echo(arrays, WIND)[: short.bins] for arrays in (calm, short, long))
    r, lit = bin_centres(short), exact > 0.0
    last = r > END - LAST
    return Measured.by(lambda one: 100.0 * abs(one[last].sum() / exact[last].sum() - 1.0), plain, own, panel(
        common(r[lit], plain[lit] / exact[lit], "bed up to the end over a calm sea"),
        ours(r[lit], own[lit] / exact[lit], "bed as far as waves bring it in"),
        x="slant range (m)", y="echo by the surface over that of a longer record", xlim=(END - 5.0, END),
        ylim=(0.0, 1.2), legend="lower left",
    ))  # fmt: skip


PAIR_WIDTH, PAIR_SQUINT = 4.0, 10.0  # °


@SEA_SURFACE.case(
    "Two legs of a squinting beam",
    "On a path out by the surface and straight back, a squinting beam covers different azimuths on its two legs.",
    Quantity("error of the energy", "%"),
    failing=Approach("Takes the root of the product of the azimuths of each leg alone.", 100.0),
    right=Approach("Integrates the root of both responses over their common azimuths.", 0.05),
)
def _squint() -> Measured:
    beam = {"kind": "gaussian", "width": PAIR_WIDTH, "squint": PAIR_SQUINT, "two_way": True}
    arrays = level_arrays({"sonar.beam": beam, "sonar.range": 60.0, "sonar.bins": 600})
    edges = np.linspace(0.0, 70.0, 7001)
    x = 0.5 * (edges[1:] + edges[:-1])
    near, far = np.hypot(x, ALTITUDE), np.hypot(x, ALTITUDE + RAISED)
    azimuth = math.pi * ((np.arange(2001) + 0.5) / 2001 - 0.5)
    half, extent = math.sin(math.radians(0.5 * PAIR_WIDTH)), arrays.pattern.extent[0]
    off = [(x / leg)[:, None] * np.sin(azimuth) - math.sin(math.radians(PAIR_SQUINT)) for leg in (near, far)]
    beams = [2.0 ** (-2.0 * (sine / half) ** 2) * (np.abs(sine) < extent) for sine in off]
    common_azimuths = math.pi * np.sqrt(beams[0] * beams[1]).mean(axis=1)
    apart = math.pi * np.sqrt(beams[0].mean(axis=1) * beams[1].mean(axis=1))
    density = 2.0 * ALTITUDE * (ALTITUDE + RAISED) / math.pi * x * _pair_range(x) ** 4 / (near * far) ** 3
    borders = arrays.bin_length * np.arange(arrays.bins + 1)
    plain, exact = (
        np.diff(np.interp(borders, _pair_range(edges), np.concatenate([[0.0], np.cumsum(density * taken * 0.01)])))
        for taken in (apart, common_azimuths)
    )
    own, r = _surface_echo(arrays), bin_centres(arrays)
    shown = r > _pair_range(0.0)
    return Measured.by(lambda one: 100.0 * abs(one.sum() / exact.sum() - 1.0), plain, own, panel(
        common(r[shown], plain[shown], "azimuths of each leg alone"),
        ours(r[shown], own[shown], "one plane of this program"),
        inked(r[shown], exact[shown], "azimuths that both legs have", ":"),
        x="slant range (m)", y="echo by the surface", log="y", ylim=(exact.max() * 1e-4, plain.max() * 2.0),
    ))  # fmt: skip


CENTRE, RADIUS = (12.0, -9.0), 0.6  # m, of a ball: ground range, height above the sonar
FACETS, FINE_FACETS = 24, 100_000


def _radiances(facets: int) -> tuple[Floats, Floats, float]:
    """Slant ranges at the ends of facets of a ball, Lambert's radiance for both images in their middles, and its sum.

    Facets are denser towards the edges; the radiance is 0 where the facet is hidden from the higher image.
    """
    x, z = CENTRE
    distance, middle = math.hypot(x, z), math.atan2(z, x)
    edge = math.asin(RADIUS / distance)
    borders = -edge * np.cos(np.pi * np.arange(facets + 1) / facets)
    off = 0.5 * (borders[1:] + borders[:-1])

    def legs(angle: Floats) -> tuple[Floats, Floats, Floats]:
        root = np.sqrt(np.clip(RADIUS**2 - (distance * np.sin(angle)) ** 2, 0.0, None))
        near = distance * np.cos(angle) - root
        px, pz = near * np.cos(middle + angle), near * np.sin(middle + angle)
        far = np.hypot(px, pz - RAISED)
        facing = -((px - x) * px + (pz - z) * (pz - RAISED)) / (RADIUS * far)
        return 0.5 * (near + far), root / RADIUS, facing

    _, one, other = legs(off)
    ends, radiance = legs(borders)[0], np.where(other > 0.0, one + other, 0.0)
    return ends, radiance, float((radiance * np.abs(np.diff(ends))).sum())


@SEA_SURFACE.case(
    "Light at a body's edge",
    "Under law light an echo is weighted by the range that it spans, which is large at the edge of a round body.",
    Quantity("error of the energy of a ball", "%"),
    failing=Approach(
        f"Takes the radiance in the middle of each of {FACETS} facets, and the whole facet if that is visible.",
        0.5,
    ),
    right=Approach(
        "Cuts facets at the edge of what an image illuminates, and takes the mean radiance of their ends.", 0.05
    ),
)
def _light_at_an_edge() -> Measured:
    ball = ball_at(0.0, CENTRE[0], CENTRE[1] - DEPTH, RADIUS)
    changes = {"targets": [ball], "sonar.range": 60.0, "sonar.bins": 1200}
    arrays = arrays_over(np.zeros((2, 2)), 1.0, x0=-1000.0, changes=changes)  # the bed is out of reach
    arrays = arrays._replace(law=LIGHT, reflectivity=np.tile([1.0, 0.0, 1.0], (arrays.reflectivity.shape[0], 1)))
    (ends, radiance, plain), (fine_ends, fine_radiance, exact) = _radiances(FACETS), _radiances(FINE_FACETS)
    own = float(_surface_echo(arrays).sum() * arrays.bin_length)
    return Measured.by(lambda energy: 100.0 * abs(energy / exact - 1.0), plain, own, panel(
        common(_corners(ends), np.repeat(radiance, 2), f"{FACETS} facets, each as in its middle"),
        ours(_corners(fine_ends), np.repeat(fine_radiance, 2), "the ball itself"),
        x="slant range (m)", y="radiance for both images", title="a ball, surface-bottom path",
    ))  # fmt: skip


def _corners(ends: Floats) -> Floats:
    """Both ends of each facet, facet by facet."""
    return np.ravel(np.column_stack([ends[:-1], ends[1:]]))
