"""Backscatter of surfaces by the Lambert and Phong laws, for one place and for all segments of a profile.

Sound that leaves and returns along one line, at incidence α to the surface's normal, has the monostatic formulas; for
two directions there is `bistatic_strength`. Derived in docs/theory/scattering.md.
"""

import math

import numpy as np

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.common.types import LIGHT, SONAR

INVERSE_PI = 1.0 / math.pi
LEAST_MIRRORED = 0.1  # R·V below which a lobe is too faint for its steepness to count
HIGHEST_POWER = 128  # one more than the greatest exponent for which lobes of many segments are computed at once


@inlined_uncounted
def _phong(mirrored, shininess):
    """Phong's lobe max(0, R·V)ⁿ, from R·V."""
    if mirrored <= 0.0:
        return 0.0
    whole = int(shininess)
    if whole != shininess:
        return mirrored**shininess
    # Integer powers by repeated squaring are several times cheaper than pow().
    result, square = 1.0, mirrored
    while whole > 0:
        if whole & 1:
            result *= square
        square *= square
        whole >>= 1
    return result


@inlined_uncounted
def _specular_strength(cos_squared, specular, shininess, law):
    """Specular part of the monostatic strength of either law, from cos²α."""
    # Sound returns the way it came: R·V = cos 2α = 2 cos²α − 1, docs/theory/scattering.md.
    value = specular * _phong(2.0 * cos_squared - 1.0, shininess)
    return value if law == LIGHT else value * cos_squared * (shininess + 2.0) * (0.5 * INVERSE_PI)


@inlined_uncounted
def backscatter(cos_incidence, diffuse, specular, shininess):
    """Backscattering cross-section of unit area, law `sonar`: σ = cos²α (k_d/π + k_s (n+2)/(2π) cosⁿ 2α)."""
    if cos_incidence <= 0.0:
        return 0.0
    cos_squared = cos_incidence * cos_incidence
    # docs/theory/scattering.md
    return cos_squared * diffuse * INVERSE_PI + _specular_strength(cos_squared, specular, shininess, SONAR)


@inlined_uncounted
def backscatter_strength(cos_incidence, diffuse, specular, shininess, law):
    """Monostatic strength of a surface under either law."""
    if law != LIGHT:
        return backscatter(cos_incidence, diffuse, specular, shininess)
    if cos_incidence <= 0.0:
        return 0.0
    # I = k_d cos α + k_s max(0, R·V)ⁿ: Lambert (1760) and Phong (1975), as in docs/theory/scattering.md.
    return diffuse * cos_incidence + _specular_strength(cos_incidence * cos_incidence, specular, shininess, LIGHT)


@inlined_uncounted
def bistatic_strength(cos_in, cos_out, mirrored, diffuse, specular, shininess, law):
    """Bistatic strength of a surface between two directions, under either law.

    Parameters
    ----------
    cos_in, cos_out : float
        Cosines of the angles to the normal; a surface seen from behind sends nothing.
    mirrored : float
        R·V, cosine of the angle between the mirrored direction and the one out.
    diffuse, specular, shininess : float
        Lambert's share k_d, Phong's share k_s and its exponent n.
    law : int
        LIGHT: I = k_d cos α_in + k_s max(0, R·V)ⁿ. SONAR: σ = cos α_in cos α_out (k_d/π + k_s (n+2)/(2π) max(0, R·V)ⁿ),
        which is reciprocal.
    """
    if cos_in <= 0.0 or cos_out <= 0.0:
        return 0.0
    shine = specular * _phong(mirrored, shininess)
    if law == LIGHT:
        return diffuse * cos_in + shine
    # docs/theory/scattering.md
    return cos_in * cos_out * (diffuse + 0.5 * (shininess + 2.0) * shine) * INVERSE_PI


@inlined_uncounted
def scatter_segments(segments, material, reflectivity, mapped, law, cos_squared, scale, energy):
    """Energy of many segments: monostatic strength times a scale per segment, in vectorised passes."""
    specular, shininess = reflectivity[material[0], 1], reflectivity[material[0], 2]
    if mapped or (specular > 0.0 and (shininess != math.floor(shininess) or shininess >= HIGHEST_POWER)):
        _scatter_mapped(segments, material, reflectivity, cos_squared, scale, law, energy)
        return
    diffuse = reflectivity[material[0], 0]
    if law != LIGHT:
        diffuse *= INVERSE_PI
        specular *= (shininess + 2.0) * (0.5 * INVERSE_PI)
    if specular > 0.0:
        _scatter_whole_power(segments, diffuse, specular, int(shininess), cos_squared, scale, law, energy)
    else:
        _scatter_lambert(segments, diffuse, cos_squared, scale, law, energy)


@inlined_uncounted
def _scatter_mapped(segments, material, reflectivity, cos_squared, scale, law, energy):
    """Energy of segments of several materials or of a non-integer exponent; the lobe is zero beyond 45° incidence."""
    per_pi = energy.dtype.type(INVERSE_PI)
    for i in range(segments):
        diffuse = math.sqrt(cos_squared[i]) if law == LIGHT else cos_squared[i] * per_pi
        energy[i] = diffuse * scale[i] * reflectivity[material[i], 0]
    for i in range(segments):
        if cos_squared[i] > 0.5:
            row = material[i]
            energy[i] += scale[i] * _specular_strength(cos_squared[i], reflectivity[row, 1], reflectivity[row, 2], law)


