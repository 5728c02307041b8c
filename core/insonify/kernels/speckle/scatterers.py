"""Coherent speckle: echoes of single scatterers, added up as waves.

Scatterers lie on the bed and on targets at hashed places, a Poisson number in each lot, and scatter with circular
Gaussian amplitudes. Each visible scatterer adds its wave, with the mean energy of its share of the area, to a signal
over slant range that is sampled finer than the pulse. The sum of the signal over the pulse is one sample; its energy
enters the record. The mean over all realisations of the scatterers is the sweep's record.
Derived in docs/theory/speckle.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import row_of_range, two_way_response
from insonify.kernels.common.hashing import hash_integers, splitmix64
from insonify.kernels.common.range_bins import range_weight
from insonify.kernels.common.scattering import backscatter
from insonify.kernels.common.streams import BED_SCATTERERS, TARGET_SCATTERERS
from insonify.kernels.common.types import SONAR
from insonify.kernels.geometry.solids import intersect_solid
from insonify.kernels.geometry.triangles import intersect_mesh
from insonify.kernels.rays.cell_walk import Ray, cell_normal, load_bed_cell, meet_bed
from insonify.kernels.rays.launch import beam_touches_ball, list_solids_in_beam, orient_beam
from insonify.kernels.speckle.surface_patches import FACE, SurfacePatches, load_patch, sample_patch
from insonify.kernels.sweep.visible_stretches import find_visible_bed, is_bed_visible

LOT = 4.0  # scatterers that a lot has on average, at most
GRAZED = 1e-6  # share of its distance by which a scatterer on a body's surface may lie below it
STEEPEST = 0.999  # sine from athwart beyond which a beam is taken to reach all ahead
EMPTY = 1e300
HALF, LOW_HALF, UNIT = np.uint64(32), np.uint64(0xFFFFFFFF), 2.0**-32


class BeamPhases(NamedTuple):
    """Phases of waves there and back over those from the middle of the beam, by rows of slant range and by sine."""

    turns: NDArray[np.float64]  # (rows, columns) at equal steps of the sine; one row of zeros for no phases
    centre: float  # and the rest as of `BeamPattern`
    extent: NDArray[np.float64]
    first_range: float
    per_octave: float


NO_PHASES = BeamPhases(np.zeros((1, 2)), 0.0, np.ones(1), 1.0, 1.0)


class Scatterers(NamedTuple):
    """Density of scatterers, and the turns of their phases per metre of slant range."""

    seed: int
    density: float  # per m², on average
    per_wave: float  # turns of the phase per metre of slant range, there and back
    patches: SurfacePatches
    phases: BeamPhases = NO_PHASES


class PulseTaps(NamedTuple):
    """Amplitudes with which one sample sums the coherent signal over the pulse."""

    samples: int  # per bin; the bin has their mean energy
    cells: int  # of the line, per sample
    taps: NDArray[np.float64]  # amplitudes, from the nearest cell to the farthest
    before: int  # how many of them lie nearer than the middle of the sample


class CoherentSignal(NamedTuple):
    """Sum of waves by slant range, in cells finer than the pulse."""

    real: NDArray[np.float64]
    imaginary: NDArray[np.float64]


class WaveScale(NamedTuple):
    """How a scatterer's slant range becomes a place and a phase of the signal."""

    share: float  # area of one scatterer, m²
    per_wave: float  # turns per metre
    bin_length: float  # m
    cells: int  # of the line, per bin
    before: int  # cells of the line before slant range 0


class ScattererEcho(NamedTuple):
    """A scatterer as the sonar sees it."""

    response: float  # two-way response of the beam; 0 outside it
    cosine: float  # of the incidence
    r: float  # slant range, m
    dx: float  # direction to it
    dy: float
    dz: float
    level: float  # ground range, m
    sine: float  # of its azimuth, towards the bow
    turns: float  # phase of the beam in its direction


def empty_signal(bins: int, pulse: PulseTaps) -> CoherentSignal:
    """Make room for the coherent signal of a record's bins and of those that a pulse takes in before and after them."""
    size = bins * pulse.samples * pulse.cells + pulse.taps.size
    return CoherentSignal(*np.zeros((2, size)))


