"""Coherent speckle: interfering waves of single scatterers, which the sweep finds visible.

Derived in docs/theory/speckle.md.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from insonify.acoustics.pulses import MOST_SAMPLES, envelope, pulse_taps, samples_per_bin
from insonify.acoustics.resolution_cell import along_track_angle, bin_centres
from insonify.arrays import Complexes, Floats, Singles
from insonify.kernels.bed.profile import empty_profile, profile_capacity
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.speckle.scatterers import (
    NO_PHASES,
    BeamPhases,
    PulseTaps,
    Scatterers,
    detect_samples,
    empty_signal,
    trace_scatterers,
)
from insonify.kernels.speckle.surface_patches import SurfacePatches
from insonify.kernels.sweep.sweep import AzimuthFan
from insonify.kernels.sweep.visible_stretches import empty_visible_bed
from insonify.packing.containment import refuse_sonar_in_target
from insonify.packing.surface_patches import make_surface_patches
from insonify.scene import Scene, SceneError
from insonify.scene.sonar.beams import BeamConditions
from insonify.scene.sonar.pulses import PulseKind as DeclaredPulse
from insonify.tow.poses import take_poses
from insonify.tracers.azimuth_fan import lay_planes
from insonify.tracers.base import PreparedTracer, empty_record, share_blocks

IN_A_CELL = 32.0  # scatterers, where the scene does not say how many
MOST = 1e7  # scatterers of one ping
MOST_KNOTS = 1 << 26  # of all planes of a beam: half a gigabyte
MOST_PATCHES = 250_000  # of all boxes and meshes
FAINT = 1e-3  # share of the beam's energy that may be left out
RESOLVED = 8  # least cells of the line per resolution cell of the pulse


@dataclass(frozen=True, eq=False)
class ScattererTracer(PreparedTracer):
    """Tracer that sums the waves of single scatterers."""

    scatterers: Scatterers  # their density and positions
    pulse: PulseTaps  # samples of the pulse's envelope, along which waves add up

    @property
    def bins_beyond(self) -> int:
        """Bins beyond the record's last with scatterers that the pulse still covers."""
        return math.ceil((self.pulse.taps.size - self.pulse.before) / (self.pulse.samples * self.pulse.cells))

    def trace(self, arrays: SceneArrays, poses: Poses, **settings: Any) -> Singles:
        """Intensity of the sum of all scatterers' waves after the pulse."""
        out = empty_record(arrays, poses)
        detect_samples(self.trace_waves(arrays, poses, **settings), self.pulse.samples, out)
        return out

    def trace_waves(
        self, arrays: SceneArrays, poses: Poses, *, planes: int = 16, across: int = 0, threads: int | None = None
    ) -> Complexes:
        """Sum of all scatterers' waves after the pulse, sample by sample."""
        refuse_sonar_in_target(arrays, poses)
        # Bins beyond the last have its range factor.
        bins = arrays.bins + self.bins_beyond
        factor = np.pad(arrays.range_factor, (0, self.bins_beyond), mode="edge")
        further = _narrowed(arrays._replace(bins=bins, range_factor=factor), self.scatterers.patches, poses)
        capacity = profile_capacity(further.bins * further.bin_length, arrays.bed.spacing)
        out = self._empty_waves(arrays, poses)
        laid = lay_planes(further, poses, max(planes, 2), across)
        for first in np.unique(laid.first):  # pings that share their planes
            places = np.flatnonzero(laid.first == first)
            some, beam = take_poses(poses, places), laid.of(places[0])
            _refuse_fine_bed(beam.azimuth.size, capacity, arrays)
            traced = self._empty_waves(arrays, some)

            def block(part: Poses, first: int, last: int, beam: AzimuthFan = beam, traced: Complexes = traced) -> None:
                sight = empty_visible_bed(beam.azimuth, capacity)
                room = empty_profile(capacity), sight, empty_signal(further.bins, self.pulse)
                trace_scatterers(further, part, beam, self.scatterers, self.pulse, *room, traced[first:last])

            share_blocks(some, block, threads)
            out[places] = traced
        return out

    def _empty_waves(self, arrays: SceneArrays, poses: Poses) -> Complexes:
        return np.zeros((poses.x.size, 2, arrays.bins * self.pulse.samples), np.complex128)


