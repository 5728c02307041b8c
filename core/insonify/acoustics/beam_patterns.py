"""Beams as tables: how sensitive the sonar is by direction, there and back."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import EVERY_GRAZING, GAUSSIAN, TOP_HAT, BeamPattern, plain_pattern
from insonify.scene import Scene
from insonify.scene.beams.fan import FanBeam
from insonify.scene.beams.gaussian import GaussianBeam
from insonify.scene.beams.knife import KnifeBeam
from insonify.scene.beams.line_array import LineArray
from insonify.scene.sonar import Sonar
from insonify.scene.vertical_beams.fan import VerticalFan
from insonify.scene.vertical_beams.gaussian import VerticalGaussian

COLUMNS = 2049
FAINT = 1e-6  # sensitivity at which a Gaussian beam ends
EDGE = 0.02  # sensitivity at which its main lobe does
ELEMENTS = 1024  # of a line array, as its pattern is computed
ROWS_PER_OCTAVE = 4.0
# Lobes heard on either hand of an array's main lobe, in steps of wavelength over length; beyond lies less than 0.5 %.
LOBES = {True: 6.0, False: 32.0}
# Half the main lobe of each taper to its first null, in the same steps.
FIRST_NULL = {"uniform": 1.0, "cosine": 1.5, "hamming": 2.0, "taylor": 1.36}
TAYLOR_SIDELOBES, TAYLOR_NEARLY_EQUAL = 30, 4  # dB, and how many of them are nearly equal
TILTING = {"pitch", "roll", "recorded"}  # motions in which a fish does not stay level
FAR = 0.4  # share of the range at which an array's main lobe is taken to be as wide as there


def make_pattern(scene: Scene, sound_speed: float) -> tuple[float, BeamPattern]:
    """Pack a scene's beam for the tracers.

    Parameters
    ----------
    scene : Scene
        Its sonar and motion apply.
    sound_speed : float
        At the sonar, in m/s.

    Returns
    -------
    half_width : float
        Of a top-hat, or half of what the main lobe spans, in radians; 0 for a knife.
    Pattern
        Not tabled where a level top-hat or knife that hears every grazing angle is all there is.
    """
    sonar = scene.sonar
    beam = sonar.beam
    half_width = main_lobe(sonar, sound_speed)
    if not is_patterned(scene):
        return half_width, plain_pattern()
    centre = 0.0 if isinstance(beam, KnifeBeam) else math.sin(math.radians(beam.squint))  # type: ignore[attr-defined]
    if isinstance(beam, LineArray):
        first_range, extent, energy = array_table(beam, sound_speed / sonar.frequency, sonar.range)
    else:
        first_range, extent, energy = 1.0, *_one_row(beam, half_width)  # type: ignore[arg-type]
    vertical, tilt, s_vertical = _vertical(sonar)
    return half_width, BeamPattern(
        tabulated=True,
        centre=centre,
        extent=extent,
        energy=energy,
        integral=_integral(extent, energy),
        first_range=first_range,
        per_octave=ROWS_PER_OCTAVE,
        vertical=vertical,
        tilt=tilt,
        s_vertical=s_vertical,
        two_way=not isinstance(beam, (GaussianBeam, LineArray)) or beam.two_way,
    )


def is_patterned(scene: Scene) -> bool:
    """Tell a beam that must be tabled from a level top-hat or knife that hears every grazing angle alike."""
    beam = scene.sonar.beam
    aimed = not isinstance(beam, KnifeBeam) and beam.squint != 0.0  # type: ignore[attr-defined]
    tilts = not isinstance(beam, KnifeBeam) and bool(TILTING.intersection(scene.track.kinds))
    is_vertical = isinstance(scene.sonar.vertical, (VerticalFan, VerticalGaussian))
    return not isinstance(beam, (KnifeBeam, FanBeam)) or aimed or tilts or is_vertical


def main_lobe(sonar: Sonar, sound_speed: float) -> float:
    """Half of what a beam's main lobe spans, in radians: a top-hat's half width; 0 for a knife.

    A long array's beam is nearly as wide as the array is long within its near field, r < L²/λ.
    """
    beam = sonar.beam
    if isinstance(beam, FanBeam):
        return math.radians(beam.width) / 2.0
    if isinstance(beam, GaussianBeam):
        times = math.sqrt(math.log2(1.0 / EDGE) / _passes(beam.two_way))
        return math.asin(min(math.sin(math.radians(beam.width) / 2.0) * times, 1.0))
    if isinstance(beam, LineArray):
        far = FIRST_NULL[beam.taper] * sound_speed / sonar.frequency / beam.length
        near = 0.5 * beam.length / (FAR * sonar.range)
        return math.asin(min(max(far, near + 0.5 * far), 1.0))
    return 0.0


def _passes(two_way: bool) -> float:
    return 2.0 if two_way else 1.0


def _one_row(beam: KnifeBeam | FanBeam | GaussianBeam, half_width: float) -> tuple[NDArray[np.float64], ...]:
    """Extent and sensitivity of a beam that is the same at every range."""
    if isinstance(beam, GaussianBeam):
        # b = 2^(−(2φ/w)²) falls to a half at half the width.
        s_three_decibels, passes = math.sin(math.radians(beam.width) / 2.0), _passes(beam.two_way)
        extent = min(s_three_decibels * math.sqrt(math.log2(1.0 / FAINT) / passes), 1.0)
        s = np.linspace(-extent, extent, COLUMNS)
        return np.array([extent]), np.exp2(-passes * (s / s_three_decibels) ** 2)[None, :]
    extent = max(math.sin(half_width), 1e-9)  # a knife has none, but a row spans something
    return np.array([extent]), np.ones((1, COLUMNS))


def _integral(extent: NDArray[np.float64], energy: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integrate every row over s from its beginning, by trapezia."""
    step = 2.0 * extent[:, None] / (energy.shape[1] - 1)
    sums = np.cumsum(0.5 * (energy[:, 1:] + energy[:, :-1]) * step, axis=1)
    return np.concatenate([np.zeros((extent.size, 1)), sums], axis=1)


