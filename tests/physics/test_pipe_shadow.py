"""Echo and shadow of a pipe over a level bed, against their closed forms, wherever it lies."""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from beds import arrays_of, pipe_edges, poses_of
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify.tracers import rays, sweep

STEP = 0.02
BINS = 3000
LEVEL = {"seabed.relief": "flat", "sonar.pulse": "ideal", "sonar.beam": "knife", "track.pings": 1}


def records(altitude, solids):
    """Port side with and without bodies."""
    level = partial(arrays_of, np.zeros((4, 4)), 0.05, periodic=True, bins=BINS, bin_length=STEP)
    return [sweep.trace(arrays, poses_of(0.0, 0.0, altitude))[0, 0] for arrays in (level(solids=solids), level())]


def within_a_bin(index, slant_range):
    return abs(index - slant_range / STEP) <= 1.001


@settings(max_examples=60, deadline=None, derandomize=True)
@given(altitude=st.floats(3.0, 20.0), offset=st.floats(4.0, 45.0), radius=st.floats(0.1, 1.5), gap=st.floats(0.0, 8.0))
def test_shadow_and_echo_lie_where_geometry_puts_them_and_the_echo_has_its_energy(altitude, offset, radius, gap):
    assume(gap + 2.0 * radius < altitude - 0.2)
    axis = gap + radius
    record, bare = records(altitude, [((-60.0, offset, axis), (60.0, offset, axis), radius)])
    near, tangent, begins, ends = pipe_edges(gap, altitude=altitude, offset=offset, radius=radius)
    # The first thing that changes is the echo, at the near side.
    changed = np.flatnonzero(np.abs(record - bare) > 0.01 * bare.max())
    assert within_a_bin(changed[0], min(near, begins))
    # What is neither pipe nor bed is silent: the shadow, less what the pipe itself fills.
    k = np.arange(BINS)
    first, last = math.ceil(begins / STEP) + 1, min(math.floor(ends / STEP), BINS) - 1
    hidden = (k >= first) & (k < last)
    pipes = (k >= math.floor(near / STEP) - 1) & (k <= math.ceil(tangent / STEP) + 1)
    assert not record[hidden & ~pipes].any()
    # Everything else is the bare bed.
    lit = (k < begins / STEP - 1.001) | (k > ends / STEP + 0.001)
    np.testing.assert_allclose(record[lit & ~pipes], bare[lit & ~pipes], rtol=0.01, atol=1e-7)
    # The pipe is heard from its near side to its tangent.
    excess = record - np.where(lit, bare, 0.0)
    assert within_a_bin(np.flatnonzero((excess > 1e-4 * excess.max()) & pipes)[0], near)
    # A perfect Lambert pipe in a knife of 1 m: Σ cos α r dθ / π over its launch angles, nothing in front of it.
    distance = math.hypot(offset, altitude - axis)
    half = math.asin(radius / distance)
    turned = np.linspace(-half, half, 100_001)[1:-1]
    r = distance * np.cos(turned) - np.sqrt(radius**2 - (distance * np.sin(turned)) ** 2)
    energy = np.sum((distance * np.cos(turned) - r) / radius * r) * (turned[1] - turned[0]) / math.pi
    edges = np.clip([begins, ends], altitude, BINS * STEP)
    # What the bed loses: ∫ σ dx with σ = sin²θ / π, from x₁ to x₂.
    x = np.sqrt(edges**2 - altitude**2)
    lost = altitude / math.pi * np.diff(np.arctan(x / altitude))[0]
    gained = record.sum(dtype=float) - bare.sum(dtype=float)
    assert gained == pytest.approx(energy - lost, rel=2e-3, abs=2e-4)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(
    altitude=st.floats(6.0, 15.0), offset=st.floats(8.0, 40.0), gap=st.floats(0.0, 3.0), side=st.sampled_from([1, -1])
)
def test_a_declared_span_stands_where_it_was_put(altitude, offset, gap, side):
    pipe = {"kind": "pipe", "position": [0.0, side * offset], "length": 80.0, "radius": 0.5, "gap": gap}
    scene = edit(
        load_scene("pipe-span"), {**LEVEL, "targets": [pipe], "track.altitude": altitude, "track.start": [0, 0]}
    )
    bare = edit(scene, {"targets": []})
    with_pipe, without = (
        prepare(s, tolerance=1e-3, forced={"segments": "0.003"}).intensity(np.array([0]))[0, 0 if side > 0 else 1]
        for s in (scene, bare)
    )
    step = scene.sonar.range / scene.sonar.bins
    near, tangent, begins, ends = pipe_edges(gap, altitude=altitude, offset=offset, radius=0.5)
    heard = np.flatnonzero(with_pipe > 1.005 * without)
    assert heard[0] * step == pytest.approx(near, abs=1.001 * step)
    silent = np.flatnonzero((with_pipe == 0.0) & (without > 0.0)) * step
    if begins > scene.sonar.range:  # a high pipe's shadow falls beyond the record
        assert not silent.size
        return
    assert silent[0] == pytest.approx(max(begins, tangent if gap == 0.0 else 0.0), abs=tangent - near + 1.001 * step)
    assert silent[-1] + step == pytest.approx(min(ends, scene.sonar.range), abs=1.001 * step)


def test_a_shadow_without_end_reaches_the_last_bin():
    # The top of the pipe stands above the sonar.
    record, bare = records(4.0, [((-60.0, 20.0, 2.5), (60.0, 20.0, 2.5), 2.5)])
    _, _, begins, ends = pipe_edges(0.0, altitude=4.0, offset=20.0, radius=2.5)
    assert math.isinf(ends)
    assert bare[-1] > 0.0
    assert not record[math.ceil(begins / STEP) + 1 :].any()


both_tracers = pytest.mark.parametrize("trace", [sweep.trace, partial(rays.trace, rays=200_000)], ids=["sweep", "rays"])


@both_tracers
def test_a_step_hides_what_lies_behind_it(trace):
    heights = np.zeros((3, 1001))
    heights[:, :101] = 2.0
    arrays = arrays_of(heights, 0.1, y0=-0.1, bins=2000)
    record = trace(arrays, poses_of(0.0, 0.0, 10.0, -math.pi / 2.0))[0, 0]
    dark = np.flatnonzero(record[200:] == 0.0) + 200
    assert dark[0] == pytest.approx(math.hypot(10.0, 8.0) / 0.05, abs=1.001)
    assert dark[-1] + 1 == pytest.approx(math.hypot(12.5, 10.0) / 0.05, abs=1.001)
    assert dark.size == dark[-1] - dark[0] + 1


@both_tracers
def test_a_wall_is_heard_at_its_distance(trace):
    heights = np.zeros((3, 202))
    heights[:, 130:] = 8.0  # a cliff from x = 12.9 to 13.0
    arrays = arrays_of(heights, 0.1, y0=-0.1, bins=400)
    record = trace(arrays, poses_of(5.0, 0.0, 4.0, -math.pi / 2.0))[0, 0]
    # Steep at the foot of the cliff, and nothing beyond its top.
    assert record[158:175].max() > 20.0 * record[140:155].max()
    # From 7.9 m on: the last of the bed, ∫ sin²θ dx / π, and 8 m of wall 4 m above and below the sonar, ∫ cos²α dz / π.
    bed = 4.0 * (math.atan(7.9 / 4.0) - math.atan(math.sqrt(7.9**2 - 16.0) / 4.0)) / math.pi
    wall = 2.0 * 7.95 * math.atan(4.0 / 7.95) / math.pi
    assert record[158:].sum(dtype=float) == pytest.approx(bed + wall, rel=2e-3)
