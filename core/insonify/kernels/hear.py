"""Tell, along a profile walked outward from nadir with one running horizon, what is heard and how loud.

Every pass touches few arrays, so that the compiler can use its vector units.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.bins import FIXED_POINT
from insonify.kernels.jit import bare
from insonify.kernels.pieces import FINE
from insonify.kernels.scatter import INVERSE_PI, gloss
from insonify.kernels.types import EVERY_GRAZING, LIGHT
from insonify.kernels.wedge import FADING, pattern_width, strip_width, vertical_weight, weight

NADIR = -1e30  # slope of a ray straight down


class Heard(NamedTuple):
    """Work space of one profile; one entry a knot, or a segment."""

    r: NDArray[np.float64]  # slant range of the knots, m
    launch: NDArray[np.float32]  # tan of the launch angle above the horizontal, knots
    horizon: NDArray[np.float32]  # greatest launch slope so far, knots
    weight: NDArray[np.float32]  # what the plane stands for there, knots
    cos_squared: NDArray[np.float32]  # of the incidence, segments
    scale: NDArray[np.float32]  # what turns a scattering strength into energy per bin, segments
    energy: NDArray[np.float32]  # per bin in fixed-point units, of segments heard whole
    power: NDArray[np.float32]  # work space of the Phong lobe, segments
    base: NDArray[np.float32]  # likewise
    cut: NDArray[np.bool_]  # segments heard in part, or too long for one density
    early: NDArray[np.int64]  # step of the density at a knot: what its own bin takes
    late: NDArray[np.int64]  # and what the next bin takes


def empty_heard(capacity: int) -> Heard:
    """Make room for profiles of up to ``capacity`` knots."""
    launch, horizon, weight, cos_squared, scale, energy, power, base = np.zeros((8, capacity), np.float32)
    r, cut = np.zeros(capacity), np.zeros(capacity, np.bool_)
    early, late = np.zeros((2, capacity), np.int64)
    return Heard(r, launch, horizon, weight, cos_squared, scale, energy, power, base, cut, early, late)


@bare
def hear(profile, count, problem, wedge, hidden_from, hidden_to, heard):
    """Tell which segments of a profile are heard whole, and how loud, and which must be cut first.

    Targets may hide the bed between the launch slopes ``hidden_from`` and ``hidden_to``; segments that meet them are
    cut.
    """
    x, z, slope, area, segments = profile.x, profile.z, profile.slope, profile.area, count - 1
    _slant_ranges(count, x, z, heard.r)
    _launch_slopes(count, x, z, heard.launch)
    _horizons(count, heard.launch, heard.horizon)
    _incidences(segments, x, z, slope, area, heard.r, heard.cos_squared)
    if problem.law == LIGHT:
        _light_scales(segments, heard.r, heard.scale)
        _light_energies(segments, heard.cos_squared, heard.scale, heard.energy)
    else:
        _sonar_scales(segments, x, area, heard.r, problem.bin_length, heard.scale)
        _sonar_energies(segments, heard.cos_squared, heard.scale, heard.energy)
    if wedge.angle > 0.0 or wedge.tabled or wedge.bent:
        weigh(x[:count], z, heard.r, wedge, problem.pattern, problem.law, heard.weight)
        if wedge.bent and problem.law != LIGHT:
            _amplify(count, profile.gain, heard.weight)
        _multiply(segments, heard.weight, heard.scale, heard.energy)
    _colour(segments, profile.material, problem.reflectivity, problem.bed.mapped, heard.energy)
    _add_gloss(segments, profile.material, problem.reflectivity, problem.bed.mapped, problem.law, heard)
    _mark_cut(segments, x, slope, area, heard.r, heard.launch, heard.horizon, hidden_from, hidden_to, heard.cut)
    _silence(segments, heard.launch, heard.horizon, heard.cut, heard.energy)


@bare
def _slant_ranges(count, x, z, r):
    for i in range(count):
        r[i] = math.sqrt(x[i] * x[i] + z[i] * z[i])


@bare
def _launch_slopes(count, x, z, launch):
    for i in range(count):
        launch[i] = np.float32(z[i]) / np.float32(x[i])
    if x[0] <= 0.0 and z[0] == z[0]:
        launch[0] = NADIR  # straight down, whatever the knot's height


@bare
def _horizons(count, launch, horizon):
    highest = np.float32(NADIR)
    for i in range(count):
        # NaN, a hole in the bed, compares false and hides nothing.
        highest = launch[i] if launch[i] > highest else highest
        horizon[i] = highest


@bare
def _incidences(segments, x, z, slope, area, r, cos_squared):
    """Cosine squared of the incidence at the middle, from the height of the segment's line over nadir."""
    for i in range(segments):
        offset = np.float32(z[i] - slope[i] * x[i])
        middle = np.float32(0.5 * (r[i] + r[i + 1]))
        cos_squared[i] = offset * offset / (middle * middle * area[i])


