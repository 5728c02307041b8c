"""Receiver of a scene, prepared for any of its pings: traced echoes pass its stages and become a record.

Theory: docs/theory/speckle.md.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from insonify.acoustics.pulses import Taps
from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.streams import AMBIENT_NOISE
from insonify.kernels.common.types import SceneArrays
from insonify.parallel import in_parallel
from insonify.receiver.speckle import Speckle
from insonify.receiver.stage import DETECTION, PHASES, ReceiverSetup, Sound, Stage, Traced, spread_echoes, stage_kinds
from insonify.receiver.waves import WaveField, Waves, no_waves
from insonify.scene import Scene
from insonify.terrain import AnyGround
from insonify.tow.poses import bed_beneath, make_poses

PINGS_TOGETHER = 64  # pings received at a time, so that intermediate arrays stay in the processor cache
AnyStage = TypeVar("AnyStage", bound=Stage)


@dataclass(frozen=True, eq=False)
class Reception:
    """The receiver of a scene."""

    taps: Taps  # energy that the pulse spreads over neighbouring bins
    bins: int
    stages: tuple[Stage, ...]  # in the order in which they act; only those that change the record
    background_field: WaveField  # waves of the background at detection, of mean energy 1

    def find(self, kind: type[AnyStage]) -> AnyStage | None:
        """Stage of a kind, None where the scene has none."""
        return next((stage for stage in self.stages if isinstance(stage, kind)), None)

    @cached_property
    def coherent(self) -> bool:
        """Whether traced echoes already hold pulse and speckle, because single scatterers interfered."""
        return any(stage.coherent for stage in self.stages)

    @cached_property
    def phased(self) -> bool:
        """Whether echoes have phases, which a mean over all of them has not."""
        return any(stage.phased for stage in self.stages)

    @cached_property
    def sums_waves(self) -> bool:
        """Whether echoes with phases meet waves of another origin, so that amplitudes add rather than energies."""
        return self.phased and any(stage.adds_waves for stage in self.stages)

    @cached_property
    def divided_by_shape(self) -> Floats | None:
        """Reflectivities, (materials, 3), of a second trace from which K speckle gets its shape in every bin."""
        speckle = self.find(Speckle)
        return None if speckle is None else speckle.divided_by_shape

    @cached_property
    def gain(self) -> Floats:
        """Factor by which all stages raise a mean echo, (bins,)."""
        gain = np.ones(self.bins)
        for stage in self.stages:
            gain = gain * stage.gain
        return gain

    def expected(self, echo: Floats) -> Floats:
        """Mean record of a uniform bed with the given echo of an ideal pulse, without reverberation, (bins,)."""
        mean = echo * self.taps.weights.sum()
        for stage in self.stages:
            mean = mean * stage.gain + stage.added
        return mean


def prepare_setup(scene: Scene, ground: AnyGround, arrays: SceneArrays) -> ReceiverSetup:
    """Gather what the stages of a receiver are prepared from, for the height of a scene's first ping."""
    first = np.zeros(1, dtype=np.int64)
    z = make_poses(scene, ground, first).z
    altitude = max(float((z - bed_beneath(scene, ground, first))[0]), arrays.bin_length)
    materials = (*ground.reflectivities, *(target.material.reflectivity for target in scene.targets))
    k_shapes = [material.speckle_shape for material in materials]
    depth = -float(z[0] + ground.datum)
    return ReceiverSetup(scene, arrays, altitude, depth, k_shapes, ground)


def assemble(setup: ReceiverSetup) -> Reception:
    """Receiver with the stages that change the record."""
    prepared = (kind.prepare(setup) for kind in stage_kinds())
    stages = tuple(stage for stage in prepared if stage is not None)
    return Reception(setup.taps, setup.arrays.bins, stages, setup.field_of(AMBIENT_NOISE))


def record_echoes(
    reception: Reception, traced: Traced, pings: Integers, divided: Traced | None = None, out: Singles | None = None
) -> Singles:
    """Turn traced echoes into a record; ``divided`` is the trace with ``reception.divided_by_shape``, if it has one."""
    if out is not None:
        record = out
    elif np.iscomplexobj(traced):
        record = np.empty((*traced.shape[:2], reception.bins), np.float32)
    else:
        record = np.asarray(traced, np.float32)

    def block(first: int, last: int) -> None:
        for low in range(first, last, PINGS_TOGETHER):
            part = slice(low, min(low + PINGS_TOGETHER, last))
            echoes = traced[part]
            received = receive(reception, echoes, pings[part], None if divided is None else divided[part])
            if received is not echoes or record is not traced:
                record[part] = received

    in_parallel(block, pings.size)
    return record


def receive(reception: Reception, traced: Traced, pings: Integers, divided: Traced | None = None) -> Singles:
    """Turn the traced echoes of a block of pings into its record."""
    stages, sums_waves = reception.stages, reception.sums_waves
    sound = _take_in(reception, traced, pings, divided)
    for stage in stages:
        if stage.rank < DETECTION and (stage.rank <= PHASES or not sums_waves):
            stage.act_on_energies(sound)
    if sums_waves:
        sound.energy = _detect_waves(reception, sound)
    else:
        sound.apply_factors()
        if sound.background is not None:
            sound.waves = Waves(np.sqrt(sound.energy), np.zeros_like(sound.energy))  # all of one phase
            sound.energy = np.zeros((pings.size, 2, reception.bins), np.float32)
            sound.draw_background(reception.background_field)
            sound.waves.detect_into(sound.energy)
    for stage in stages:
        if stage.rank >= DETECTION:
            stage.act_on_energies(sound)
    return sound.energy


def _take_in(reception: Reception, traced: Traced, pings: Integers, divided: Traced | None) -> Sound:
    """Sound of traced echoes after the pulse."""
    weighted = None if divided is None else spread_echoes(reception.taps, divided)
    waves = np.asarray(traced, np.complex128) if reception.coherent and reception.sums_waves else None
    if waves is not None:
        energy = np.zeros((pings.size, 2, 0), np.float32)
    elif reception.coherent:
        energy = np.asarray(traced, np.float32)
    else:
        energy = spread_echoes(reception.taps, traced)
    return Sound(pings, energy, weighted, reception.phased, reception.sums_waves, waves)


def _detect_waves(reception: Reception, sound: Sound) -> Singles:
    """Energy of the sum of all waves that are received, averaged over the looks, (n, 2, bins)."""
    record = np.zeros((sound.pings.size, 2, reception.bins), np.float32)
    background, traced = sound.background, sound.waves if reception.coherent else None
    speckle = reception.find(Speckle)
    looks = 1 if speckle is None else speckle.looks
    for look in range(looks):
        sound.look, sound.background = look, background
        sound.waves = traced or no_waves(sound.pings.size, reception.bins)
        for stage in reception.stages:
            if PHASES <= stage.rank < DETECTION:
                stage.act_on_waves(sound)
        sound.draw_background(reception.background_field)
        sound.waves.detect_into(record, 1.0 / looks)
    return record
