"""Any scene that validates makes a record of finite numbers, none negative; any other says why in one sentence."""

from __future__ import annotations

import re
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, event, given, settings

from drawn_scenes import scenes
from insonify.scene import Scene, SceneError, build, scene_from_toml, scene_to_toml
from insonify.simulate import prepare, simulate

TOLERANCE = 0.5  # a record need not be exact here
SECONDS = 20.0
PATIENT = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much]


def any_scene(count: int, derandomize: bool) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Draw so many scenes for a test."""

    def dress(test: Callable[..., None]) -> Callable[..., None]:
        drawn = given(values=scenes())(test)
        return settings(max_examples=count, deadline=None, derandomize=derandomize, suppress_health_check=PATIENT)(
            drawn
        )

    return dress


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
        check_record(scene)
    except SceneError as error:
        event("refused when it was to be simulated")
        check_sentence(str(error))


def check_sentence(text: str) -> None:
    """One sentence that begins with the field."""
    assert re.match(r"[a-z]\w*(\.\w+)*:? ", text), text
    assert "\n" not in text
    assert 15 < len(text) < 400, text


def check_record(scene: Scene) -> None:
    """Finite numbers, none negative, within the range, in finite time, whatever pings are asked for together."""
    record = simulate(scene, tolerance=TOLERANCE)
    event(f"simulated by {record.plan.partition(':')[0]}")
    intensity = record.intensity.values
    assert intensity.shape == (2, scene.track.pings, scene.sonar.bins)
    assert np.isfinite(intensity).all()
    assert (intensity >= 0.0).all()
    slant_range = record.slant_range.values
    assert 0.0 < slant_range[0] <= slant_range[-1] < scene.sonar.range
    last = np.array([scene.track.pings - 1])
    began = perf_counter()  # by now all is compiled
    alone = prepare(scene, tolerance=TOLERANCE).intensity(last)
    assert perf_counter() - began < SECONDS
    np.testing.assert_array_equal(alone[0], intensity[:, -1])


@any_scene(50, derandomize=True)
def test_any_scene_makes_a_record_or_says_why_not(values):
    check(values)


@pytest.mark.slow
@any_scene(10_000, derandomize=False)
def test_ten_thousand_scenes(values):
    check(values)
