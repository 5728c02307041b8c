"""Receiver chain: pulse, speckle, reverberation, crosstalk, fluctuation, source level, noise and gain, in order.

Theory: docs/theory/speckle.md.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.acoustics.pulses import Taps, coherent_taps, pulse_taps, samples_per_bin
from insonify.kernels.common.streams import AMBIENT_NOISE, REVERBERATION
from insonify.kernels.common.types import LIGHT, SceneArrays
from insonify.kernels.receiver.pulse import convolve_pulse
from insonify.packing.navigation import bed_beneath, make_poses
from insonify.parallel import in_parallel
from insonify.receiver.fluctuation import Fluctuation, make_fluctuation
from insonify.receiver.levels import crosstalk, noise_level, power, reverberation, time_varied_gain
from insonify.receiver.random_fields import WaveField, make_field
from insonify.receiver.speckle import Speckle, divide_by_shape, make_speckle
from insonify.receiver.waves import Waves, no_waves, split_waves, steady_waves
from insonify.scene import Scene
from insonify.terrain import AnyGround

Record = NDArray[np.float32]
Traced = NDArray[np.float32] | NDArray[np.complex128]
Curve = NDArray[np.float64]
TOGETHER = 256  # pings received at a time, so that intermediate arrays stay in the processor cache


@dataclass(frozen=True, eq=False)
class Reception:
    """The receiver of a scene, prepared for any of its pings.

    Attributes
    ----------
    taps : Taps
        Energy that the pulse spreads over neighbouring bins.
    reverberation : (bins,) float64
        Mean intensity of volume and surface reverberation.
    fluctuation, speckle : Fluctuation, Speckle or None
        None where the scene has none; interfering scatterers are no speckle of the receiver's.
    divided_by_shape : (materials, 3) float64 or None
        Reflectivities over the shape of each material's K speckle; None where the receiver's own shape holds for all.
    coherent : bool
        Whether traced echoes already hold pulse and speckle, because single scatterers interfered.
    samples : int
        Samples of a bin at which waves are summed; 1 unless scatterers interfere.
    crosstalk : float
        Share of the energy of each channel that leaks into the other.
    source : float
        Source level as a factor of intensity.
    noise : float
        Mean intensity of the noise.
    reverberation_field, noise_field : WaveField
        Waves of both, of mean energy 1.
    gain : (bins,) float64
        Time-varied gain.
    """

    taps: Taps
    reverberation: Curve
    fluctuation: Fluctuation | None
    speckle: Speckle | None
    divided_by_shape: Curve | None
    coherent: bool
    samples: int
    crosstalk: float
    source: float
    noise: float
    reverberation_field: WaveField
    noise_field: WaveField
    gain: Curve

    @property
    def speckled(self) -> bool:
        """Whether echoes have phases, which a mean over all of them has not."""
        return self.coherent or self.speckle is not None

    @property
    def sums_waves(self) -> bool:
        """Whether echoes meet waves of another origin, so that amplitudes add rather than energies."""
        return self.noise > 0.0 or (self.speckled and (self.crosstalk > 0.0 or bool(self.reverberation.any())))

    @property
    def looks(self) -> int:
        """Independent records averaged."""
        return 1 if self.speckle is None else self.speckle.looks

    def expected(self, echo: Curve) -> Curve:
        """Mean record of a uniform bed with the given echo of an ideal pulse, without reverberation, (bins,)."""
        return (echo * self.taps.weights.sum() * self.source + self.noise) * self.gain


def prepare_reception(scene: Scene, ground: AnyGround, arrays: SceneArrays) -> Reception:
    """Prepare the receiver of a scene for the height of its first ping.

    Parameters
    ----------
    scene : Scene
        Gives pulse, receiver and seed.
    ground : AnyGround
        The bed.
    arrays : SceneArrays
        The packed scene.

    Returns
    -------
    Reception
    """
    first = np.zeros(1, dtype=np.int64)
    z = make_poses(scene, ground, first).z
    altitude = max(float((z - bed_beneath(scene, ground, first))[0]), arrays.bin_length)
    materials = (*ground.reflectivities, *(target.material.reflectivity for target in scene.targets))
    k_shapes = [material.speckle_shape for material in materials]
    return make_reception(scene, arrays, altitude=altitude, depth=-float(z[0] + ground.datum), k_shapes=k_shapes)


def make_reception(
    scene: Scene, arrays: SceneArrays, *, altitude: float, depth: float, k_shapes: Sequence[float | None] = ()
) -> Reception:
    """Prepare the receiver of a scene.

    Parameters
    ----------
    scene : Scene
        Gives pulse, receiver and seed.
    arrays : SceneArrays
        The packed scene.
    altitude, depth : float
        Height of the sonar above the mean bed, and its depth, in metres.
    k_shapes : sequence of float or None
        Shape of the K speckle of every material, by its row; None where the receiver's own holds.

    Returns
    -------
    Reception
    """
    speed, pulse = arrays.water.reference, scene.sonar.pulse
    taps = pulse_taps(pulse, speed, arrays.bin_length)
    if arrays.law == LIGHT:
        # Law light: the radiance of the paper does not depend on the length of the pulse.
        taps = Taps(taps.weights / taps.weights.sum(), taps.before)
    coherent = scene.receiver.speckle.interferes
    samples = samples_per_bin(pulse, speed, arrays.bin_length) if coherent else 1
    source, noise = power(scene.receiver.source_level), noise_level(scene)
    echo = source * float(taps.weights.sum()) * flat_bed_curve(arrays, altitude)
    water = reverberation(scene.receiver.reverberation, arrays, altitude, depth).astype(np.float32)
    return Reception(
        taps=taps,
        reverberation=_convolved(taps, water[None, None])[0, 0].astype(np.float64),
        fluctuation=make_fluctuation(scene, arrays),
        speckle=make_speckle(scene, arrays),
        divided_by_shape=divide_by_shape(scene, arrays, k_shapes),
        coherent=coherent,
        samples=samples,
        crosstalk=crosstalk(scene),
        source=source,
        noise=noise,
        reverberation_field=_restless_field(scene, arrays, REVERBERATION, samples),
        noise_field=_restless_field(scene, arrays, AMBIENT_NOISE, samples),
        gain=time_varied_gain(scene, arrays, echo, noise, depth),
    )


def _restless_field(scene: Scene, arrays: SceneArrays, stream: int, samples: int) -> WaveField:
    """Waves that the receiver's filter correlates along range and that are new in every ping.

    Whatever drifts by a quarter of the wavelength between pings returns another phase: 1 mm at 400 kHz.
    """
    taps = coherent_taps(scene.sonar.pulse, arrays.water.reference, arrays.bin_length / samples)
    return make_field(scene.seed, stream, taps, np.zeros(arrays.bins * samples))


def record_echoes(
    reception: Reception,
    trace: Callable[[SceneArrays], Traced],
    arrays: SceneArrays,
    pings: NDArray[np.int64],
    out: Record | None = None,
) -> Record:
    """Trace pings and turn their echoes into a record.

    Parameters
    ----------
    reception : Reception
        From `make_reception`.
    trace : callable
        From a scene to the intensity of its echoes, (n, 2, bins), or to their waves, as `receive` takes them.
    arrays : SceneArrays
        The scene. Where materials have K speckle of their own it is traced a second time, with every reflectivity
        divided by its material's shape: echoes are linear in the reflectivity, so that the ratio of both is the mean
        of 1/ν over the echoes of a bin.
    pings : (n,) int64
        Ping numbers.
    out : (n, 2, bins) float32, optional
        Takes the record; traced intensities are overwritten with it when left out.

    Returns
    -------
    (n, 2, bins) float32
        Intensity as received.
    """
    traced = trace(arrays)
    divided: Traced | None = None
    if reception.divided_by_shape is not None:
        divided = trace(arrays._replace(reflectivity=reception.divided_by_shape))

    record = _place_of(traced, arrays.bins) if out is None else out

    def block(first: int, last: int) -> None:
        for low in range(first, last, TOGETHER):
            part = slice(low, min(low + TOGETHER, last))
            echoes = traced[part]
            received = receive(reception, echoes, pings[part], None if divided is None else divided[part])
            if received is not echoes or record is not traced:
                record[part] = received

    in_parallel(block, pings.size)
    return record


def _place_of(traced: Traced, bins: int) -> Record:
    """Record that may take the place of traced echoes: their own array if it holds intensities, else a new one."""
    if np.iscomplexobj(traced):
        return np.empty((*traced.shape[:2], bins), np.float32)
    return np.asarray(traced, np.float32)


def receive(reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None = None) -> Record:
    """Turn traced echoes into a record.

    Parameters
    ----------
    reception : Reception
        From `make_reception`.
    traced : (n, 2, bins) float32 or (n, 2, bins * samples) complex128
        Intensity for an ideal pulse, or of interfering scatterers; the waves of these where `Reception.sums_waves`.
    pings : (n,) int64
        Ping numbers.
    divided : (n, 2, bins) float32, optional
        Intensity of the same echoes, each divided by the shape of its material's K speckle; the receiver's own shape
        holds for all when left out.

    Returns
    -------
    (n, 2, bins) float32
        Intensity as received; the traced array itself where nothing applies.
    """
    received = _sum_of_waves if reception.sums_waves else _echoes_alone
    record = received(reception, traced, pings, divided)
    if (reception.gain != 1.0).any():
        record = record * reception.gain.astype(np.float32)
    return record


def _echoes_alone(reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None) -> Record:
    """Record of echoes that meet no other waves; without speckle, mean energies add, those of the water as well."""
    record = np.asarray(traced, np.float32) if reception.coherent else _spread(reception, traced)
    if not reception.speckled and reception.reverberation.any():
        record = record + reception.reverberation.astype(np.float32)
    record = _delayed(reception, record, pings)
    if reception.speckle is not None:
        record = record * reception.speckle.factors(pings, _inverse_shape(reception, record, divided, pings))
    if reception.crosstalk > 0.0:
        record = record + np.float32(reception.crosstalk) * record[:, ::-1]
    if reception.fluctuation is not None:
        record = record * reception.fluctuation.gains(pings)
    if reception.source != 1.0:
        record = record * np.float32(reception.source)
    return record


def _sum_of_waves(reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None) -> Record:
    """Energy of the sum of the waves of echo, reverberation, crosstalk and noise, averaged over the looks."""
    record = np.zeros((pings.size, 2, reception.gain.size), np.float32)
    echo_waves = _echo_waves(reception, traced, pings, divided)
    reverberation, noise = _background(reception, pings)
    for look in range(reception.looks):
        waves = echo_waves(look)
        if reception.speckled and reception.crosstalk > 0.0:
            if reverberation is not None:
                reception.reverberation_field.add_to(waves, reverberation, pings, look)
            waves.leak(reception.crosstalk)
        if noise is not None:
            reception.noise_field.add_to(waves, noise, pings, look)
        waves.detect_into(record, 1.0 / reception.looks)
    return record


def _echo_waves(
    reception: Reception, traced: Traced, pings: NDArray[np.int64], divided: Traced | None
) -> Callable[[int], Waves]:
    """Waves of the echoes by the number of the look, at the level of the source."""
    if not reception.speckled:
        steady = steady_waves(_echoes_alone(reception, traced, pings, divided))
        return lambda look: steady
    level = _level(reception, pings)
    if reception.speckle is None:
        waves = split_waves(traced * np.sqrt(level))
        if reception.fluctuation is not None:
            waves = reception.fluctuation.shift_waves(waves, pings, reception.samples)
        return lambda look: waves
    speckle, record = reception.speckle, _delayed(reception, _spread(reception, traced), pings)
    mean = level * speckle.textured(record, pings, _inverse_shape(reception, record, divided, pings))

    def speckled(look: int) -> Waves:
        waves = no_waves(pings.size, mean.shape[2])
        speckle.field.add_to(waves, mean, pings, look)
        return waves

    return speckled


def _background(reception: Reception, pings: NDArray[np.int64]) -> tuple[Record | None, Record | None]:
    """Mean energies of the waves that add before and after crosstalk, (n or 1, 1, samples); None where there are none.

    Without crosstalk the water's waves and the noise, both Gaussian and new in every ping, are drawn as one.
    """
    water = _water_energy(reception, pings)
    noise = np.full((1, 1, reception.gain.size), reception.noise, np.float32) if reception.noise > 0.0 else None
    if water is not None and reception.crosstalk == 0.0:
        noise, water = water + np.float32(reception.noise), None
    return _sampled(water, reception.samples), _sampled(noise, reception.samples)


def _water_energy(reception: Reception, pings: NDArray[np.int64]) -> Record | None:
    """Mean energy of reverberation that is speckled, (n, 1, bins); None where there is none."""
    if not reception.speckled or not reception.reverberation.any():
        return None
    each = np.tile(reception.reverberation.astype(np.float32), (pings.size, 1, 1))
    return _level(reception, pings) * _delayed(reception, each, pings)


def _sampled(energy: Record | None, samples: int) -> Record | None:
    """Energies of bins, repeated for each of their samples."""
    return energy if energy is None or samples == 1 else np.repeat(energy, samples, axis=2)


def _level(reception: Reception, pings: NDArray[np.int64]) -> Record:
    """Factor of intensity by which source level and fluctuation raise every ping, (n or 1, 1, 1)."""
    source = np.full((1, 1, 1), reception.source, np.float32)
    return source if reception.fluctuation is None else source * reception.fluctuation.gains(pings)


def _inverse_shape(
    reception: Reception, record: Record, divided: Traced | None, pings: NDArray[np.int64]
) -> Record | None:
    """Mean of 1/ν over the echoes of a bin, weighted by their energy; None where the receiver's own ν holds."""
    if divided is None:
        return None
    weighted = _delayed(reception, _spread(reception, divided), pings)
    return np.divide(weighted, record, out=np.zeros_like(record), where=record > 0.0)


def _spread(reception: Reception, traced: Traced) -> Record:
    """Echoes spread by the pulse over range bins; ``traced`` itself for an ideal pulse."""
    return _convolved(reception.taps, np.asarray(traced, np.float32))


def _convolved(taps: Taps, traced: Record) -> Record:
    """Echoes spread by the taps over range bins; ``traced`` itself for one tap."""
    if taps.weights.size == 1:
        return traced
    record = np.zeros_like(traced)
    convolve_pulse(traced, taps.weights.astype(np.float32), taps.before, record)
    return record


def _delayed(reception: Reception, record: Record, pings: NDArray[np.int64]) -> Record:
    """Record with its pings delayed as they fluctuate."""
    return record if reception.fluctuation is None else reception.fluctuation.shifted(record, pings)
