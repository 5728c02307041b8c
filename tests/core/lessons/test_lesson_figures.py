"""Figures of lessons, against simulated records."""

import numpy as np
import pytest

from insonify.lessons import load_lesson, states_of
from insonify.scene import Scene
from insonify.simulation import simulate


def shadow_of_block(scene: Scene) -> tuple[float, float]:
    """Slant ranges at which the shadow of the first target begins and ends, from the intensities alone."""
    record = simulate(scene)
    ping = round(scene.targets[0].position[0] / scene.track.speed * scene.sonar.ping_rate)
    intensity = record.intensity.isel(ping_time=ping).sel(channel="starboard").to_numpy()
    edges = np.arange(scene.sonar.bins + 1) * scene.sonar.range / scene.sonar.bins
    # The longest stretch without an echo behind the first return.
    dark = np.flatnonzero(np.diff(np.concatenate([[1], (intensity > 0.0).astype(int), [1]])))
    starts, ends = dark[::2], dark[1::2]
    behind = edges[starts] > scene.altitude
    longest = np.argmax(np.where(behind, ends - starts, 0))
    return float(edges[starts[longest]]), float(edges[ends[longest]])


def test_the_height_of_the_block_follows_from_its_shadow() -> None:
    """h = A L / (R + L) holds on the record of every step of the lesson to the size of two bins."""
    lesson = load_lesson("target-height")
    _, first, _ = next(states_of(lesson))
    scenes = [first.scene, *(end.scene for _, _, end in states_of(lesson))]
    lengths = []
    for scene in scenes:
        begin, end = shadow_of_block(scene)
        height = scene.altitude * (end - begin) / end
        bin_length = scene.sonar.range / scene.sonar.bins
        assert height == pytest.approx(scene.targets[0].size[2], abs=2.0 * bin_length * scene.altitude / end)
        lengths.append((begin, end - begin))
    # The figures that question and answer give.
    assert lengths[1] == pytest.approx((22.47, 5.62), abs=0.05)
    assert lengths[2] == pytest.approx((21.2, 14.1), abs=0.05)
    assert lengths[3] == pytest.approx((21.4, 5.3), abs=0.06)
