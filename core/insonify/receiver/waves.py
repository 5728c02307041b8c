"""Waves of a block of pings: complex amplitudes that add before the receiver detects their energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.speckle.random_fields import add_detected

Record = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Waves:
    """Complex amplitudes, whose squared moduli are intensities."""

    real: Record  # (n, 2, bins * samples) of pings, port and starboard; changed in place
    imaginary: Record

    def add(self, energy: Record, turns: Record) -> None:
        """Add waves of given energies and phases (turns), (n or 1, 2 or 1, columns)."""
        amplitude, phase = np.sqrt(energy), np.float32(2.0 * np.pi) * turns
        np.add(self.real, amplitude * np.cos(phase), out=self.real)
        np.add(self.imaginary, amplitude * np.sin(phase), out=self.imaginary)

    def leak(self, share: float) -> None:
        """Add to each side the other side's waves, with a share of their energy."""
        for part in (self.real, self.imaginary):
            part += np.float32(np.sqrt(share)) * part[:, ::-1]

    def detect_into(self, record: Record, share: float = 1.0) -> None:
        """Add a share of the energy of every bin, the mean over its samples, to a record (n, 2, bins)."""
        add_detected(self.real, self.imaginary, self.real.shape[2] // record.shape[2], np.float32(share), record)


def no_waves(pings: int, columns: int) -> Waves:
    """Waves of amplitude 0."""
    return Waves(*np.zeros((2, pings, 2, columns), np.float32))


def steady_waves(energy: Record) -> Waves:
    """Waves of given energies, all of one phase."""
    return Waves(np.sqrt(energy), np.zeros_like(energy))


def split_waves(traced: NDArray[np.inexact]) -> Waves:
    """Waves of complex amplitudes."""
    return Waves(*(np.ascontiguousarray(part, dtype=np.float32) for part in (traced.real, traced.imag)))