@kernel
def trace_scatterers(arrays, poses, fan, scatterers, pulse, profile, visible_bed, signal, out):
    """Sum the waves of single scatterers at every sample of the record.

    Parameters
    ----------
    arrays : SceneArrays
        May have more bins than the record: what a pulse takes in beyond its end.
    poses : Poses
        n pings.
    fan : AzimuthFan
        Planes in which the visible bed is found, their azimuths ascending.
    scatterers, pulse : Scatterers, PulseTaps
    profile, visible_bed, signal : Profile, VisibleBed, CoherentSignal
        Work space.
    out : ndarray of complex128, shape (n, 2, bins * samples)
        Takes the waves after the pulse.
    """
    near = np.empty(arrays.solids.shape.size, np.int64)
    for ping in range(poses.x.size):
        for side in range(2):
            beam = orient_beam(arrays, poses, ping, side)
            find_visible_bed(arrays, poses, ping, side, fan, profile, visible_bed)
            count, _ = list_solids_in_beam(arrays.solids, arrays.mesh, beam, near)
            signal.real[:], signal.imaginary[:] = 0.0, 0.0
            _add_bed(arrays, beam, scatterers, visible_bed, near[:count], pulse, signal)
            _add_targets(arrays, beam, scatterers, near[:count], pulse, signal)
            _sample_pulse(signal.real, signal.imaginary, pulse, out[ping, side])


@kernel
def _sample_pulse(real, imaginary, pulse, out):
    """Sum the signal over the pulse at every sample."""
    taps, middle = pulse.taps, pulse.cells // 2
    for sample in range(out.size):
        start = sample * pulse.cells + middle
        re, im = 0.0, 0.0
        for tap in range(taps.size):
            re += taps[tap] * real[start + tap]
            im += taps[tap] * imaginary[start + tap]
        out[sample] = complex(re, im)


@kernel
def detect_samples(waves, samples, out):
    """Intensity of every bin: the mean energy of its samples.

    Parameters
    ----------
    waves : ndarray of complex128, shape (n, 2, bins * samples)
    samples : int
        Of a bin.
    out : ndarray of float32, shape (n, 2, bins)
        Filled.
    """
    pings, sides, bins = out.shape
    for ping in range(pings):
        for side in range(sides):
            for k in range(bins):
                total = 0.0
                for sample in range(k * samples, (k + 1) * samples):
                    wave = waves[ping, side, sample]
                    total += wave.real * wave.real + wave.imag * wave.imag
                out[ping, side, k] = total / samples


@kernel
def _add_bed(arrays, beam, scatterers, visible_bed, near, pulse, signal):
    """Add the waves of the bed's scatterers: lots are the squares of a lattice fixed to the world."""
    # Arrays are taken out of their tuples before the loop: doing so costs more than a scatterer.
    bed, table, pattern, phases = arrays.bed, arrays.reflectivity, arrays.pattern, scatterers.phases
    factor, decay = arrays.range_factor, arrays.range_decay
    heights, materials, real, imaginary = bed.heights, bed.materials, signal.real, signal.imaginary
    borders, reach, edges, edge_count = visible_bed
    grid, waves = (bed.x0, bed.y0, bed.spacing, bed.periodic), _wave_scale(arrays, scatterers, pulse)
    bodies = near.size > 0 or arrays.mesh.skip.size > 0
    pitch = math.sqrt(LOT / scatterers.density)
    none, corners = math.exp(-LOT), _beam_footprint(beam, bed.low, bed.high)
    low, high = max(corners[:, 1].min(), beam.y - beam.reach), min(corners[:, 1].max(), beam.y + beam.reach)
    for row in range(math.floor(low / pitch), math.floor(high / pitch) + 1):
        low, high = _extent_in_x(corners, row * pitch, (row + 1) * pitch)
        low, high = max(low, beam.x - beam.reach), min(high, beam.x + beam.reach)
        for column in range(math.floor(low / pitch), math.floor(high / pitch) + 1):
            key = hash_integers(scatterers.seed, BED_SCATTERERS, column, row, np.int64(0))
            for member in range(_poisson(key, LOT, none)):
                bits, more = _random_bits(key, member)
                x, y = (column + _upper_uniform(bits)) * pitch, (row + _lower_uniform(bits)) * pitch
                height, nx, ny, nz, material = _bed_at(heights, materials, grid, x, y)
                echo = _observe(beam, pattern, phases, x, y, height, nx, ny, nz)
                if echo.response > 0.0 and is_bed_visible(borders, reach, edges, edge_count, echo.sine, echo.level):
                    if bodies and _is_behind_targets(arrays.solids, arrays.mesh, near, beam, echo):
                        continue
                    # The lattice is level: on a slope a square of it carries more bed.
                    energy = _mean_energy(table, material, echo) / nz
                    _add_wave(energy, echo.r, echo.turns, more, waves, factor, decay, real, imaginary)


@inlined
def _beam_footprint(beam, lowest, highest):
    """Trapezoid that encloses all the bed inside one side's beam."""
    depth = max(abs(lowest - beam.z), abs(highest - beam.z))
    corners = np.empty((4, 2))
    for k in range(4):
        across = 0.0 if k == 0 or k == 3 else beam.reach
        if k < 2:
            along = -_foremost(beam, -beam.s_low, depth, across)
        else:
            along = _foremost(beam, beam.s_high, depth, across)
        corners[k, 0] = beam.x + across * beam.side_x + along * beam.ahead_x
        corners[k, 1] = beam.y + across * beam.side_y + along * beam.ahead_y
    return corners


