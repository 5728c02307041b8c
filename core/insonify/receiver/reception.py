"""Receiver of a scene, prepared for any of its pings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.acoustics.pulses import Taps, coherent_taps, pulse_taps, samples_per_bin
from insonify.kernels.common.streams import AMBIENT_NOISE, REVERBERATION
from insonify.kernels.common.types import LIGHT, SceneArrays
from insonify.kernels.receiver.pulse import convolve_pulse
from insonify.receiver.disturbances import Disturbances, make_disturbances
from insonify.receiver.fluctuation import Fluctuation, make_fluctuation
from insonify.receiver.levels import crosstalk, noise_level, power, reverberation, time_varied_gain
from insonify.receiver.random_fields import WaveField, make_field
from insonify.receiver.recorder import Recording, make_recording
from insonify.receiver.speckle import Speckle, divide_by_shape, make_speckle
from insonify.receiver.volumes import VolumeEchoes, make_volume_echoes
from insonify.scene import Scene
from insonify.terrain import AnyGround
from insonify.tow.poses import bed_beneath, make_poses

Record = NDArray[np.float32]
Traced = NDArray[np.float32] | NDArray[np.complex128]
Curve = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reception:
    """The receiver of a scene, prepared for any of its pings."""

    taps: Taps  # energy that the pulse spreads over neighbouring bins
    reverberation: Curve  # (bins,) mean intensity of volume and surface reverberation
    # None where the scene has none; interfering scatterers are no speckle of the receiver's.
    fluctuation: Fluctuation | None
    speckle: Speckle | None
    # (materials, 3) reflectivities over the shape of each material's K speckle; None where the receiver's own
    # shape holds for all.
    divided_by_shape: Curve | None
    coherent: bool  # whether traced echoes already hold pulse and speckle, because single scatterers interfered
    samples: int  # samples of a bin at which waves are summed; 1 unless scatterers interfere
    crosstalk: float  # share of the energy of each channel that leaks into the other
    source: float  # source level as a factor of intensity
    noise: float  # mean intensity of the noise
    reverberation_field: WaveField  # waves of both, of mean energy 1
    noise_field: WaveField
    gain: Curve  # (bins,) time-varied gain
    # Schools and plumes, ringing and interference, and the recorder; None where the scene has none.
    volumes: VolumeEchoes | None
    disturbances: Disturbances | None
    recording: Recording | None

    @property
    def speckled(self) -> bool:
        """Whether echoes have phases, which a mean over all of them has not."""
        return self.coherent or self.speckle is not None

    @cached_property
    def sums_waves(self) -> bool:
        """Whether echoes meet waves of another origin, so that amplitudes add rather than energies."""
        others = self.crosstalk > 0.0 or self.disturbances is not None or self.water_echoes
        return self.noise > 0.0 or (self.speckled and others)

    @cached_property
    def amplifies(self) -> bool:
        """Whether the time-varied gain changes anything."""
        return bool((self.gain != 1.0).any())

    @cached_property
    def water_echoes(self) -> bool:
        """Whether the water column, its surface or anything in it echoes."""
        return self.volumes is not None or bool(self.reverberation.any())

    @property
    def looks(self) -> int:
        """Independent records averaged."""
        return 1 if self.speckle is None else self.speckle.looks

    def expected(self, echo: Curve) -> Curve:
        """Mean record of a uniform bed with the given echo of an ideal pulse, without reverberation, (bins,)."""
        return (echo * self.taps.weights.sum() * self.source + self.noise) * self.gain


def prepare_reception(scene: Scene, ground: AnyGround, arrays: SceneArrays) -> Reception:
    """Prepare the receiver of a scene for the height of its first ping."""
    first = np.zeros(1, dtype=np.int64)
    z = make_poses(scene, ground, first).z
    altitude = max(float((z - bed_beneath(scene, ground, first))[0]), arrays.bin_length)
    materials = (*ground.reflectivities, *(target.material.reflectivity for target in scene.targets))
    k_shapes = [material.speckle_shape for material in materials]
    volumes = make_volume_echoes(scene, arrays, ground)
    depth = -float(z[0] + ground.datum)
    return make_reception(scene, arrays, altitude=altitude, depth=depth, k_shapes=k_shapes, volumes=volumes)


def make_reception(
    scene: Scene,
    arrays: SceneArrays,
    *,
    altitude: float,
    depth: float,
    k_shapes: Sequence[float | None] = (),
    volumes: VolumeEchoes | None = None,
) -> Reception:
    """Prepare the receiver of a scene."""
    speed, pulse = arrays.water.reference, scene.sonar.pulse
    taps = pulse_taps(pulse, speed, arrays.bin_length)
    if arrays.law == LIGHT:
        # Law light: the radiance of the paper does not depend on the length of the pulse.
        taps = Taps(taps.weights / taps.weights.sum(), taps.before)
    coherent = scene.receiver.speckle.interferes
    samples = samples_per_bin(pulse, speed, arrays.bin_length) if coherent else 1
    source, noise = power(scene.receiver.source_level), noise_level(scene)
    echo = source * float(taps.weights.sum()) * flat_bed_curve(arrays, altitude)
    gain = time_varied_gain(scene, arrays, echo, noise, depth)
    water = reverberation(scene.receiver.reverberation, arrays, altitude, depth).astype(np.float32)
    return Reception(
        taps=taps,
        reverberation=spread_echoes(taps, water[None, None])[0, 0].astype(np.float64),
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
        gain=gain,
        volumes=volumes,
        disturbances=make_disturbances(scene, arrays, samples),
        recording=make_recording(scene, float(((echo + noise) * gain).max())),
    )


def _restless_field(scene: Scene, arrays: SceneArrays, stream: int, samples: int) -> WaveField:
    """Waves that the receiver's filter correlates along range and that are new in every ping.

    Whatever drifts by a quarter of the wavelength between pings returns another phase: 1 mm at 400 kHz.
    """
    taps = coherent_taps(scene.sonar.pulse, arrays.water.reference, arrays.bin_length / samples)
    return make_field(scene.seed, stream, taps, np.zeros(arrays.bins * samples))


def spread_echoes(taps: Taps, traced: Traced) -> Record:
    """Spread echoes over range bins by the taps of the pulse; for an ideal pulse they are returned as they are."""
    echoes = np.asarray(traced, np.float32)
    if taps.weights.size == 1:
        return echoes
    record = np.zeros_like(echoes)
    convolve_pulse(echoes, taps.weights.astype(np.float32), taps.before, record)
    return record