def make_tracer(scene: Scene, arrays: SceneArrays) -> ScattererTracer:
    """Strew the scatterers of a scene of coherent speckle."""
    speed, pulse = arrays.water.reference, scene.sonar.pulse
    width = along_track_angle(arrays) * bin_centres(arrays)
    length = float(pulse_taps(pulse, speed, arrays.bin_length).weights.sum()) * arrays.bin_length
    density = scene.receiver.speckle.scatterer_density or IN_A_CELL / (float(width[arrays.bins // 2]) * length)
    count = 2.0 * density * float(width.sum()) * arrays.bin_length
    if count > MOST:
        raise SceneError(
            f"receiver.speckle.density: {density:.3g} scatterers per m² make {count:.2g} in the beam of a ping; "
            f"lower it to {density * MOST / count:.2g} or shorten sonar.range"
        )
    per_wave = 2.0 * scene.sonar.frequency / speed
    _refuse_large_meshes(arrays.mesh.corners)
    patches = make_surface_patches(arrays.solids, arrays.mesh)
    pattern = arrays.pattern
    turns = scene.sonar.beam.phases(BeamConditions(speed, scene.sonar.frequency, scene.sonar.range))
    phases = NO_PHASES
    if turns is not None:
        phases = BeamPhases(turns, pattern.centre, pattern.extent, pattern.first_range, pattern.per_octave)
    return ScattererTracer(
        Scatterers(scene.seed, density, per_wave, patches, phases),
        sample_pulse(pulse, speed, arrays.bin_length, arrays.bins),
    )


def sample_pulse(pulse: DeclaredPulse, sound_speed: float, bin_length: float, bins: int = 1) -> PulseTaps:
    """Sample a pulse along the line on which waves are summed."""
    resolution = 0.5 * sound_speed * pulse.resolution or bin_length
    samples = samples_per_bin(pulse, sound_speed, bin_length)
    # An even number, so that the sample lies in the middle.
    cells = 2 * math.ceil(0.5 * RESOLVED * bin_length / samples / resolution)
    step = bin_length / samples / cells
    if bins * samples * cells > MOST_SAMPLES:
        raise SceneError(
            f"receiver.speckle: 'coherent' samples waves every {step:.2g} m, as sonar.pulse resolves them, and the "
            "range has too many such samples; lengthen the pulse, lower its bandwidth or shorten sonar.range"
        )
    if pulse.length == 0.0:
        return PulseTaps(1, cells, np.full(cells, 1.0), cells // 2)
    reach = math.ceil(0.5 * sound_speed * pulse.length / step)
    # The response to a tone lasts from its arrival, that to a compressed chirp extends to both sides of it.
    late = np.arange(2 * reach if pulse.two_sided else reach, dtype=np.float64)
    amplitudes = envelope(pulse, (reach - 0.5 - late) * step, sound_speed)
    energy = float(pulse_taps(pulse, sound_speed, bin_length).weights.sum()) * bin_length
    amplitudes *= math.sqrt(energy / (float((amplitudes**2).sum()) * step))
    return PulseTaps(samples, cells, amplitudes, reach)


def _refuse_fine_bed(planes: int, knots: int, arrays: SceneArrays) -> None:
    """Refuse a bed of more knots than can be kept of all planes at once."""
    spacing = arrays.bed.spacing
    if planes * knots > MOST_KNOTS:
        raise SceneError(
            f"receiver.speckle: 'coherent' keeps {planes} profiles of a bed of seabed.spacing {spacing:g} m in memory, "
            f"which is too much; widen the spacing to {spacing * planes * knots / MOST_KNOTS:.2g} m, "
            "shorten sonar.range or take another speckle"
        )


def _refuse_large_meshes(corners: Floats) -> None:
    """Refuse boxes and meshes of more patches than can be kept."""
    edges = corners - np.roll(corners, -1, axis=1)
    areas = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    # Triangles halved until no edge is longer than a metre: sixths of a square metre, or slivers.
    patches = float((6.0 * areas + 10.0 * np.linalg.norm(edges, axis=2).max(axis=1, initial=0.0)).sum())
    if patches > MOST_PATCHES:
        raise SceneError(
            f"receiver.speckle: 'coherent' keeps {patches:.2g} patches of target surface in memory, which is too much; "
            "use smaller boxes and meshes or take another speckle"
        )


def _narrowed(arrays: SceneArrays, patches: SurfacePatches, poses: Poses) -> SceneArrays:
    """Scene with a beam pattern without directions of many scatterers and negligible sensitivity."""
    # Of every row of its table the outermost columns go, and rows nearer than anything lies become no wider than
    # others.
    pattern = arrays.pattern
    if not pattern.tabulated or poses.z.size == 0:
        return arrays
    top = max(arrays.bed.high, float((patches.centre[:, 2] + patches.bound).max(initial=-math.inf)))
    nearest = max(float(poses.z.min()) - top, pattern.first_range)
    first = min(int(math.log2(nearest / pattern.first_range) * pattern.per_octave), pattern.extent.size - 1)
    rows = map(_without_faint_sidelobes, pattern.extent, pattern.energy, pattern.integral)
    extent, energy, integral = map(np.array, zip(*rows))
    # No scatterer reads those rows: a ping does not depend on the others traced with it.
    extent[:first] = extent[first]
    return arrays._replace(pattern=pattern._replace(extent=extent, energy=energy, integral=integral))


def _without_faint_sidelobes(extent: float, energy: Floats, integral: Floats) -> tuple[float, Floats, Floats]:
    """One row of a pattern, drawn over the directions that hold nearly all of its energy."""
    place = np.linspace(-1.0, 1.0, energy.size)
    within = np.interp(place, place, integral) - np.interp(-place, place, integral)
    # The narrowest part, of at least three columns, that holds enough energy.
    half = max(float(place[np.argmax(within >= (1.0 - FAINT) * integral[-1])]), 2.0 / energy.size)
    inner = np.interp(half * place, place, integral)
    return half * extent, np.interp(half * place, place, energy), inner - inner[0]