@bare
def _light_scales(segments, r, scale):
    """Law `light`: a bin takes the radiance itself; negative where a segment comes nearer outwards."""
    for i in range(segments):
        scale[i] = FIXED_POINT if r[i + 1] >= r[i] else -FIXED_POINT


@bare
def _light_energies(segments, cos_squared, scale, energy):
    for i in range(segments):
        energy[i] = math.sqrt(cos_squared[i]) * scale[i]


@bare
def _sonar_scales(segments, x, area, r, bin_length, scale):
    """Law `sonar`: area over slant range, of a strip 1 m wide; negative where a segment comes nearer outwards."""
    unit = np.float32(FIXED_POINT * bin_length)
    for i in range(segments):
        scale[i] = unit * math.sqrt(area[i]) * np.float32(x[i + 1] - x[i]) / np.float32(r[i + 1] - r[i])


@bare
def _sonar_energies(segments, cos_squared, scale, energy):
    for i in range(segments):
        energy[i] = cos_squared[i] * (np.float32(INVERSE_PI) * scale[i])


@bare
def weigh(x, z, r, wedge, pattern, law, out):
    """Tell what the plane stands for at each knot."""
    if wedge.angle == 0.0 and not wedge.tabled:
        for i in range(x.size):
            out[i] = 1.0  # a knife
        return
    if law == LIGHT or wedge.angle == 0.0:
        for i in range(x.size):
            out[i] = weight(x[i], z[i], r[i], wedge, pattern, law)
        return
    if wedge.tabled:
        parts = pattern.centre, pattern.extent, pattern.integral, pattern.first_range, pattern.per_octave
        _weigh_pattern(x, z, r, wedge, *parts, out)
        if pattern.vertical != EVERY_GRAZING:
            for i in range(x.size):
                out[i] *= vertical_weight(x[i] / r[i], z[i] / r[i], wedge, pattern)
        return
    # As `strip_width` has it, near, between and far apart for the vector units.
    near = min(np.searchsorted(x, wedge.near_field, side="right"), x.size)
    far = min(np.searchsorted(x, wedge.near_field * (1.0 + FADING), side="right"), x.size)
    for i in range(far, x.size):
        out[i] = r[i] * wedge.far_angle
    if wedge.s_high <= wedge.s_beam:
        for i in range(near):
            out[i] = x[i] * wedge.angle
        per_metre = 1.0 / (FADING * wedge.near_field)
        for i in range(near, far):
            width = x[i] * wedge.angle
            out[i] = width + (x[i] - wedge.near_field) * per_metre * (r[i] * wedge.far_angle - width)
        return
    for i in range(far):
        out[i] = strip_width(x[i], r[i], wedge)


@bare
def _weigh_pattern(x, z, r, wedge, centre, extent, integral, first_range, per_octave, out):
    for i in range(x.size):
        out[i] = pattern_width(x[i], z[i], r[i], wedge, centre, extent, integral, first_range, per_octave)


