"""Amplifier and converter of the recorder: gains, full scale, bits, lost pings."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from insonify.arrays import Floats
from insonify.kernels.common.streams import DROPPED_PINGS
from insonify.kernels.receiver.foreign_pings import fill_uniform
from insonify.receiver.levels import SMALLEST, time_varied_gain
from insonify.receiver.stage import ReceiverSetup, Sound, Stage, power
from insonify.scene.receiver.recorder import Recorder

LARGEST = float(np.finfo(np.float32).max)


@dataclass(frozen=True, eq=False)
class Recording(Stage):
    """Gain of the last amplifier, clipping, rounding and lost pings."""

    name, detail, rank = "recorder", "gain, full scale and rounding", 100.0
    seed: int  # of the scene
    times: Floats  # (k,) from which the gains apply, in seconds after the first ping
    gains: Floats  # (k,) factors of intensity
    sides: Floats  # (2,) factors of intensity of port and starboard
    full_scale: float  # greatest intensity that is recorded
    step: float  # step of the recorded amplitudes; 0 where nothing is rounded
    dropped: float  # share of the pings that are lost
    ping_rate: float  # pings per second

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None for a recorder that changes nothing."""
        scene, declared = setup.scene, setup.scene.receiver.recorder
        if declared == Recorder():
            return None
        times, gains = np.array(declared.gain_steps).T
        full_scale = LARGEST if declared.full_scale is None else power(declared.full_scale)
        step = 0.0
        if declared.bits != "float":
            steps = 2**declared.bits - 1
            step = math.sqrt(full_scale) / steps
            if declared.full_scale is None:
                loudest = float(((setup.level_bed + setup.noise) * time_varied_gain(setup)).max())
                step = 2.0 ** math.ceil(math.log2(math.sqrt(max(loudest, SMALLEST)) / steps))
                full_scale = (steps * step) ** 2
        return cls(
            seed=scene.seed,
            times=times,
            gains=10.0 ** (gains / 10.0),
            sides=10.0 ** (np.array([0.5, -0.5]) * declared.side_gain / 10.0),
            full_scale=full_scale,
            step=step,
            dropped=declared.dropped_pings,
            ping_rate=scene.sonar.ping_rate,
        )

    def act_on_energies(self, sound: Sound) -> None:
        """Record the intensities."""
        setting = np.maximum(np.searchsorted(self.times, sound.pings / self.ping_rate, side="right") - 1, 0)
        amplified = sound.energy * (self.gains[setting, None, None] * self.sides[:, None])
        kept = np.minimum(amplified, self.full_scale)
        if self.step > 0.0:
            # The envelope is converted, so amplitudes are rounded and not intensities.
            kept = (np.rint(np.sqrt(kept) / self.step) * self.step) ** 2
        if self.dropped > 0.0:
            chance = np.empty(sound.pings.size)
            fill_uniform(self.seed, DROPPED_PINGS, sound.pings, chance)
            kept[chance < self.dropped] = 0.0
        sound.energy = kept.astype(np.float32)
