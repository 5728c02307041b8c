"""Failures of targets and beams: leaking walls, too few planes and pings, a cone taken for a wedge, two legs."""

import math

import numpy as np

from insonify.accuracy.stability.case import Measured, StabilityTheme, percent, worst
from insonify.accuracy.stability.drawing import plot, table
from insonify.accuracy.stability.level_scenes import (
    arrays_over,
    ball_at,
    error_message,
    level_arrays,
    make_level_scene,
    make_pose,
    sweep_port,
)
from insonify.acoustics.flat_bed import along_track_width
from insonify.acoustics.resolution_cell import bin_centres
from insonify.acoustics.sea_surface import make_surface_multipath
from insonify.arrays import Floats, Singles
from insonify.kernels.beam.pattern import ring_responses
from insonify.kernels.common.types import NO_DECAY, SceneArrays, still_water
from insonify.planning import plan
from insonify.scene import Scene, edit, load_scene
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify.scene.sonar.beams import FanBeam
from insonify.scene.targets.bodies import Sphere
from insonify.scene.water.surfaces import WAYS, FlatSurface, RoughSurface
from insonify.simulation import prepare, simulate
from insonify.tracers import rays

TARGETS = StabilityTheme("Targets", 7)


def _count_triangles(corners: Floats, origin: Floats, direction: Floats) -> int:
    """Count the triangles that a ray meets (Möller and Trumbore), in float32, borders included."""
    a, b, c = (corners[:, k].astype(np.float32) for k in range(3))
    way, start = direction.astype(np.float32), origin.astype(np.float32)
    p = np.cross(way, c - a)
    determinant = ((b - a) * p).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = ((start - a) * p).sum(axis=1) / determinant
        q = np.cross(start - a, b - a)
        v, t = (q @ way) / determinant, ((c - a) * q).sum(axis=1) / determinant
    return int(((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)).sum())


@TARGETS.case("Edges that two walls share",
    "Rounding places a ray through an edge on neither of its two triangles, or on both.",
    "rays that do not meet exactly one wall", "%", "Tests each triangle independently in float32.", 5.0,
    "Decides each edge once for both its triangles.", 0.0)  # fmt: skip
def _walls() -> Measured:
    rng = np.random.default_rng(3)
    turned = {"kind": "box", "position": [0.0, 0.0, -10.0], "size": [3.0, 2.0, 1.5], "heading": 31.0, "pitch": 17.0,
              "roll": 9.0}  # fmt: skip
    arrays = level_arrays({"targets": [turned], "track.start": [0.0, 30.0]})
    corners = arrays.mesh.corners
    centre = corners.mean(axis=(0, 1))
    # Rays from inside to edges and corners, each of which meets one wall.
    which, side = rng.integers(0, len(corners), 6000), rng.integers(0, 3, 6000)
    share = rng.random((6000, 1))
    ways = (1.0 - share) * corners[which, side] + share * corners[which, (side + 1) % 3] - centre
    missed = np.array([_count_triangles(corners, centre, way) for way in ways]) != 1
    distance, what, _ = rays.cast(arrays, np.tile(centre, (6000, 1)), ways)
    off = np.abs(distance / np.linalg.norm(ways, axis=1) - 1.0)
    around = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
    up = np.degrees(np.arctan2(ways[:, 2], np.hypot(ways[:, 0], ways[:, 1])))
    directions = (around[missed], up[missed]), (around[~missed], up[~missed])
    picture = plot("direction of the ray (°)", "elevation (°); leaks on top", None, *directions, style=".")
    return Measured(percent(missed), percent((what != 0) | (off > 1e-9)), picture)


AROUND, RADIUS = "around the sonar", 1.0
PLACES = {
    AROUND: (0.0, 0.3, -20.0),
    "under the bed": (0.0, 20.0, -33.0),
    "beneath the sonar": (0.0, 0.0, -28.0),
    "beyond the range": (0.0, 80.0, -29.0),
    "on the other side": (0.0, -20.0, -29.0),
}


