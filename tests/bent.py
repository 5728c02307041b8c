"""Sound through layered water by brute force, in one plane: fine fans of rays, each followed by tiny steps."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from insonify.kernels.common.types import SceneArrays, Water
from naive import range_factor

Heights = Callable[[np.ndarray], np.ndarray]
Disc = tuple[float, float, float]  # ground range and height of the centre above the sonar's datum, radius
BED = -1


def speed_and_gradient(water: Water, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Speed of sound at heights, which is linear between the nodes and level beyond them, and how it grows upwards."""
    speeds, heights = water.speed[0], water.height
    slopes = np.concatenate([[0.0], np.diff(speeds) / np.diff(heights), [0.0]])
    return np.interp(z, heights, speeds), slopes[np.searchsorted(heights, z, side="right")]


def onward(water: Water, state: np.ndarray, ds: ArrayLike) -> np.ndarray:
    """One step of the ray equations, by the rule of the middle twice over (Runge and Kutta's fourth order).

    Of ground range, height, cosine and sine of the angle above the horizontal, and travel time: (5, rays).
    """

    def rates(state: np.ndarray) -> np.ndarray:
        _, z, level, up, _ = state
        c, g = speed_and_gradient(water, z)
        turn = -g / c * level  # of the angle, by length
        return np.array([level, up, -turn * up, turn * level, 1.0 / c])

    k1 = rates(state)
    k2 = rates(state + 0.5 * ds * k1)
    k3 = rates(state + 0.5 * ds * k2)
    k4 = rates(state + ds * k3)
    return state + ds / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)


def follow(
    water: Water, z: float, angles: np.ndarray, hit: Callable, reach: float, step: float
) -> tuple[np.ndarray, np.ndarray]:
    """Follow rays launched at angles above the horizontal from height z until ``hit(x, z)`` names what they are in.

    Returns the state where each ends, (5, rays) as in `onward` (NaN if it meets nothing), and what it met.
    """
    rest = np.zeros_like(angles)
    state = np.array([rest, rest + z, np.cos(angles), np.sin(angles), rest])
    last = np.full_like(state, np.nan)  # before the step in which it ends
    alive = np.arange(angles.size)
    for _ in range(int(1.1 * reach / step)):
        after = onward(water, state, step)
        ended = hit(*after[:2]) != -2
        last[:, alive[ended]] = state[:, ended]
        state, alive = after[:, ~ended], alive[~ended]
        if alive.size == 0:
            break
    ends, what = np.isfinite(last[0]), np.full(angles.shape, -2)
    last[:, ends] = _ends(water, last[:, ends], hit, step)
    what[ends] = hit(*last[:2, ends])
    return last, what


def _ends(water: Water, before: np.ndarray, hit: Callable, step: float) -> np.ndarray:
    """Halve the last step of each ray forty times, and return where it is just inside of what it meets."""
    low, high = np.zeros(before.shape[1]), np.full(before.shape[1], step)
    for _ in range(40):
        middle = 0.5 * (low + high)
        inside = hit(*onward(water, before, middle)[:2]) != -2
        low, high = np.where(inside, low, middle), np.where(inside, middle, high)
    return onward(water, before, high)


def knife(
    arrays: SceneArrays, sonar: float, bed: Heights, discs: Sequence[Disc] = (), *, rays: int = 20000, step: float = 0.1
) -> np.ndarray:
    """One side of a knife's ping of law `sonar` over a bed that is the same all along the track, (bins,).

    The piece of surface ds between two neighbouring rays is seen across the ray as q dθ = ds cosα, so that intensity
    there over that at 1 m, cosθ0 / (x q), needs no q; the echo is σ ds times its square. Discs are bodies' sections.
    """

    def hit(x, z):
        met = np.where(z <= bed(x), BED, -2)
        for k, (cx, cz, radius) in enumerate(discs):
            met = np.where((x - cx) ** 2 + (z - cz) ** 2 <= radius**2, k, met)
        return met

    reach = arrays.bins * arrays.bin_length * 1.02
    angles = np.concatenate(
        [np.arctan(-np.geomspace(300.0, 1.0, rays // 4)), np.arctan(np.linspace(-1.0, 0.3, rays)[1:])]
    )
    (x, z, level, up, time), what = follow(arrays.water, sonar, angles, hit, reach, step)
    r, ends = arrays.water.reference * time, np.arctan2(up, level)
    same = (what[1:] == what[:-1]) & (what[1:] > -2)
    dx, dz = np.diff(x), np.diff(z)
    ds = np.hypot(dx, dz)
    angle = 0.5 * (ends[1:] + ends[:-1])
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = np.abs(dz * np.cos(angle) - dx * np.sin(angle)) / ds
        spread = np.cos(0.5 * (angles[1:] + angles[:-1])) * np.diff(angles) / (0.5 * (x[1:] + x[:-1]) * ds * cosine)
    diffuse = arrays.reflectivity[0, 0]
    middle = 0.5 * (r[1:] + r[:-1])
    energy = cosine**2 * diffuse / np.pi * ds * spread**2 * middle**4
    # A jump from one ridge to the next is no piece of surface.
    same &= ds * cosine < 4.0 * np.diff(angles) * middle
    near, far = r[:-1][same], r[1:][same]
    # Energies are spread evenly over their stretches of slant range.
    place = near + (np.arange(8)[:, None] + 0.5) / 8 * (far - near)
    k = np.floor(place / arrays.bin_length).astype(int)
    inside = k < arrays.bins
    energies = energy[same] / 8 * range_factor(arrays, place)
    return np.bincount(k[inside], energies[inside], arrays.bins)
