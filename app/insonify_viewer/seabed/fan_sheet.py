"""Sheet of the fan of one ping: it ends at what the sound meets, and what shades it leaves a gap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from insonify.explanation.cross_section import CrossSection
    from insonify.simulation import Simulation

STEP = 0.01  # rad, launch angle that one triangle fills at most, where the bed allows
APART = 0.02  # m by which neighbouring stretches may lie apart and be drawn as one

Points = NDArray[np.float64]


def fan_sheet(simulation: Simulation, ping: int) -> Points:
    """Triangles of the fan of one ping, both sides."""
    # lazy: loads Numba on a thread; the window opens before
    from insonify.explanation.cross_section import cut_cross_section

    return np.concatenate([_triangles(cut_cross_section(simulation, ping, side)) for side in range(2)])


def _triangles(section: CrossSection) -> Points:
    """Triangles of one side, (n, 3, 3)."""
    met = merge_stretches(np.concatenate([section.visible, *(face for _, face in section.targets)]), section)
    ends = [section.sonar.to_world(section.azimuth, met[:, k]) for k in range(2)]
    return np.stack([np.broadcast_to(section.sonar.place, ends[0].shape), *ends], axis=1)


def merge_stretches(stretches: Points, section: CrossSection) -> Points:
    """Stretches by launch angle, those that join drawn as one up to `STEP`, (m, 2, 2)."""
    if not len(stretches):
        return stretches
    rise = stretches[..., 1] - section.sonar.place[2]
    angle = np.arctan2(rise, stretches[..., 0])
    order = np.lexsort((stretches[:, 0, 0], angle.mean(axis=1)))
    stretches, angle = stretches[order], angle[order]
    gap = np.linalg.norm(stretches[1:, 0] - stretches[:-1, 1], axis=1) > APART
    step = np.diff(np.floor(angle[:, 0] / STEP)) != 0
    first = np.flatnonzero(np.concatenate([[True], gap | step]))
    last = np.append(first[1:], len(stretches)) - 1
    return np.stack([stretches[first, 0], stretches[last, 1]], axis=1)