def _shadow_interval(across: float, above: float, altitude: float) -> tuple[float, float]:
    """Slant ranges between which a ball hides the bed, H / sin(φ ± α); ``above`` is its centre's height."""
    d, phi = math.hypot(across, altitude - above), math.atan2(altitude - above, across)
    alpha = math.asin(RADIUS / d) if d >= RADIUS else math.nan
    return altitude / math.sin(phi + alpha), altitude / math.sin(phi - alpha)


def _is_right(name: str, record: Singles, bare: Singles) -> bool:
    """Whether the record of a ball at a place is right, compared with the record of the bare bed."""
    port, starboard = record
    if not (np.isfinite(port).all() and (record >= 0.0).all()):
        return False
    if name == "beneath the sonar":
        return bool(np.allclose(port, starboard, rtol=1e-4, atol=1e-6 * port.max()) and port[:200].any())
    if name == "under the bed":
        return bool(np.allclose(port, bare[0], rtol=0.02, atol=1e-4 * bare[0].max()))
    return np.array_equal(port, bare[0]) and (name != "on the other side" or not np.array_equal(starboard, bare[1]))


@TARGETS.case("Targets in unusual places",
    "A sphere around the sonar covers no interval of angles; one behind it, below the bed or out of range covers "
    "none either.",
    "places with a wrong record", "of 5", "Hides the bed from H / sin(φ + α) to H / sin(φ − α).", 2.0,
    "Traces visible targets only, and reports a sonar inside a target as one sentence.", 0.0)  # fmt: skip
def _places() -> Measured:
    plain, own, rows = 0, 0, []
    bare = simulate(make_level_scene()).intensity.values[:, 0]
    for name, (x, y, z) in PLACES.items():
        near, far = _shadow_interval(y, z + 30.0, 10.0)
        lit = y < 0.0 or z + 30.0 < -RADIUS or y > 50.0
        plain += not (0.0 < near < far) or (lit and near < 50.0)
        scene = make_level_scene({"targets": [ball_at(x, y, z, RADIUS, material="rock")]})
        if name == AROUND:
            result = error_message(lambda scene=scene: simulate(scene))  # type: ignore[misc]
            own += "the sonar runs into it" not in result
        else:
            right = _is_right(name, simulate(scene).intensity.values[:, 0], bare)
            result = "right record" if right else "wrong record"
            own += not right
        shadow = f"shadow {near:.3g} to {far:.3g} m" if math.isfinite(near + far) else "no interval"
        rows.append((f"sphere {name}", shadow, result))
    return Measured(float(plain), float(own), table(rows))


GLINT = (15.0, 0.6)  # ground range and height above the bed of a sphere's centre, m


def _echo_by_facets(exponent: float, facets: int) -> float:
    """Energy of a sphere's specular echo in a plane through its centre, one incidence per facet of launch angle."""
    distance = math.hypot(GLINT[0], 10.0 - GLINT[1])
    border = -math.asin(RADIUS / distance) * np.cos(np.pi * np.arange(facets + 1) / facets)
    off = 0.5 * (border[1:] + border[:-1])
    sine = distance * np.sin(off) / RADIUS
    cosine = np.sqrt(1.0 - sine * sine)
    slant = distance * np.cos(off) - RADIUS * cosine
    lobe = np.clip(2.0 * cosine * cosine - 1.0, 0.0, None) ** exponent
    strength = cosine * cosine * (0.2 + 0.8 * 0.5 * (exponent + 2.0) * lobe) / np.pi
    return float((strength * slant / cosine * np.diff(border)).sum())


def _alone(ball: tuple[float, float], radius: float, materials: list[float], **changes: object) -> SceneArrays:
    """Arrays of a sphere, at a ground range and a depth, of one reflectivity; the bed is out of reach."""
    target = {"targets": [ball_at(0.0, *ball, radius)]}
    arrays = arrays_over(np.zeros((2, 2)), 1.0, target | changes, x0=-1000.0)
    return arrays._replace(reflectivity=np.tile(materials, (arrays.reflectivity.shape[0], 1)))


def _echo_by_sweep(exponent: float) -> float:
    """Energy of the same echo by the sweep."""
    arrays = _alone((GLINT[0], GLINT[1] - 30.0), RADIUS, [0.2, 0.8, exponent])
    bare = arrays._replace(range_factor=np.ones(arrays.bins), range_decay=NO_DECAY)
    return float(sweep_port(bare, make_pose(0.0, 0.0, 10.0)).sum())