@inlined
def _foremost(beam, sine, depth, across):
    """Greatest distance ahead of bed inside the beam, at a distance across: a·cos p + z·sin p = s·√(x² + a² + z²)."""
    # The distance ahead is convex in the distance across, so that the chord over its ends encloses all between.
    cos_pitch = math.sqrt(1.0 - beam.axis_z * beam.axis_z)
    s, tip = min(sine / cos_pitch, STEEPEST), abs(beam.axis_z) * depth / cos_pitch
    if s <= 0.0:
        return s * across + tip
    open_to = 1.0 - s * s
    return (tip + s * math.sqrt(tip * tip + open_to * (across * across + depth * depth))) / open_to


@inlined
def _extent_in_x(corners, low, high):
    """Least and greatest x of a convex figure between two values of y."""
    least, greatest = EMPTY, -EMPTY
    for k in range(4):
        x, y = corners[k, 0], corners[k, 1]
        dx, dy = corners[(k + 1) % 4, 0] - x, corners[(k + 1) % 4, 1] - y
        start, stop = 0.0, 1.0
        if dy != 0.0:
            one, other = (low - y) / dy, (high - y) / dy
            start, stop = max(start, min(one, other)), min(stop, max(one, other))
        elif not low <= y <= high:
            continue
        if start <= stop:
            least = min(least, x + start * dx, x + stop * dx)
            greatest = max(greatest, x + start * dx, x + stop * dx)
    return least, greatest


@inlined
def _wave_scale(arrays, scatterers, pulse):
    """Scale of places and phases for a record."""
    cells = pulse.samples * pulse.cells
    return WaveScale(1.0 / scatterers.density, scatterers.per_wave, arrays.bin_length, cells, pulse.before)


@kernel
def _add_targets(arrays, beam, scatterers, near, pulse, signal):
    """Add the waves of the scatterers on targets: every patch of their surfaces has lots of its own."""
    patches, waves = scatterers.patches, _wave_scale(arrays, scatterers, pulse)
    for row in range(patches.kind.size):
        cx, cy, cz = patches.centre[row, 0] - beam.x, patches.centre[row, 1] - beam.y, patches.centre[row, 2] - beam.z
        if beam_touches_ball(beam, cx, cy, cz, math.sqrt(cx * cx + cy * cy + cz * cz), patches.bound[row]):
            patch, material = load_patch(patches, row, arrays.solids, arrays.mesh)
            mean, lots = patches.area[row] * scatterers.density, math.ceil(patches.area[row] * scatterers.density / LOT)
            for lot in range(lots):
                key = hash_integers(scatterers.seed, TARGET_SCATTERERS, patches.target[row], patches.number[row], lot)
                _add_lot(patch, material, key, mean / lots, arrays, scatterers.phases, beam, near, waves, signal)


@kernel
def _add_lot(patch, material, key, mean, arrays, phases, beam, near, waves, signal):
    """Add the waves of one lot of a patch."""
    for member in range(_poisson(key, mean, math.exp(-mean))):
        bits, more = _random_bits(key, member)
        place = sample_patch(patch, _upper_uniform(bits), _lower_uniform(bits))
        echo = _observe(beam, arrays.pattern, phases, place.x, place.y, place.z, place.nx, place.ny, place.nz)
        if patch.kind == FACE and echo.cosine < 0.0:
            # Triangles scatter from both sides.
            echo = _observe(beam, arrays.pattern, phases, place.x, place.y, place.z, -place.nx, -place.ny, -place.nz)
        if echo.response > 0.0 and not _is_behind_targets(arrays.solids, arrays.mesh, near, beam, echo):
            bed, _, _, _, _ = meet_bed(arrays.bed, Ray(beam.x, beam.y, beam.z, echo.dx, echo.dy, echo.dz), echo.r)
            if not bed < echo.r:
                energy = _mean_energy(arrays.reflectivity, material, echo)
                factor, decay = arrays.range_factor, arrays.range_decay
                _add_wave(energy, echo.r, echo.turns, more, waves, factor, decay, signal.real, signal.imaginary)


@inlined
def _observe(beam, pattern, phases, x, y, z, nx, ny, nz):
    """Echo geometry of a place with its outward normal; a place at NaN, without a bed, is not visible."""
    x, y, z = x - beam.x, y - beam.y, z - beam.z
    r = math.sqrt(x * x + y * y + z * z)
    dx, dy, dz = x / r, y / r, z / r
    cosine = -(nx * dx + ny * dy + nz * dz)
    level = math.sqrt(x * x + y * y)
    response, turns = 0.0, 0.0
    sine = dx * beam.axis_x + dy * beam.axis_y + dz * beam.axis_z
    ahead = dx * beam.side_x + dy * beam.side_y >= 0.0
    if ahead and r < beam.reach and cosine > 0.0 and beam.s_low <= sine <= beam.s_high:
        response = two_way_response(pattern, beam, True, SONAR, dx, dy, dz, r) if pattern.tabulated else 1.0
        if phases.turns.shape[0] > 1 and response > 0.0:
            turns = _phase_of_beam(phases, sine, r)
    return ScattererEcho(response, cosine, r, dx, dy, dz, level, (x * beam.ahead_x + y * beam.ahead_y) / level, turns)


