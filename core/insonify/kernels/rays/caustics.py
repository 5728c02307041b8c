"""Sound near a caustic, where the tube of a ray closes and ray theory makes its intensity infinite.

Near a caustic two rays reach each place on its bright side and none its dark side. The pressure of both is an Airy
function of ρ, the distance from the caustic in its own unit of length (Ludwig 1966; Brekhovskikh and Godin, Acoustics
of Layered Media II, 6). ρ follows from the tube of a single ray, q wide: rays launched δ beside it have the slowness pδ
across it and cross its front at qδ + q'δ²/2, so the caustic is q²/(2q') away, and

    ρ = (q/u)²,   u = √2 |q'|^⅔ / (2 ω²p²)^⅙,   I = 2 · 2π Ai²(-ρ) cosθ0 / (x u)   of both rays together.

Each of the two rays carries half of I. It also carries half of the sound at the place on the dark side that mirrors its
own at the caustic. Paths add as energies, so Ai² is averaged over interference fringes, over one octave of frequency
about the sonar's; the energy stays exactly the same. Where q' changes within the Airy function's main maximum, as among
rays that turn in many thin layers, no tube counts as narrower than (λ / πr)^⅓ r, about its width at that maximum.

Theory: docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.types import Water
from insonify.kernels.refraction.arcs import NODE, RANGE, RayState
from insonify.kernels.refraction.section_arcs import SectionPlane, advance_ray, launch_ray

MOST_ARCS = 4096  # of one ray; a trapped one ends there
FAR = 4.0  # ρ beyond which the fringes average to two separate rays within 2 %
OCTAVE = 0.35  # standard deviation of the logarithm of frequency over which fringes are averaged
STEPS = 32  # samples of the table per unit of ρ
ASIDE = 1e-6  # rad between a ray and the neighbour that tells how its tube changes
WIDEST = 10.0  # r (λ/r)^⅓ over which a tube is so wide that no caustic is near
LEAST = 1e-9  # least width of a tube over that of another one, so that nothing is divided by zero


def _airy(z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Airy's function by its power series (DLMF 9.4.1), exact to 1e-6 up to |z| = 10."""
    one, other = np.ones_like(z), z.copy()
    sum_one, sum_other, cube = one.copy(), other.copy(), z**3
    for k in range(3, 180, 3):
        one, other = one * cube / (k * (k - 1)), other * cube / (k * (k + 1))
        sum_one, sum_other = sum_one + one, sum_other + other
    at_zero, slope = 3.0 ** (-2.0 / 3.0) / math.gamma(2.0 / 3.0), 3.0 ** (-1.0 / 3.0) / math.gamma(1.0 / 3.0)
    return at_zero * sum_one - slope * sum_other


def _averaged_squares() -> NDArray[np.float64]:
    """Ai²(-ρ) averaged over an octave of frequency, at equal steps of ρ from -FAR to FAR."""
    rho = np.linspace(-FAR, FAR, int(2 * FAR * STEPS) + 1)
    nodes, weights = np.polynomial.hermite_e.hermegauss(24)
    ratio = np.exp(OCTAVE * nodes)  # of frequency: ρ grows with its power of ⅔, intensity with that of ⅓
    # Beyond 10, where the series loses its digits, there is no weight.
    square = _airy(np.clip(-rho[:, None] * ratio ** (2.0 / 3.0), -10.0, 10.0)) ** 2
    return np.ascontiguousarray((square * ratio ** (1.0 / 3.0)) @ (weights / weights.sum()))


AIRY_SQUARES = _averaged_squares()


class CausticField(NamedTuple):
    """Sound that a ray brings near a caustic."""

    focus: float  # intensity over that of the ray's own tube
    dark: float  # intensity where the dark side mirrors its landing, over that at its landing; 0 far from a caustic
    shift: float  # distance across the ray to that place, towards greater elevations, m


NO_CAUSTIC = CausticField(1.0, 0.0, 0.0)


@kernel
def follow_to_place(water: Water, plane: SectionPlane, z, cosine, sine, x):
    """Ray from height z at ground range x; whether it comes that far."""
    ray = launch_ray(water.height, water.speed, water.station, plane, z, cosine, sine)
    status = NODE
    for _ in range(MOST_ARCS):
        status, ray = advance_ray(water.height, water.speed, water.station, plane, ray, x, -math.inf, water.surface)
        if status != NODE:
            break
    return status == RANGE, ray


@kernel
def field_at_caustic(water: Water, plane: SectionPlane, z, cosine, sine, ray: RayState, spread):
    """Sound of a ray that has landed, launched from height z with a given direction."""
    tube = abs(ray.q)
    if not tube < WIDEST * spread ** (2.0 / 3.0) * water.wavelength ** (1.0 / 3.0):
        return NO_CAUSTIC
    least = (water.wavelength / math.pi) ** (1.0 / 3.0) * spread ** (2.0 / 3.0)
    bounded = CausticField(min(tube / least, 1.0), 0.0, 0.0)
    there, beside = follow_to_place(water, plane, z, cosine - ASIDE * sine, sine + ASIDE * cosine, ray.x)
    change = (_tube_on_front(ray, beside) - ray.q) / ASIDE
    if not there or change == 0.0 or ray.p == 0.0:
        return bounded
    slowness = 2.0 * math.pi * water.reference / water.wavelength * ray.p
    field, unit = airy_field(ray.q, change, slowness)
    if field.dark > 0.0:
        # Beyond the caustic by a quarter of ρ: there a parabola has a tube of -u/2, or the wave resolves none here.
        expected = -math.copysign(0.5 * unit, ray.q)
        aside = (expected - ray.q) / change
        c, s = math.cos(aside), math.sin(aside)
        there, beyond = follow_to_place(water, plane, z, cosine * c - sine * s, sine * c + cosine * s, ray.x)
        share = _tube_on_front(ray, beyond) / expected
        if not there or share < 0.5 or share > 2.0:
            return bounded
    return field


@kernel
def airy_field(tube, change, slowness):
    """Field near a caustic by Airy's function, `NO_CAUSTIC` far from it, and the tube of a ray where ρ is 1, m/rad.

    Parameters
    ----------
    tube, change : float
        q of a ray, m/rad, and q', by which q grows per radian of launch angle on one front, m/rad².
    slowness : float
        ωp, p being the slowness across the ray per radian of launch angle, rad/m per rad.
    """
    unit = math.sqrt(2.0) * abs(change) ** (2.0 / 3.0) / (2.0 * slowness * slowness) ** (1.0 / 6.0)
    rho = tube * tube / (unit * unit)
    if not rho < FAR:
        return NO_CAUSTIC, unit
    bright = _averaged_square(rho)
    focus = 2.0 * math.pi * bright * max(abs(tube) / unit, LEAST)
    return CausticField(focus, _averaged_square(-rho) / bright, -tube * tube / change), unit


@inlined
def _tube_on_front(ray, beside):
    """Tube of a neighbour of a ray where it crosses the ray's front; it is known at the ground range of the ray."""
    return beside.q - ray.speed * ray.p * (beside.z - ray.z) * ray.sine


@inlined
def _averaged_square(rho):
    """Averaged Ai²(-ρ) between the samples of the table."""
    place = (rho + FAR) * STEPS
    k = min(int(place), AIRY_SQUARES.size - 2)
    return AIRY_SQUARES[k] + (place - k) * (AIRY_SQUARES[k + 1] - AIRY_SQUARES[k])