@TARGETS.case("A lobe narrower than a facet",
    "Along a facet of a round target the incidence changes by more than the width of a narrow specular lobe.",
    "error of the energy, exponents from 10 to 1000", "%", "Takes the incidence in the middle of each facet.", 5.0,
    "Averages the lobe over as many parts of a facet as its width requires.", 0.1)  # fmt: skip
def _glints() -> Measured:
    exponents = (10.0, 25.0, 100.0, 300.0, 1000.0)
    exact, plain, own = (
        np.array([echo(exponent) for exponent in exponents])
        for echo in (lambda n: _echo_by_facets(n, 100_000), lambda n: _echo_by_facets(n, 64), _echo_by_sweep)
    )
    picture = plot("exponent of the specular lobe", "energy over the exact one", exponents, plain / exact, own / exact,
                   1.0, log="x")  # fmt: skip
    return Measured.by(lambda energy: worst(energy, exact), plain, own, picture)


BEAMS = StabilityTheme("Beams", 8)
FARTHEST = 3  # index of the farthest ball of the scene
ALIKE = {"target_planes": "0"}  # no planes for targets alone


@BEAMS.case("Too few planes across a fan",
    "A target narrower than the distance between two planes returns an echo only where a plane meets it.",
    "variation of a small sphere's echo within the beam", "%",
    "Uses as few planes as a tolerance of 1 allows, alike whatever lies in the beam.", 100.0,
    "Lays planes across the sphere as close as its size requires, others by the plan.", 30.0,
    scene="breaks-comb")  # fmt: skip
def _few_planes() -> Measured:
    scene = load_scene("breaks-comb")
    ball, beam, sonar = scene.targets[FARTHEST], scene.sonar.beam, scene.sonar
    assert isinstance(ball, Sphere)
    assert isinstance(beam, FanBeam)
    near = math.hypot(ball.position[1], scene.altitude - ball.radius) - ball.radius
    echo = slice(*(int(r * sonar.bins / sonar.range) for r in (near - ball.radius, near + 2.0 * ball.radius)))
    pings, alone = np.arange(scene.track.pings), edit(scene, {"targets": [ball]})
    bed = prepare(edit(scene, {"targets": []})).intensity(pings[:1])[0, 0, echo].sum()
    # At a tolerance of 1 planes may lie farther apart than a ball is wide.
    coarse, planned = prepare(alone, tolerance=1.0, forced=ALIKE), prepare(alone)
    few, many = (one.intensity(pings)[:, 0, echo].sum(axis=1) / bed - 1.0 for one in (coarse, planned))
    along, width = coarse.poses(pings).x - ball.position[0], near * math.radians(beam.width)
    inside = np.abs(along) < 0.35 * width
    picture = plot("distance along the track from the sphere (m)", "echo of the sphere over that of the bed", along,
                   few, many, style=".-", xlim=(-width, width))  # fmt: skip
    return Measured.by(lambda one: 100.0 * np.ptp(one[inside]) / many[inside].mean(), few, many, picture)


FAR_BINS = 200


def _contrast(scene: Scene) -> Floats:
    """Far bins of the port record over their mean, less 1, pings by bins."""
    record = simulate(scene).intensity.values[0, :, -FAR_BINS:].astype(np.float64)
    return np.asarray(record / record.mean(axis=0) - 1.0)


@BEAMS.case("Pings that beat with ripples",
    "A knife-edge beam samples one line per ping; ripples about as long as the distance between lines alias to "
    "bands many times as long.",
    "contrast along the track of bands longer than four ripples", "%", "Samples lines one ripple length apart.", 50.0,
    "Uses a fan wider than the distance between two pings.", 20.0, scene="breaks-beats")  # fmt: skip
