"""Sheet of the fan of one ping: it ends at what the sound meets; behind targets lies their acoustic shadow."""

from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify_viewer.core_types import CrossSection, Simulation

STEP = 0.01  # rad, launch angle that one triangle fills at most, where the bed allows
APART = 0.02  # m by which neighbouring stretches may lie apart and be drawn as one


class FanSheet(NamedTuple):
    """Triangles of the fan of one ping, both sides, (n, 3, 3)."""

    lit: Floats  # from the sonar to the bed and the targets that it meets
    shaded: Floats  # from the targets to the bed behind them


def fan_sheet(simulation: Simulation, ping: int) -> FanSheet:
    """Triangles of the fan of one ping."""
    # lazy: loads Numba on a thread; the window opens before
    from insonify.explanation.cross_section import cut_cross_section

    sections = [cut_cross_section(simulation, ping, side) for side in range(2)]
    return FanSheet(*(np.concatenate([make(section) for section in sections]) for make in (_triangles, _shadows)))


def _shadows(section: CrossSection) -> Floats:
    """Triangles between what is visible of targets and the bed that they hide on one side, (n, 3, 3)."""
    faces = merge_stretches(np.concatenate([np.empty((0, 2, 2)), *(face for _, face in section.targets)]), section)
    if not len(faces):
        return np.empty((0, 3, 3))
    height = section.sonar.place[2]
    slope = (faces[..., 1] - height) / faces[..., 0]
    x, bed = section.bed.T
    over = height + slope[..., np.newaxis] * x - bed  # of the rays, beyond the faces
    is_met = (x > faces[..., :1]) & (over <= 0.0)
    last = np.maximum(is_met.argmax(axis=-1), 1)
    rest, past = (np.take_along_axis(over, k[..., np.newaxis], -1)[..., 0] for k in (last - 1, last))
    met = x[last] + (x[last] - x[last - 1]) * past / np.maximum(rest - past, 1e-9)  # the bed is even from node to node
    ends = np.where(is_met.any(axis=-1), np.maximum(met, faces[..., 0]), section.reach)
    behind = np.stack([ends, height + slope * ends], axis=-1)
    corners = np.stack([faces[:, 0], faces[:, 1], behind[:, 1], faces[:, 0], behind[:, 1], behind[:, 0]], axis=1)
    return section.sonar.to_world(section.azimuth, corners.reshape(-1, 2)).reshape(-1, 3, 3)


def _triangles(section: CrossSection) -> Floats:
    """Triangles of one side, (n, 3, 3)."""
    met = merge_stretches(np.concatenate([section.visible, *(face for _, face in section.targets)]), section)
    ends = [section.sonar.to_world(section.azimuth, met[:, k]) for k in range(2)]
    return np.stack([np.broadcast_to(section.sonar.place, ends[0].shape), *ends], axis=1)


def merge_stretches(stretches: Floats, section: CrossSection) -> Floats:
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
