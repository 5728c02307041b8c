"""Pulse and beam of a sonar by the traces they leave in its record, where nothing declares them."""

from __future__ import annotations

import numpy as np

from insonify.inversion.footprint import footprint_of
from insonify.inversion.roughness_fit import fit_roughness
from insonify.inversion.segment_spectra import SegmentSpectra
from insonify.scene import Scene
from insonify.scene.edit import edit

WIDTHS = (0.2, 0.3, 0.4, 0.55, 0.75, 1.0, 1.4, 2.0)  # degrees, of beams that are tried
LEAST_CORRELATION = 0.01  # of neighbouring bins, below which they are independent
SHORTEST = 0.75  # of the highest frequency along the track, from which waves hold speckle alone


def estimate_pulse(spectra: SegmentSpectra, bin_length: float, sound_speed: float) -> dict[str, float | str]:
    """Pulse as plain values, by the correlation of speckle in neighbouring bins.

    Waves along the track that are hardly longer than the distance between pings hold speckle and little bed, least of
    all at steep angles. Two bins one bin length Δ apart share the part 1 − Δ/L of a tone with the resolution L = cτ/2,
    and their energies, and nearly their amplitudes, correlate as the square of it.
    """
    shortest = np.abs(spectra.along) >= SHORTEST * np.abs(spectra.along).max()
    lines = spectra.groups[-1].power[shortest].mean(axis=0)
    both = np.concatenate([lines, lines[-2:0:-1]])  # of both signs of the frequency
    correlation = float(np.fft.ifft(both)[1].real / np.fft.ifft(both)[0].real)
    if correlation < LEAST_CORRELATION:
        return {"kind": "ideal"}
    length = bin_length / (1.0 - min(np.sqrt(correlation), 0.95))
    return {"kind": "tone", "duration": float(f"{2.0 * length / sound_speed:.2g}")}


def estimate_beam(spectra: SegmentSpectra, scene: Scene, sound_speed: float) -> float:
    """Width of a Gaussian beam in degrees that best explains how a record averages its bed along the track."""
    costs, near = [], None
    for width in WIDTHS:
        trial = edit(scene, {"sonar.beam.kind": "gaussian", "sonar.beam.width": width})
        near = fit_roughness(spectra, footprint_of(trial, sound_speed), near=near)
        costs.append(near.cost)
    return WIDTHS[int(np.argmin(costs))]