def _beats() -> Measured:
    scene = load_scene("breaks-beats")
    relief, apart = scene.seabed.relief, scene.track.speed / scene.sonar.ping_rate
    assert isinstance(relief, Fractal)
    fan = {"sonar.beam": {"kind": "fan", "width": 3.0}}
    slowly = {"track.speed": 0.1 * scene.track.speed}
    knife, wide, exact = (_contrast(edit(scene, change)) for change in ({}, fan, slowly))
    length = relief.period / relief.peaks[0][0]

    def contrast(record: Floats) -> float:
        """Contrast of all wavelengths beyond four ripples, in per cent."""
        waves = np.fft.rfft(record, axis=0)
        long = np.abs(np.fft.rfftfreq(record.shape[0], apart)) < 0.25 / length
        return float(100.0 * np.fft.irfft(waves * long[:, None], record.shape[0], axis=0).std())

    along, middle = np.arange(len(knife)) * apart, FAR_BINS // 2
    curves = knife[:, middle], wide[:, middle], (0.1 * along, exact[:, middle])
    picture = plot("along the track (m)", "intensity over the mean, less 1", along, *curves, xlim=(0.0, 18.0))
    return Measured.by(contrast, knife, wide, picture)


@BEAMS.case("Pings too far apart", "The sonar moves by more than its beam width between two pings.",
    "targets missed without a message", "of 5", "Simulates the scene without a check.", 3.0,
    "States in the plan up to which range a narrow target can be missed.", 0.0)  # fmt: skip
def _sparse() -> Measured:
    balls = [{"kind": "sphere", "position": [1.0 + 2.0 * k, 15.0], "radius": 0.1} for k in range(5)]
    fan = {"sonar.beam": {"kind": "fan", "width": 0.5}, "sonar.ping_rate": 1.0, "track.pings": 6}
    scene = make_level_scene({"targets": balls, **fan})
    whole = simulate(scene).intensity.values
    without = [edit(scene, {"targets": [one for one in scene.targets if one != ball]}) for ball in scene.targets]
    missed = sum(np.array_equal(whole, simulate(one).intensity.values) for one in without)
    reason = next((entry.reason for entry in plan(scene).entries if "can be missed" in entry.reason), "")
    rows = [("5 spheres between pings", f"{missed} without an echo and without a message", reason)]
    return Measured(float(missed), 0.0 if reason else float(missed), table(rows))


@BEAMS.case(
    "A cone taken for a wedge", "A beam is a cone about the track: at slant range r it covers r θ of the bed, not x θ.",
    "error of the along-track width", "%", "Takes ground range times the beam's angle.", 30.0,
    "Takes all azimuths with cos θ · |sin φ| within the beam.", 0.01)  # fmt: skip
def _wedge() -> Measured:
    arrays = level_arrays({"sonar.beam": {"kind": "fan", "width": 2.5}})
    r = np.array([10.2, 10.5, 11.0, 12.0, 14.0, 18.0, 25.0, 40.0])
    x = np.sqrt(r**2 - 100.0)
    azimuth = (np.arange(2_000_000) + 0.5) / 2_000_000 * 0.5 * math.pi
    inside = [np.mean(xk / rk * np.sin(azimuth) <= math.sin(arrays.half_width)) for xk, rk in zip(x, r)]
    wedge, cone, counted = x * 2.0 * arrays.half_width, along_track_width(arrays, x, r), math.pi * x * np.array(inside)
    picture = plot("slant range, 10 m above the bed (m)", "bed within the beam (m)", r, wedge, cone, counted)
    return Measured.by(lambda width: worst(width, counted), wedge, cone, picture)


ALTITUDE, SQUINT = 10.0, 15.0  # m above the bed, °


@BEAMS.case("Light through a beam that squints",
    "Law light averages over azimuths; in a squinting beam, equal steps of the sine are unequal steps of azimuth.",
    f"error of the light of a level bed, squint of {SQUINT:g}°", "%",
    "Divides by the integral of the response over sines.", 5.0,
    "Divides by its integral over azimuths.", 1.0)  # fmt: skip