@inlined
def _phase_of_beam(phases, s, r):
    """Phase of the beam in a direction, in turns, bilinear in s and log r."""
    row, share = row_of_range(phases.extent, phases.first_range, phases.per_octave, r)
    return (1.0 - share) * _phase_in_row(phases, row, s) + share * _phase_in_row(phases, row + 1, s)


@inlined
def _phase_in_row(phases, row, s):
    """Phase of one row, in turns; beyond its ends the phase of the ends."""
    last, extent = phases.turns.shape[1] - 1, phases.extent[row]
    place = min(max((s - phases.centre + extent) / (2.0 * extent), 0.0), 1.0) * last
    k = min(int(place), last - 1)
    return phases.turns[row, k] + (place - k) * (phases.turns[row, k + 1] - phases.turns[row, k])


@inlined
def _mean_energy(table, material, echo):
    """Mean energy of an echo per m² of its surface."""
    diffuse, specular, shininess = table[material, 0], table[material, 1], table[material, 2]
    return echo.response * backscatter(echo.cosine, diffuse, specular, shininess)


@inlined
def _add_wave(energy, r, beam_turns, bits, waves, factor, decay, real, imaginary):
    """Add the wave of one scatterer, from the mean energy per m² of its share of the area."""
    place = r / waves.bin_length
    k = min(int(place), factor.size - 1)
    energy *= waves.share * factor[k] * range_weight(decay, k, place, 0.0)
    # Circular Gaussian: exponential energy, uniform phase (Goodman 2007, *Speckle phenomena in optics*, ch. 2).
    modulus = math.sqrt(-energy * math.log(_upper_uniform(bits) + 0.5 * UNIT))
    turns = r * waves.per_wave + beam_turns + _lower_uniform(bits)
    phase = 2.0 * math.pi * (turns - math.floor(turns))
    cell = waves.before + int(place * waves.cells)
    real[cell] += modulus * math.cos(phase)
    imaginary[cell] += modulus * math.sin(phase)


@kernel
def _is_behind_targets(solids, mesh, near, beam, echo):
    """Whether any target lies nearer than a scatterer in its direction."""
    r = echo.r * (1.0 - GRAZED)
    for m in range(near.size):
        distance, _, _, _ = intersect_solid(solids, near[m], beam.x, beam.y, beam.z, echo.dx, echo.dy, echo.dz)
        if distance < r:
            return True
    if mesh.skip.size == 0:
        return False
    _, triangle = intersect_mesh(mesh, beam.x, beam.y, beam.z, echo.dx, echo.dy, echo.dz, r)
    return triangle >= 0


@inlined
def _bed_at(heights, materials, grid, x, y):
    """Height of the bed, its upward normal and its material; NaN where there is none."""
    x0, y0, spacing, periodic = grid
    u, v = (x - x0) / spacing, (y - y0) / spacing
    i, j = math.floor(u), math.floor(v)
    rows, columns = heights.shape
    inside = 0 <= i < columns - 1 and 0 <= j < rows - 1
    row, column = (j, i) if inside else (j % rows, i % columns)
    cell = load_bed_cell(heights, row, column)
    u, v = u - i, v - j
    nx, ny, nz = cell_normal(cell, u, v, spacing)
    height = cell.a + cell.b * u + (cell.c + cell.d * u) * v
    return (height if inside or periodic else math.nan), nx, ny, nz, materials[row, column]


@inlined
def _poisson(key, mean, none):
    """Poisson number of scatterers in a lot, by inversion; ``none`` is exp(-mean)."""
    uniform, count, chance = _upper_uniform(key), 0, none
    while uniform > chance and none > 0.0:
        count += 1
        none *= mean / count
        chance += none
    return count


@inlined
def _random_bits(key, member):
    """Random bits of one scatterer: for its place, and for its wave."""
    bits = splitmix64(key ^ np.uint64(member + 1))
    return bits, splitmix64(bits)


@inlined
def _upper_uniform(bits):
    """Uniform number in [0, 1) from the upper half of 64 bits."""
    return np.float64(bits >> HALF) * UNIT


@inlined
def _lower_uniform(bits):
    """Uniform number in [0, 1) from the lower half of 64 bits."""
    return np.float64(bits & LOW_HALF) * UNIT
