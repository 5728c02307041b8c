"""Any scene that validates makes a record of finite numbers, none negative; any other says why in one sentence."""

import re
import tracemalloc
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, event, given, seed, settings

from drawn_scenes import scenes, spoiled_scenes
from insonify.planning import plan
from insonify.scene import Scene, SceneError, build, edit, scene_from_toml, scene_to_toml
from insonify.simulation import prepare, simulate
from scene_sizes import most_bytes, most_steps

TOLERANCE = 0.5  # a record need not be exact here
# What a drawn scene may ask for, which its declaration tells, and seconds of work for each step, at worst.
MOST_BYTES, MOST_STEPS = 2e9, 3e9
ALWAYS, SECONDS_PER_STEP = 2.0, 1e-7
SHARDS, OF_EACH = 100, 100  # ten thousand scenes: -k "shard-17" draws those of one shard alone
PATIENT = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much]
Check = Callable[[dict[str, Any]], None]


def check(values: dict[str, Any]) -> None:
    """Simulate what is valid, and look at what is said of the rest."""
    try:
        scene = build(values)
    except SceneError as error:
        event("refused by the declarations")
        check_sentence(str(error))
        return
    assert scene_from_toml(scene_to_toml(scene)) == scene
    try:
        assert most_bytes(scene) < MOST_BYTES
        chosen = plan(scene, TOLERANCE)
        assert most_steps(scene, chosen) < MOST_STEPS
        check_record(scene)
        check_size(scene, most_steps(scene, chosen))
    except SceneError as error:
        event("refused when it was to be simulated")
        check_sentence(str(error))


def check_spoiled(values: dict[str, Any]) -> None:
    """Look at what is said of a scene with a mistake in it; if it is none, and small, simulate it."""
    try:
        scene = build(values)
        small = most_bytes(scene) < MOST_BYTES
        small = small and most_steps(scene, plan(scene, TOLERANCE)) < MOST_STEPS
    except SceneError as error:
        event("refused")
        check_sentence(str(error))
        return
    if small:
        check(values)
    else:
        event("too large to be simulated here")


def check_sentence(text: str) -> None:
    """One sentence that begins with the field."""
    assert re.match(r"[a-z]\w*(\.(\w+|'.*'))*:? ", text), text
    assert "\n" not in text
    assert 15 < len(text) < 400, text


def check_record(scene: Scene) -> None:
    """Finite numbers, none negative, within the range, whatever pings are asked for together."""
    record = simulate(scene, tolerance=TOLERANCE)
    event(f"simulated by {record.plan.partition(':')[0]}")
    intensity = record.intensity.values
    assert intensity.shape == (2, scene.track.pings, scene.sonar.bins)
    assert np.isfinite(intensity).all()
    assert (intensity >= 0.0).all()
    slant_range = record.slant_range.values
    assert 0.0 < slant_range[0] <= slant_range[-1] < scene.sonar.range
    last = np.array([scene.track.pings - 1])
    alone = prepare(scene, tolerance=TOLERANCE).intensity(last)
    np.testing.assert_array_equal(alone[0], intensity[:, -1])


def check_size(scene: Scene, steps: float) -> None:
    """No more memory than the declaration tells, nor work, of the same ground made anew by another seed."""
    other = edit(scene, {"seed": scene.seed ^ 1})
    allowed = ALWAYS + SECONDS_PER_STEP * steps
    for _ in range(3):  # another bed may go through what was not compiled till now, beside what else a machine does
        worked, peak = work_of(other)
        if worked < allowed:
            break
    assert peak < most_bytes(scene)
    assert worked < allowed


def work_of(scene: Scene) -> tuple[float, int]:
    """Seconds of work on a scene, and the most bytes that it holds at once."""
    tracemalloc.start()
    began = process_time()
    try:
        prepare(scene, tolerance=TOLERANCE).intensity(np.arange(scene.track.pings))
        return process_time() - began, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@settings(max_examples=30, deadline=None, suppress_health_check=PATIENT)
@given(values=scenes())
def test_any_scene_makes_a_record_or_says_why_not(values):
    check(values)


@settings(max_examples=30, deadline=None, suppress_health_check=PATIENT)
@given(values=spoiled_scenes())
def test_any_mistake_is_one_sentence(values):
    check_spoiled(values)


@pytest.mark.slow
@pytest.mark.parametrize("shard", range(SHARDS), ids="shard-{}".format)
def test_ten_thousand_scenes(shard):
    for number, (drawn, examine) in enumerate(((scenes(), check), (spoiled_scenes(), check_spoiled))):
        draw_of(drawn, examine, 2 * shard + number)


def draw_of(drawn: Any, examine: Check, number: int) -> None:
    """Examine the scenes of one seed, the same at every run."""

    @seed(number)
    @settings(max_examples=OF_EACH // 2, derandomize=False, database=None, deadline=None, suppress_health_check=PATIENT)
    @given(values=drawn)
    def each(values: dict[str, Any]) -> None:
        examine(values)

    each()
