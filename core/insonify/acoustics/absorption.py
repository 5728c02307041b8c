"""Absorption of sound in sea water."""

from __future__ import annotations

from insonify.scene.water.absorptions import NEPER_PER_DB, AbsorptionKind


def absorption_coefficient(absorption: AbsorptionKind, frequency: float, depth: float) -> float:
    """Amplitude absorption coefficient in Np/m at ``frequency`` (Hz) and ``depth`` (m)."""
    return absorption.decibels_per_km(frequency, depth) * NEPER_PER_DB / 1e3