@inlined_uncounted
def _scatter_lambert(segments, diffuse, cos_squared, scale, law, energy):
    """Energy of segments of one material without a specular lobe."""
    diffuse = energy.dtype.type(diffuse)
    for i in range(segments):
        energy[i] = diffuse * scale[i] * (math.sqrt(cos_squared[i]) if law == LIGHT else cos_squared[i])


@inlined_uncounted
def _scatter_whole_power(segments, diffuse, specular, power, cos_squared, scale, law, energy):
    """Energy of segments of one material with an integer exponent, by repeated squaring over all segments."""
    real = energy.dtype.type
    diffuse, specular, one, bits = real(diffuse), real(specular), real(1.0), _bits(power)
    for i in range(segments):
        lobe = _whole_lobe(cos_squared[i] + cos_squared[i] - one, bits, one)
        if law == LIGHT:
            energy[i] = scale[i] * (diffuse * math.sqrt(cos_squared[i]) + specular * lobe)
        else:
            energy[i] = scale[i] * cos_squared[i] * (diffuse + specular * lobe)


@inlined_uncounted
def _bits(power):
    """Binary digits of an exponent below HIGHEST_POWER, the last one first."""
    return (
        power & 1 != 0, power & 2 != 0, power & 4 != 0, power & 8 != 0,
        power & 16 != 0, power & 32 != 0, power & 64 != 0,
    )  # fmt: skip


@inlined_uncounted
def _whole_lobe(mirrored, bits, one):
    """Phong's lobe max(0, R·V)ⁿ of an integer exponent by its binary digits, in the precision of ``one``."""
    square = mirrored if mirrored > one - one else one - one
    lobe = square if bits[0] else one
    square *= square
    lobe = lobe * square if bits[1] else lobe
    square *= square
    lobe = lobe * square if bits[2] else lobe
    square *= square
    lobe = lobe * square if bits[3] else lobe
    square *= square
    lobe = lobe * square if bits[4] else lobe
    square *= square
    lobe = lobe * square if bits[5] else lobe
    square *= square
    return lobe * square if bits[6] else lobe


@inlined_uncounted
def incidence_powers(segments, reflectors, law, cos_squared, scale, energy, out):
    """Power of cos²α with which the strength of segments grows about their incidence: d ln(strength) / d ln(cos²α)."""
    material, reflectivity, mapped = reflectors
    if mapped:
        for i in range(segments):
            row = np.uint64(material[i])
            diffuse, shininess = out.dtype.type(reflectivity[row, 0]), out.dtype.type(reflectivity[row, 2])
            out[i] = _incidence_power(diffuse, shininess, law, cos_squared[i], scale[i], energy[i])
        return
    diffuse, shininess = out.dtype.type(reflectivity[material[0], 0]), out.dtype.type(reflectivity[material[0], 2])
    for i in range(segments):
        out[i] = _incidence_power(diffuse, shininess, law, cos_squared[i], scale[i], energy[i])


@inlined_uncounted
def _incidence_power(diffuse, shininess, law, cos_squared, scale, energy):
    """Power of cos²α of Lambert's law, 1/2 or 1, raised by the share that Phong's lobe has in the strength."""
    real = type(energy)
    half, one, least = real(0.5), real(1.0), real(LEAST_MIRRORED)
    if law == LIGHT:
        lambert, base = diffuse * math.sqrt(cos_squared), half
    else:
        lambert, base = diffuse * cos_squared * real(INVERSE_PI), one
    lobe = one - lambert * scale / energy
    mirrored = cos_squared + cos_squared - one
    steep = shininess * (cos_squared + cos_squared) / (mirrored if mirrored > least else least)
    # Light: d ln cosα / d ln cos²α is 1/2, of the lobe 0. Sonar: both are multiplied by cos²α.
    return base + lobe * (steep - half if law == LIGHT else steep)


@inlined_uncounted
def scatter_paired_segments(segments, material, reflectivity, mapped, law, facing, mirrored, scale, energy):
    """Energy of many segments between two directions: bistatic strength times a scale per segment."""
    row = material[0]
    diffuse, specular, shininess = reflectivity[row, 0], reflectivity[row, 1], reflectivity[row, 2]
    if mapped or (specular > 0.0 and (shininess != math.floor(shininess) or shininess >= HIGHEST_POWER)):
        for i in range(segments):
            row = material[i]
            shine = reflectivity[row, 1] * _phong(mirrored[i], reflectivity[row, 2])
            if law == LIGHT:
                energy[i] = scale[i] * (reflectivity[row, 0] * facing[i] + shine)
            else:
                shine *= 0.5 * (reflectivity[row, 2] + 2.0)
                energy[i] = scale[i] * facing[i] * (reflectivity[row, 0] + shine) * INVERSE_PI
        return
    real = energy.dtype.type
    if law != LIGHT:
        diffuse, specular = diffuse * INVERSE_PI, specular * (shininess + 2.0) * (0.5 * INVERSE_PI)
    diffuse, specular, one, bits = real(diffuse), real(specular), real(1.0), _bits(int(shininess))
    for i in range(segments):
        lobe = _whole_lobe(mirrored[i], bits, one)
        if law == LIGHT:
            energy[i] = scale[i] * (diffuse * facing[i] + specular * lobe)
        else:
            energy[i] = scale[i] * facing[i] * (diffuse + specular * lobe)
