"""What a record shows of each target: bounding boxes of its echo and its shadow, shadow length, target strength.

Everything follows from the labels of the bins. The target strength is

    TS = 10 log10(Σ I r⁴)      # Urick, Principles of Underwater Sound, 3rd ed., 9.1 and 9.2

summed over the bins of the target's direct echo, with I the echo, less absorption, of a source that gives 1 at 1 m. So
I r⁴ is the backscattering cross-section in m² and TS is in dB re 1 m². The response of the beam, 1 on its axis, is left
in: only the part of a target within the beam counts, and a knife is 1 m wide along the track.
"""

from collections.abc import Mapping
from functools import reduce
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Floats
from insonify.kernels.sweep.bed_stretches import NO_TARGET
from insonify.scene import Scene
from insonify.tracers.labels import PATHS

DARK = 0.5  # share of the bed's echo hidden from which a bin belongs to a shadow: 3 dB darker than without the target
NONE = -1  # of a box that holds nothing


class TargetTruth(NamedTuple):
    """What the pings of a record show of each target."""

    # (targets, 2, 4) First and last ping, first and last bin, port first, of the bins in which the target's
    # direct echo is the greatest contributor, of its shadow, and of both; -1 where there are none. A bin is of a
    # shadow if the target hides most of what is hidden of the bed there, and that is at least half of the bed's
    # echo.
    echo_box: NDArray[np.int32]
    shadow_box: NDArray[np.int32]
    target_box: NDArray[np.int32]
    # (targets, 2) slant range in metres from the first bin of the shadow to its last, both included, of the ping
    # in which it is longest; 0 without a shadow.
    shadow_length: Floats
    # (targets,) in dB re 1 m², of the ping and side with its strongest echo; NaN without an echo, and by
    # law `light`, which has no areas.
    target_strength: Floats


def find_target_truth(scene: Scene, labels: Mapping[str, NDArray[Any]], first_ping: int) -> TargetTruth:
    """Find what successive pings show of each target."""
    targets, sonar = len(scene.targets), scene.sonar
    direct, dark = labels["path"] == PATHS.index("direct"), labels["shadow"] >= DARK
    echo = _find_boxes(np.where(direct, labels["target_id"], NO_TARGET), targets, first_ping)
    owner = np.where(dark, labels["shadow_id"], NO_TARGET)
    shadow = _find_boxes(owner, targets, first_ping)
    sections = labels["target_echo"] * (sonar.law == "sonar")  # (pings, 2, m) in m², of the first m targets
    greatest = np.zeros(targets)
    greatest[: sections.shape[2]] = sections.max(axis=(0, 1), initial=0.0)
    return TargetTruth(
        echo_box=echo,
        shadow_box=shadow,
        target_box=_join_boxes(echo, shadow),
        shadow_length=sonar.range / sonar.bins * _longest_rows(owner, shadow, first_ping),
        target_strength=10.0 * np.log10(np.where(greatest > 0.0, greatest, np.nan)),
    )


def join_target_truth(*parts: TargetTruth) -> TargetTruth:
    """Join what several blocks of pings show of the same targets."""
    *boxes, lengths, strengths = zip(*parts)
    echo, shadow, both = (reduce(_join_boxes, each) for each in boxes)
    return TargetTruth(echo, shadow, both, np.maximum.reduce(lengths), np.fmax.reduce(strengths))


def _find_boxes(owner: NDArray[np.int16], targets: int, first_ping: int) -> NDArray[np.int32]:
    """Bounding boxes, (targets, 2, 4), of the bins of each target, (n, 2, bins)."""
    # lazy: only labels need it
    from scipy.ndimage import find_objects

    boxes = np.full((targets, 2, 4), NONE, np.int32)
    for side in range(2):
        numbered = np.maximum(owner[:, side].astype(np.int32) + 1, 0)
        for target, found in enumerate(find_objects(numbered, targets)):
            if found is not None:
                pings, bins = found
                first, last = pings.start + first_ping, pings.stop - 1 + first_ping
                boxes[target, side] = first, last, bins.start, bins.stop - 1
    return boxes


def _join_boxes(one: NDArray[np.int32], other: NDArray[np.int32]) -> NDArray[np.int32]:
    """Bounding boxes of two sets of bounding boxes, (..., 4) each."""
    joined = np.maximum(one, other)
    first = np.minimum(one, other)
    present = first != NONE
    joined[..., ::2] = np.where(present, first, joined)[..., ::2]
    return joined


def _longest_rows(owner: NDArray[np.int16], boxes: NDArray[np.int32], first_ping: int) -> Floats:
    """Bins from the first to the last of each target in the ping in which that is most, (targets, 2)."""
    longest = np.zeros(boxes.shape[:2])
    for target, side in np.argwhere(boxes[..., 0] != NONE):
        first, last, near, far = boxes[target, side]
        present = owner[first - first_ping : last - first_ping + 1, side, near : far + 1] == target
        spans = present.shape[1] - present.argmax(axis=1) - present[:, ::-1].argmax(axis=1)
        longest[target, side] = spans[present.any(axis=1)].max()
    return longest