def array_table(
    beam: LineArray, wavelength: float, reach: float
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Sensitivity of a line array by range and direction.

    Parameters
    ----------
    beam : LineArray
        Length, taper and passes.
    wavelength : float
        Metres.
    reach : float
        Greatest slant range, in metres.

    Returns
    -------
    first_range : float
        Slant range of the first row, in metres.
    extent : (rows,) float64
        Half of what each row spans, as sine.
    energy : (rows, COLUMNS) float64
        |∫ w(u) exp(−ik(us − u²/2r)) du|², Fresnel's approximation about the array's middle, the square of it
        for two ways; 1 on the axis far away.
    """
    from scipy.signal import czt  # takes longer to import than a preview takes to trace

    length, first_range = beam.length, beam.length
    # Beyond some ten times L²/λ the waves are flat.
    farthest = max(min(reach, 16.0 * length * length / wavelength), 2.0 * first_range)
    rows = 1 + math.ceil(ROWS_PER_OCTAVE * math.log2(farthest / first_range))
    ranges = first_range * 2.0 ** (np.arange(rows) / ROWS_PER_OCTAVE)
    extent = np.minimum(0.5 * length / ranges + LOBES[beam.two_way] * wavelength / length, 1.0)
    weights = _taper(beam.taper)
    weights = weights / weights.sum()
    place = ((np.arange(ELEMENTS) + 0.5) / ELEMENTS - 0.5) * length
    wave_number = 2.0 * math.pi / wavelength
    energy = np.empty((rows, COLUMNS))
    for row in range(rows):
        curved = weights * np.exp(0.5j * wave_number * place**2 / ranges[row])
        step = wave_number * (place[1] - place[0]) * 2.0 * extent[row] / (COLUMNS - 1)
        start = wave_number * (place[1] - place[0]) * extent[row]
        field = czt(curved, COLUMNS, np.exp(-1j * step), np.exp(-1j * start))
        energy[row] = np.abs(field) ** (2.0 * _passes(beam.two_way))
    return first_range, extent, energy


def _taper(name: str) -> NDArray[np.float64]:
    """Weights of the elements of an array."""
    u = (np.arange(ELEMENTS) + 0.5) / ELEMENTS - 0.5
    if name == "cosine":
        return np.cos(np.pi * u)
    if name == "hamming":
        return 0.54 + 0.46 * np.cos(2.0 * np.pi * u)
    if name == "taylor":
        from scipy.signal.windows import taylor

        return np.asarray(taylor(ELEMENTS, TAYLOR_NEARLY_EQUAL, TAYLOR_SIDELOBES, norm=False))
    return np.ones(ELEMENTS)


def _vertical(sonar: Sonar) -> tuple[int, float, float]:
    """Kind, tilt and sine of half the width of the vertical beam."""
    vertical = sonar.vertical
    if isinstance(vertical, (VerticalFan, VerticalGaussian)):
        kind = TOP_HAT if isinstance(vertical, VerticalFan) else GAUSSIAN
        return kind, math.radians(vertical.tilt), math.sin(math.radians(vertical.width) / 2.0)
    return EVERY_GRAZING, 0.0, 1.0
