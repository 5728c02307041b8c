"""Any scene that validates makes a record of finite numbers, none negative; any other says why in one sentence."""

import math
import re
import tracemalloc
from time import process_time
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, event, given, seed, settings
from hypothesis.strategies import just

from drawn_scenes import scenes, spoiled_scenes
from insonify.io.meshes import read_mesh
from insonify.parallel import count_threads
from insonify.planning import Plan, plan
from insonify.scene import Scene, SceneError, build, edit, scene_from_toml, scene_to_toml
from insonify.scene.receiver.speckles import Coherent
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.reliefs.random_relief import RandomRelief
from insonify.scene.sonar.pulses import Ideal, Tone
from insonify.scene.water import UniformWater
from insonify.simulation import prepare, simulate

TOLERANCE = 0.5  # a record need not be exact here
# What a drawn scene may ask for, which its declaration tells, and seconds of work for each step, at worst.
MOST_BYTES, MOST_STEPS = 2e9, 3e9
ALWAYS, SECONDS_PER_STEP = 2.0, 1e-7
BASE_BYTES = 64e6  # bytes: tables of beams and of water, and what Python needs
OF_ENDLESS_GROUND = 600e6  # the tiles that are kept
OF_BENT_SOUND = 100e6  # the tables of some pings
OF_MESHES = 300e6  # what the many planes of a beam with a pattern cut of thousands of triangles
PER_KNOT, PER_CELL, PER_BIN = 500.0, 150.0, 400.0  # bytes of all arrays that are held at once
PER_TRIANGLE = 8.0  # steps of a plane that cuts it
KNOTS_PER_CELL = 8.0 * math.sqrt(2.0) * 2.0  # crossings of both families, halved twice; bent sound goes farther
TILE, LEVEL_CELLS, MOST_PLANES, DEFAULT_SIDE = 512, 4096, 1024, 102.4
SHARDS, OF_EACH = 100, 100  # ten thousand scenes: -k "shard-17" draws those of one shard alone
PATIENT = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much]


# Bounds from what a scene declares alone: slow clocks say nothing here.
def cells_along(scene: Scene) -> float:
    """Cells of the bed along the range."""
    return scene.sonar.range / scene.seabed.spacing


def most_bytes(scene: Scene) -> float:
    """Bytes that arrays of a scene may take at once, three pings at a time."""
    knots = KNOTS_PER_CELL * cells_along(scene) + 64.0
    lines = min(scene.track.pings, 64) * 2.0 * (scene.sonar.bins + pulse_bins(scene))
    held = BASE_BYTES + count_threads() * knots * PER_KNOT + _grid(scene) * PER_CELL + lines * PER_BIN
    held += MOST_PLANES * knots * 16.0 if isinstance(scene.receiver.speckle, Coherent) else 0.0
    held += 0.0 if isinstance(scene.water, UniformWater) else OF_BENT_SOUND
    held += OF_MESHES if any(target.kind == "mesh" for target in scene.targets) else 0.0
    return held + (OF_ENDLESS_GROUND if scene.seabed.endless else 0.0) + 64.0 * _waves(scene)


def pulse_bins(scene: Scene) -> float:
    """Bins that a pulse lasts; no more than the record has."""
    pulse = scene.sonar.pulse
    if isinstance(pulse, Ideal):
        return 1.0
    return 2.0 * math.ceil(0.5 * 1700.0 * pulse.duration / (scene.sonar.range / scene.sonar.bins)) + 1.0


def _grid(scene: Scene) -> float:
    """Nodes of the bed that are held."""
    seabed = scene.seabed
    if seabed.endless:
        return (TILE + 2.2 * cells_along(scene) + 3.0) ** 2
    if isinstance(seabed.relief, RandomRelief) or seabed.random_reliefs:
        return max(part.period / seabed.spacing for part in seabed.random_reliefs) ** 2
    if seabed.relief.kind == "mimic":
        return 4.0 * 2.0 * seabed.relief.reach / seabed.spacing
    if seabed.relief.kind == "flat" and not isinstance(seabed.material, Material):
        return min(max(DEFAULT_SIDE / seabed.spacing, 4.0), LEVEL_CELLS) ** 2
    return 16.0


