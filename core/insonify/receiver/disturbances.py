"""Waves with a given course in time that are not echoes: ringing after transmission and pings of another sonar."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np

from insonify.arrays import Integers, Singles
from insonify.kernels.common.streams import INTERFERENCE
from insonify.kernels.receiver.foreign_pings import Timing, fill_foreign_pings
from insonify.receiver.stage import ReceiverSetup, Sound, Stage, power


@dataclass(frozen=True, eq=False)
class OtherWaves(Stage):
    """Ringing and interference of a scene; both sides receive them alike."""

    name, detail, rank = "other waves", "ringing and interference", 70.0
    adds_waves = True
    seed: int  # of the scene
    ringing: Singles | None  # (1, 1, columns) intensity of the ringing in every bin, or in every sample of a bin
    interference: float  # intensity of the other sonar's pings, 0 where there is none
    timing: Timing  # when bins are received and when the other sonar pings
    columns: int  # bins, or samples of all bins

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where neither is declared."""
        scene, arrays, samples = setup.scene, setup.arrays, setup.samples
        bin_time, columns = 2.0 * arrays.bin_length / arrays.water.reference / samples, arrays.bins * samples
        declared, foreign, ringing = scene.receiver.ringing, scene.receiver.interference, None
        if declared is None and foreign is None:
            return None
        if declared is not None:
            level = declared.decibels((np.arange(columns, dtype=np.float64) + 0.5) * np.float64(bin_time))
            ringing = 10.0 ** ((level + scene.receiver.source_level) / 10.0)
        interval, duration = (1.0, 0.0) if foreign is None else (1.0 / foreign.ping_rate, foreign.duration)
        return cls(
            seed=scene.seed,
            ringing=None if ringing is None else ringing.astype(np.float32)[None, None],
            interference=0.0 if foreign is None else power(foreign.level),
            timing=Timing(1.0 / scene.sonar.ping_rate, bin_time, interval, min(duration, interval)),
            columns=columns,
        )

    def act_on_energies(self, sound: Sound) -> None:
        """Add the energies."""
        sound.apply_factors()
        for energy, _ in self._waves(sound.pings):
            sound.energy = sound.energy + energy

    def act_on_waves(self, sound: Sound) -> None:
        """Add the waves."""
        for energy, turns in self._waves(sound.pings):
            sound.waves.add(energy, turns)

    def _waves(self, pings: Integers) -> Iterator[tuple[Singles, Singles]]:
        """Yield intensity and phase (turns) of each wave, (n or 1, 1, columns)."""
        if self.ringing is not None:
            yield self.ringing, np.zeros_like(self.ringing)
        if self.interference > 0.0:
            share, turns = np.empty((2, pings.size, self.columns), np.float32)
            fill_foreign_pings(self.seed, INTERFERENCE, pings, self.timing, share, turns)
            yield np.float32(self.interference) * share[:, None], turns[:, None]