@bare
def _amplify(count, gain, weights):
    for i in range(count):
        weights[i] *= gain[i]


@bare
def _multiply(segments, weights, scale, energy):
    """Apply the mean weight of each segment's two knots."""
    half = np.float32(0.5)
    for i in range(segments):
        factor = half * (weights[i] + weights[i + 1])
        scale[i] *= factor
        energy[i] *= factor


@bare
def _colour(segments, material, reflectivity, mapped, energy):
    """Apply the diffuse share of each segment's material."""
    if mapped:
        for i in range(segments):
            energy[i] *= reflectivity[material[i], 0]
    else:
        diffuse = np.float32(reflectivity[material[0], 0])
        for i in range(segments):
            energy[i] *= diffuse


@bare
def _add_gloss(segments, material, reflectivity, mapped, law, heard):
    """Add the Phong lobe, which is gone past 45 degrees of incidence."""
    specular, shininess = reflectivity[material[0], 1], reflectivity[material[0], 2]
    if not mapped and shininess == math.floor(shininess):
        if specular > 0.0:
            count = segments
            while count > 0 and not heard.cos_squared[count - 1] > 0.5:
                count -= 1
            share = specular * (1.0 if law == LIGHT else (shininess + 2.0) * (0.5 * INVERSE_PI))
            _mirrored(count, heard.cos_squared, law, heard.power, heard.base)
            _raise(count, heard.base, int(shininess), heard.power)
            _add_product(count, heard.power, heard.scale, share, heard.energy)
        return
    for i in range(segments):
        if heard.cos_squared[i] > 0.5:
            row = material[i]
            shine = gloss(heard.cos_squared[i], reflectivity[row, 1], reflectivity[row, 2], law)
            heard.energy[i] += heard.scale[i] * shine


@bare
def _mirrored(segments, cos_squared, law, power, base):
    """Prepare the base of the lobe, max(0, cos 2α), and the factor it multiplies."""
    for i in range(segments):
        mirrored = cos_squared[i] + cos_squared[i] - np.float32(1.0)
        base[i] = mirrored if mirrored > 0 else np.float32(0.0)
        power[i] = np.float32(1.0) if law == LIGHT else cos_squared[i]


@bare
def _raise(segments, base, exponent, power):
    """Multiply ``power`` by base to a whole exponent, by repeated squaring; overwrites the base."""
    while exponent > 0:
        if exponent & 1:
            for i in range(segments):
                power[i] *= base[i]
        for i in range(segments):
            base[i] *= base[i]
        exponent >>= 1


@bare
def _add_product(segments, power, scale, share, energy):
    for i in range(segments):
        energy[i] += power[i] * scale[i] * np.float32(share)


@bare
def _mark_cut(segments, x, slope, area, r, launch, horizon, hidden_from, hidden_to, cut):
    """Segments in sight that are not heard as one piece of one density.

    A segment whose slant range hardly changes is near the foot of its perpendicular, where the density is uneven.
    """
    for i in range(segments):
        dx, dr = x[i + 1] - x[i], abs(r[i + 1] - r[i])
        length_squared = dx * dx * (1.0 + slope[i] * slope[i])
        uneven = (length_squared > dr * r[i]) | (length_squared > (FINE * FINE) * (r[i] * r[i]))
        covered = (launch[i + 1] > hidden_from) & (launch[i] < hidden_to)
        emerges = horizon[i] > launch[i]
        seen = (launch[i + 1] > horizon[i]) & (area[i] == area[i])
        cut[i] = seen & (emerges | covered | uneven)


@bare
def _silence(segments, launch, horizon, cut, energy):
    """Leave energy only to segments heard whole: those whose far end rises above the horizon.

    Across a hole in the bed the energy is NaN, which is not itself.
    """
    for i in range(segments):
        whole = (launch[i + 1] > horizon[i]) & (energy[i] == energy[i]) & (not cut[i])
        energy[i] = energy[i] if whole else np.float32(0.0)