def _waves(scene: Scene) -> float:
    """Samples of a line of waves, of the pulse and of its spectrum."""
    sonar, pulse = scene.sonar, scene.sonar.pulse
    if isinstance(pulse, Ideal):
        resolution = sonar.range / sonar.bins
    else:
        resolution = 0.5 * 1300.0 * (pulse.duration if isinstance(pulse, Tone) else 1.0 / pulse.bandwidth)
    fine = 16.0 * sonar.range / resolution if isinstance(scene.receiver.speckle, Coherent) else 0.0
    return fine + 64.0 * max(pulse_bins(scene), 32.0)


def most_steps(scene: Scene, plan: Plan) -> float:
    """Steps, each of some nanoseconds, that a scene of a plan may take: ground made, knots or cells passed, echoes."""
    pings, sonar = scene.track.pings, scene.sonar
    knots = KNOTS_PER_CELL * cells_along(scene) + 64.0
    rays = float(plan.settings.get("rays", 0)) * 2.0 ** min(sonar.bounces, 16)
    lines = MOST_PLANES if plan.method == "sweep" else 0
    triangles = sum(len(read_mesh(target.path)) for target in scene.targets if target.kind == "mesh")
    cut = lines * PER_TRIANGLE * triangles * (1.0 + len(plan.model.ways))  # ghosts meet them again
    bins = sonar.bins * (1.0 + pulse_bins(scene))
    return 100.0 * _grid(scene) + 2.0 * pings * ((lines + rays) * (knots + 100.0) + cut + bins) + _waves(scene)


def check(values: dict[str, Any], is_spoiled: bool) -> None:
    """Simulate what is valid, unless a mistake has made it too large, and look at what is said of the rest."""
    try:
        scene = build(values)
    except SceneError as error:
        event("refused by the declarations")
        check_sentence(str(error))
        return
    assert scene_from_toml(scene_to_toml(scene)) == scene
    try:
        steps = most_steps(scene, plan(scene, TOLERANCE)) if most_bytes(scene) < MOST_BYTES else math.inf
        if is_spoiled and steps >= MOST_STEPS:
            event("too large to be simulated here")
            return
        assert steps < MOST_STEPS
        check_record(scene)
        check_size(scene, steps)
    except SceneError as error:
        event("refused when it was to be simulated")
        check_sentence(str(error))


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
        tracemalloc.start()
        began = process_time()
        try:
            prepare(other, tolerance=TOLERANCE).intensity(np.arange(scene.track.pings))
            worked, peak = process_time() - began, tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        if worked < allowed:
            break
    assert peak < most_bytes(scene)
    assert worked < allowed


@settings(max_examples=15, deadline=None, suppress_health_check=PATIENT)
@given(values=scenes())
def test_any_scene_makes_a_record_or_says_why_not(values):
    check(values, is_spoiled=False)


@settings(max_examples=15, deadline=None, suppress_health_check=PATIENT)
@given(values=spoiled_scenes())
def test_any_mistake_is_one_sentence(values):
    check(values, is_spoiled=True)


@pytest.mark.slow
@pytest.mark.parametrize("shard", range(SHARDS), ids="shard-{}".format)
def test_ten_thousand_scenes(shard):
    """Each shard draws its scenes from two seeds, the same at every run."""
    many = settings(
        max_examples=OF_EACH // 2, derandomize=False, database=None, deadline=None, suppress_health_check=PATIENT
    )
    for is_spoiled, drawn in ((False, scenes()), (True, spoiled_scenes())):
        seed(2 * shard + is_spoiled)(many(given(values=drawn, is_spoiled=just(is_spoiled))(check)))()
