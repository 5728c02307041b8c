"""Rays to a convex body, many at once: the same as one by one, for any body and any plane."""

import math

import numpy as np
import pytest

from insonify.compiler.jit import kernel
from insonify.kernels.common.types import FRUSTUM, SPHERE
from insonify.kernels.targets.angular_zbuffer import meet_body
from insonify.kernels.targets.apparent_targets import ApparentSource
from insonify.kernels.targets.primitives import Primitive, meet_primitive

STRAIGHT = ApparentSource(False, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0)
RAYS = 257


@kernel
def meet_together(body, cosine, sine, distance, incidence, lean):
    """All rays at once."""
    distance[:], incidence[:] = cosine, sine
    meet_body(body, cosine.size, True, distance, incidence, lean)


@kernel
def meet_each(body, cosine, sine, distance, incidence, lean):
    """Ray by ray."""
    for i in range(cosine.size):
        distance[i], incidence[i], lean[i] = meet_primitive(body, cosine[i], sine[i])


def body_of(kind, start, axis, length, radius, taper, azimuth, source=STRAIGHT):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    level = math.cos(azimuth), math.sin(azimuth)
    return Primitive(kind, *map(float, start), *map(float, axis), length, radius, taper, *level, source)


def both(body, angles):
    cosine, sine = np.cos(angles), np.sin(angles)
    results = np.full((2, 3, angles.size), np.nan)
    meet_together(body, cosine, sine, *results[0])
    meet_each(body, cosine, sine, *results[1])
    return results


def compare(body, angles):
    """Number of rays that meet the body, all of them alike."""
    (distance, incidence, lean), (right, cosine, leaning) = both(body, angles)
    met = np.isfinite(right)
    np.testing.assert_array_equal(np.isfinite(distance), met)
    scale = float(np.hypot(body.x, np.hypot(body.y, body.z)))
    np.testing.assert_allclose(distance[met], right[met], rtol=0.0, atol=1e-9 * scale)
    # Near a body's edge the incidence changes as the root of the angle.
    np.testing.assert_allclose(incidence[met], cosine[met], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(lean[met], leaning[met], rtol=0.0, atol=1e-6)
    return int(met.sum())


def aimed(rng, body):
    """Angles at a body from a little below it to a little above."""
    towards = math.atan2(body.z + 0.5 * body.length * body.az, math.hypot(body.x, body.y))
    wide = 1.2 * math.atan2(body.radius + body.length, math.hypot(body.x, body.y, body.z))
    return np.sort(np.clip(towards + rng.uniform(-wide, wide, RAYS), -1.57, 1.57))


@pytest.mark.parametrize("seed", range(40))
def test_random_bodies_are_met_as_one_by_one(seed):
    rng = np.random.default_rng(seed)
    found = 0
    for _ in range(60):
        away, azimuth = 10.0 ** rng.uniform(0.3, 3.0), rng.uniform(0.0, 2.0 * math.pi)
        start = away * math.cos(azimuth), away * math.sin(azimuth), rng.uniform(-away, 5.0)
        radius, length = away * 10.0 ** rng.uniform(-4.0, -0.7), away * 10.0 ** rng.uniform(-3.0, 0.0)
        taper = rng.choice([0.0, -radius / length, rng.uniform(-radius / length, 3.0)])
        kind = SPHERE if rng.random() < 0.25 else FRUSTUM
        aside = rng.uniform(-0.3, 0.3) * radius / away
        body = body_of(kind, start, rng.normal(size=3), length, radius, taper, azimuth + aside)
        found += compare(body, aimed(rng, body))
    assert found > 60 * RAYS // 10


@pytest.mark.parametrize(
    ("axis", "taper"),
    [((1, 0, 0), 0.0), ((0, 1, 0), 0.0), ((0, 0, 1), 0.0), ((0, 0, 1), -0.25), ((1, 0, 0), -0.25), ((-1, 0, 0), 0.5)],
)
@pytest.mark.parametrize("start", [(20.0, 0.0, -8.0), (20.0, 0.0, 0.0), (18.0, -0.5, -8.0)])
def test_bodies_along_the_grid_are_met_as_one_by_one(axis, taper, start):
    # An end may lie in the plane, a ray along the axis or level with an end.
    body = body_of(FRUSTUM, start, axis, 4.0, 1.0, taper, 0.0)
    angles = np.concatenate([np.linspace(-1.5, 1.5, 3001), [0.0, math.atan2(-8.0, 20.0)]])
    assert compare(body, np.sort(angles)) > 0


def test_bodies_are_met_from_their_apparent_source():
    source = ApparentSource(
        True, 0.9, -math.sqrt(0.19), 0.85, -math.sqrt(1 - 0.85**2), 1.1, 0.4, 1.02, 1.0, 1.0, 0.1, 0.2
    )
    body = body_of(FRUSTUM, (20.0, 0.1, -12.0), (1.0, 0.2, 0.1), 4.0, 1.0, 0.0, 0.0, source)
    assert compare(body, np.linspace(-1.5, 1.5, 3001)) > 0