def _light() -> Measured:
    beam = {"kind": "gaussian", "width": 3.0, "squint": SQUINT}
    arrays = level_arrays({"sonar.beam": beam, "sonar.law": "light"})
    shown = (r := bin_centres(arrays)) > 1.1 * ALTITUDE
    r = r[shown]
    # Light of a level bed is H/r.
    own = sweep_port(arrays, make_pose(0.0, 0.0, ALTITUDE), planes=64)[shown] * r / ALTITUDE
    level = np.sqrt(1.0 - (ALTITUDE / r[:, None]) ** 2)
    azimuth = math.pi * ((np.arange(4001) + 0.5) / 4001 - 0.5)
    off = (level * np.sin(azimuth) - math.sin(math.radians(SQUINT))) / math.sin(math.radians(1.5))
    response = 0.25 ** (off * off)
    # The beam's azimuths over the integral of its response over sines, ds / level.
    plain = response.sum(axis=1) / (response * np.cos(azimuth)).sum(axis=1)
    picture = plot("slant range, 10 m above the bed (m)", "light of a level bed, over H/r", r, plain, own, 1.0)
    return Measured.by(lambda light: worst(light, 1.0), plain, own, picture)


LENGTH = 1.0  # m, of an array


@BEAMS.case("The near field of a line array",
    "Nearer than the square of its length over the wavelength, the beam of an array is as wide as the array itself.",
    f"error of the width of the beam of an array of {LENGTH:g} m, from 10 m to 90 m", "%",
    "Takes the pattern of the far field.", 50.0,
    "Tabulates the pattern range by range, by Fresnel's approximation.", 2.0)  # fmt: skip
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
    picture = plot("slant range (m)", "width of the beam, two ways (rad)", r, far, own, exact, log="y")
    return Measured.by(lambda width: worst(width, exact), far, own, picture)


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


@SEA_SURFACE.case("Waves at a record's end",
    "A wave trough shortens the path of an echo that would arrive after the end of the record over a calm sea.",
    f"echo missing from the last {LAST:g} m of the record", "%",
    "Follows the bed up to the end of the record over a calm sea.", 5.0,
    "Follows it up to the last echo that the lowest facet of the sea returns in time.", 0.1)  # fmt: skip
def _waves() -> Measured:
    def over(heights: Floats, end: float) -> SceneArrays:
        return arrays_over(heights, 0.1, {"sonar.range": end, "sonar.bins": round(20.0 * end)}, x0=-0.2)

    level = np.zeros((1201, 4))
    seen = np.where(_pair_range(0.1 * np.arange(1201, dtype=np.float64)) <= END, 0.0, np.nan)
    calm, short, long = over(np.tile(seen[:, None], 4), END), over(level, END), over(level, END + 20.0)
    plain, own, exact = (_surface_echo(arrays, WIND)[: short.bins] for arrays in (calm, short, long))
    r, lit = bin_centres(short), exact > 0.0
    last, ratios = r > END - LAST, [one[lit] / exact[lit] for one in (plain, own)]
    picture = plot("slant range (m)", "echo by the surface over that of a longer record", r[lit], *ratios, 1.0,
                   xlim=(END - 5.0, END), ylim=(0.0, 1.2))  # fmt: skip
    return Measured.by(lambda one: worst(one[last].sum(), exact[last].sum()), plain, own, picture)


PAIR_WIDTH, PAIR_SQUINT = 4.0, 10.0  # °


@SEA_SURFACE.case("Two legs of a squinting beam",
    "On a path out by the surface and straight back, a squinting beam covers different azimuths on its two legs.",
    "error of the energy", "%", "Takes the root of the product of the azimuths of each leg alone.", 100.0,
    "Integrates the root of both responses over their common azimuths.", 0.05)  # fmt: skip
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
    common = math.pi * np.sqrt(beams[0] * beams[1]).mean(axis=1)
    apart = math.pi * np.sqrt(beams[0].mean(axis=1) * beams[1].mean(axis=1))
    density = 2.0 * ALTITUDE * (ALTITUDE + RAISED) / math.pi * x * _pair_range(x) ** 4 / (near * far) ** 3
    borders = arrays.bin_length * np.arange(arrays.bins + 1)
    plain, exact = (
        np.diff(np.interp(borders, _pair_range(edges), np.concatenate([[0.0], np.cumsum(density * taken * 0.01)])))
        for taken in (apart, common)
    )
    own, r = _surface_echo(arrays), bin_centres(arrays)
    shown = r > _pair_range(0.0)
    curves = plain[shown], own[shown], exact[shown]
    picture = plot("slant range (m)", "echo by the surface", r[shown], *curves, log="y")
    return Measured.by(lambda one: worst(one.sum(), exact.sum()), plain, own, picture)
