"""Shadows of targets on the bed: share of the bed's echo that targets hide in every range bin, and which hides most.

Bed that a target hides would return an echo without the targets: the *hidden echo*, weighted by the beam like any
other. Its share is taken of the echo that the whole bed would return without the targets. Bed that other bed hides
returns nothing either way and does not count.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.sweep.target_echoes import target_of_body as target_of_body

NO_TARGET = -2  # in place of a target's index


class ShadowTable(NamedTuple):
    """Echo of the bed that each target hides, in the range bins of one side; a row is valid once its target is present.

    It is the echo by the direct path, in the fixed-point units of the contributors.
    """

    present: NDArray[np.bool_]  # (targets,)
    energy: NDArray[np.float64]  # (targets, bins)
    listed: NDArray[np.int64]  # (targets,) room to list those present


def empty_shadow_table(targets: int, bins: int) -> ShadowTable:
    """Make room for one side of a ping; memory of targets that hide nothing is never touched."""
    return ShadowTable(np.zeros(targets, np.bool_), np.empty((targets, bins)), np.empty(targets, np.int64))


@inlined_uncounted
def open_shadow(shadows, target):
    """Clear a target's row if it is not present yet, and mark it present."""
    if not shadows.present[target]:
        shadows.present[target] = True
        shadows.energy[target, :] = 0.0


@kernel_uncounted
def label_shadows(shadows, contributions, materials, labels, place, side):
    """Label each bin of one side with the share of the bed's echo that targets hide, and clear the table."""
    share, target = labels.shadow[place, side], labels.shadow_id[place, side]
    share[:], target[:] = 0.0, NO_TARGET
    if not shadows.present.any():
        return
    listed, count = shadows.listed, 0  # few of many targets
    for row in range(shadows.present.size):
        if shadows.present[row]:
            listed[count] = row
            count += 1
    for k in range(share.size):
        hidden, most, best = 0.0, 0.0, NO_TARGET
        for i in range(count):
            row = listed[i]
            energy = shadows.energy[row, k]
            hidden += energy
            if energy > most:
                most, best = energy, row
        if hidden > 0.0:
            seen = 0.0  # echo of the visible bed by the direct path
            for row in range(materials):
                if contributions.present[row]:
                    seen += contributions.energy[row, k]
            share[k] = hidden / (hidden + seen)
            target[k] = best
    shadows.present[:] = False
