"""Receiver chain: pulse, reverberation, speckle, crosstalk, fluctuation, source level, noise and gain, in order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.acoustics.pulses import Taps, coherent_taps, pulse_taps
from insonify.kernels.common.streams import AMBIENT_NOISE
from insonify.kernels.common.types import LIGHT, SceneArrays
from insonify.kernels.receiver.pulse import convolve_pulse
from insonify.packing.navigation import bed_beneath, make_poses
from insonify.parallel import in_parallel
from insonify.receiver.fluctuation import Fluctuation, make_fluctuation
from insonify.receiver.levels import crosstalk, noise_level, power, reverberation, time_varied_gain
from insonify.receiver.random_fields import ExponentialField, make_field
from insonify.receiver.speckle import Speckle, divide_by_shape, make_speckle
from insonify.scene import Scene
from insonify.terrain import AnyGround

Record = NDArray[np.float32]
Curve = NDArray[np.float64]


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
        None where the scene has none.
    divided_by_shape : (materials, 3) float64 or None
        Reflectivities over the shape of each material's K speckle; None where the receiver's own shape holds for all.
    coherent : bool
        Whether traced intensities already hold pulse and speckle, because single scatterers interfered.
    crosstalk : float
        Share of the energy of each channel that leaks into the other.
    source : float
        Source level as a factor of intensity.
    noise : float
        Mean intensity of the noise.
    noise_field : ExponentialField
        Distribution of the noise about that mean.
    gain : (bins,) float64
        Time-varied gain.
    """

    taps: Taps
    reverberation: Curve
    fluctuation: Fluctuation | None
    speckle: Speckle | None
    divided_by_shape: Curve | None
    coherent: bool
    crosstalk: float
    source: float
    noise: float
    noise_field: ExponentialField
    gain: Curve

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
    coherent = coherent_taps(pulse, speed, arrays.bin_length)
    source, noise = power(scene.receiver.source_level), noise_level(scene)
    echo = source * float(taps.weights.sum()) * flat_bed_curve(arrays, altitude)
    water = reverberation(scene.receiver.reverberation, arrays, altitude, depth).astype(np.float32)
    return Reception(
        taps=taps,
        reverberation=_convolved(taps, water[None, None])[0, 0].astype(np.float64),
        fluctuation=make_fluctuation(scene, arrays),
        speckle=make_speckle(scene, arrays),
        divided_by_shape=divide_by_shape(scene, arrays, k_shapes),
        coherent=scene.receiver.speckle.interferes,
        crosstalk=crosstalk(scene),
        source=source,
        noise=noise,
        noise_field=make_field(scene.seed, AMBIENT_NOISE, coherent, np.zeros(arrays.bins)),
        gain=time_varied_gain(scene, arrays, echo, noise, depth),
    )


def record_echoes(
    reception: Reception, trace: Callable[[SceneArrays], Record], arrays: SceneArrays, pings: NDArray[np.int64]
) -> Record:
    """Trace pings and turn their echoes into a record.

    Parameters
    ----------
    reception : Reception
        From `make_reception`.
    trace : callable
        From a scene to the intensity of its echoes, (n, 2, bins).
    arrays : SceneArrays
        The scene. Where materials have K speckle of their own it is traced a second time, with every reflectivity
        divided by its material's shape: echoes are linear in the reflectivity, so that the ratio of both is the mean
        of 1/ν over the echoes of a bin.
    pings : (n,) int64
        Ping numbers.

    Returns
    -------
    (n, 2, bins) float32
        Intensity as received.
    """
    traced = trace(arrays)
    divided: Record | None = None
    if reception.divided_by_shape is not None:
        divided = trace(arrays._replace(reflectivity=reception.divided_by_shape))

    def block(first: int, last: int) -> Record:
        part = slice(first, last)
        return receive(reception, traced[part], pings[part], None if divided is None else divided[part])

    return np.concatenate(in_parallel(block, pings.size)) if pings.size else traced


def receive(reception: Reception, traced: Record, pings: NDArray[np.int64], divided: Record | None = None) -> Record:
    """Turn traced intensities into a record.

    Parameters
    ----------
    reception : Reception
        From `make_reception`.
    traced : (n, 2, bins) float32
        Intensity for an ideal pulse, or of interfering scatterers.
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
    record = _speckled(reception, traced, pings, divided)
    if reception.crosstalk > 0.0:
        record = record + np.float32(reception.crosstalk) * record[:, ::-1]
    if reception.fluctuation is not None:
        record = record * reception.fluctuation.gains(pings)
    if reception.source != 1.0:
        record = record * np.float32(reception.source)
    if reception.noise > 0.0:
        record = record + np.float32(reception.noise) * reception.noise_field.energies(pings)
    if (reception.gain != 1.0).any():
        record = record * reception.gain.astype(np.float32)
    return record


def _speckled(reception: Reception, traced: Record, pings: NDArray[np.int64], divided: Record | None) -> Record:
    """Record after pulse, reverberation and speckle, unless coherent scatterers hold pulse and speckle already."""
    if reception.coherent:
        return _interfered(reception, traced, pings)
    record = _delayed(reception, traced, pings)
    if reception.speckle is None:
        return record
    inverse_shape: Record | None = None
    if divided is not None:
        # Mean of 1/ν over the echoes of a bin, weighted by their energy.
        weighted = _delayed(reception, divided, pings, reception.speckle.inverse_shape)
        inverse_shape = np.divide(weighted, record, out=np.zeros_like(record), where=record > 0.0)
    return record * reception.speckle.factors(pings, inverse_shape)


def _interfered(reception: Reception, traced: Record, pings: NDArray[np.int64]) -> Record:
    """Add speckled reverberation to coherent echoes, then delay the pings."""
    record = traced
    if reception.speckle is not None and reception.reverberation.any():
        record = record + reception.reverberation.astype(np.float32) * reception.speckle.factors(pings)
    return record if reception.fluctuation is None else reception.fluctuation.shifted(record, pings)


def _convolved(taps: Taps, traced: Record) -> Record:
    """Echoes spread by the pulse over range bins; ``traced`` itself for an ideal pulse."""
    if taps.weights.size == 1:
        return traced
    record = np.zeros_like(traced)
    convolve_pulse(traced, taps.weights.astype(np.float32), taps.before, record)
    return record


def _delayed(reception: Reception, traced: Record, pings: NDArray[np.int64], share: float = 1.0) -> Record:
    """Convolve echoes with the pulse, add a share of the reverberation, delay the pings."""
    record = _convolved(reception.taps, traced)
    if reception.reverberation.any():
        record = record + (share * reception.reverberation).astype(np.float32)
    return record if reception.fluctuation is None else reception.fluctuation.shifted(record, pings)
