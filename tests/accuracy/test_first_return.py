"""The first return of wide fans over a level bed against its closed form."""

import math

import numpy as np
import pytest

from insonify.packing.packed_scene import pack
from insonify.planning import plan
from insonify.planning.probe import trace_model
from insonify.scene import edit, load_scene
from insonify.tow.poses import make_poses

ALTITUDE, BINS, RANGE, FIRST = 10.0, 5000, 50.0, 30  # bins of 0.01 m, those of the first 0.3 m
LEVEL = edit(
    load_scene("default"),
    {"targets": [], "seabed.relief": "flat", "track.altitude": ALTITUDE, "track.pings": 1, "sonar.bins": BINS},
)


def closed_form(width, diffuse, specular, shininess, reach):
    """Energy up to a slant range: ∫ σ W (r/x) r⁻⁴ dr over the arc W that a fan's cone takes in."""
    edges = np.linspace(ALTITUDE, reach, 200_001)
    r = 0.5 * (edges[1:] + edges[:-1])
    x, cos_squared = np.sqrt(r * r - ALTITUDE**2), (ALTITUDE / r) ** 2
    lobe = specular * (shininess + 2.0) / (2.0 * math.pi) * np.maximum(2.0 * cos_squared - 1.0, 0.0) ** shininess
    arc = 2.0 * x * np.arcsin(np.minimum(np.sin(0.5 * width) * r / x, 1.0))  # docs/theory/beam.md
    return float((cos_squared * (diffuse / math.pi + lobe) * arc * r / x / r**4).mean()) * (reach - ALTITUDE)


@pytest.mark.parametrize("material", [(0.3, 0.0, 1.0), (0.2, 0.5, 1000.0)], ids=["Lambert", "mirror"])
@pytest.mark.parametrize("width", [10.0, 30.0, 60.0])
def test_the_first_return_of_a_wide_fan_is_as_its_closed_form(width, material):
    named = dict(zip(("diffuse", "specular", "shininess"), material))
    scene = edit(LEVEL, {"seabed.material": named, "sonar.beam.width": width})
    packed, made = pack(scene), plan(scene)
    record = trace_model(packed, made.model, make_poses(scene, packed.ground, np.zeros(1, np.int64)))[0, 0]
    first = round(ALTITUDE / RANGE * BINS)
    energy = record[first : first + FIRST].sum()
    right = closed_form(math.radians(width), *material, ALTITUDE + FIRST * RANGE / BINS)
    assert energy == pytest.approx(right, rel=0.02)
    assert made.near_error < 3.0 * 0.03


def test_a_plan_prints_the_error_from_the_first_return():
    made = plan(LEVEL)
    assert made.near_error >= made.entry("planes").error
    assert "From the first return" in made.table()
