"""One trace, two interpretations: a level patterned bed and dunes of one material."""

import math

import numpy as np
import pytest

from insonify.scene import SceneError, build, edit, load_scene
from insonify.scene.seabed.reliefs.mimic import FROM, equivalent_profile
from insonify.simulation import prepare
from insonify.terrain import build_ground

ALTITUDE = 15.0
STEP = 0.005


def ground_ranges(count):
    return (np.arange(count) + 0.5) * STEP


def wavy(amplitude, count=8000, period=16.0):
    return 1.0 - amplitude * np.cos(2.0 * math.pi * ground_ranges(count) / period)


@pytest.mark.parametrize(("law", "ratio"), [("sonar", 1.0), *(("light", k) for k in (0.5, 0.9, 1.0, 1.1, 1.35))])
def test_an_even_bed_is_level_and_an_even_ratio_under_light_a_plane_at_that_distance(law, ratio):
    """cos β = κ H/r is a plane whose foot lies κ H from the sonar."""
    x, z = equivalent_profile(np.full(8000, ratio), ALTITUDE, STEP, law)
    if ratio == 1.0:
        np.testing.assert_allclose(x, np.arange(8001) * STEP, atol=2e-7)
        np.testing.assert_allclose(z, 0.0, atol=2e-7)
    far = np.hypot(x, ALTITUDE - z) > 1.01 * FROM * ALTITUDE
    dx, dz = np.diff(x[far]), np.diff(z[far])
    distance = np.abs((z[far][:-1] - ALTITUDE) * dx - x[far][:-1] * dz) / np.hypot(dx, dz)
    np.testing.assert_allclose(distance, ratio * ALTITUDE, rtol=1e-6)


@pytest.mark.parametrize("law", ["light", "sonar"])
@pytest.mark.parametrize("amplitude", [0.1, 0.25, 0.39])
def test_the_profile_is_as_bright_as_the_level_bed(law, amplitude):
    ratio = wavy(amplitude)
    x, z = equivalent_profile(ratio, ALTITUDE, STEP, law)
    r = np.hypot(x, ALTITUDE - z)
    flat = np.hypot(np.arange(ratio.size + 1) * STEP, ALTITUDE)
    np.testing.assert_allclose(r, flat, rtol=1e-12)
    # Brightness of every straight bit by its own geometry.
    dx, dz, dr = np.diff(x), np.diff(z), np.diff(r)
    middle_x, middle_z = 0.5 * (x[1:] + x[:-1]), 0.5 * (z[1:] + z[:-1]) - ALTITUDE
    cosine = (middle_x * dz - middle_z * dx) / np.hypot(dx, dz) / np.hypot(middle_x, middle_z)
    flat_cosine = ALTITUDE / np.hypot(ground_ranges(ratio.size), ALTITUDE)
    if law == "light":
        found, expected = cosine, ratio * flat_cosine
    else:
        found, expected = cosine**2 * np.hypot(dx, dz) / dr, ratio * flat_cosine**2 * STEP / dr
    far = r[1:] > 1.01 * FROM * ALTITUDE
    np.testing.assert_allclose(found[far], expected[far], rtol=2e-6)


def test_dunes_grow_smoothly_from_nadir_and_lie_about_the_level():
    x, z = equivalent_profile(wavy(0.25), ALTITUDE, STEP, "light")
    assert (np.diff(x) > 0.0).all()
    slope = np.diff(z) / np.diff(x)
    assert np.abs(np.diff(slope)).max() < 1e-3  # no kink
    assert abs(slope[0]) < 1e-4
    assert -0.6 < z.min() < -0.1 < 0.1 < z.max() < 0.6
    assert np.degrees(np.arctan(np.abs(slope).max())) < 15.0


def pair(changes=None, level=None, dunes=None):
    """Simulations of both scenes of the figure, with changes to both and to each."""
    scenes = load_scene("figure-5-pattern"), load_scene("figure-5-relief")
    made = (edit(scene, (changes or {}) | (own or {})) for scene, own in zip(scenes, (level, dunes)))
    return [prepare(scene, forced={"spacing": "1"}) for scene in made]  # every node of both grids


def difference(one, other):
    """Norm of the difference over that of the record beyond 1.4 altitudes, worse side."""
    first = math.ceil(FROM * one.scene.altitude / 0.05) + 1
    a, b = (simulation.intensity(np.array([3]))[0, :, first:].astype(float) for simulation in (one, other))
    return (np.linalg.norm(b - a, axis=1) / np.linalg.norm(a, axis=1)).max()


def test_the_figures_differ_in_their_bed_alone():
    level, dunes = (load_scene(f"figure-5-{name}") for name in ("pattern", "relief"))
    same = {"title", "description", "controls", "partner", "seabed"}
    assert level.model_dump(exclude=same) == dunes.model_dump(exclude=same)
    assert dunes.seabed.relief.of == level.seabed.material
    assert dunes.altitude == dunes.seabed.relief.altitude
    assert (level.seabed.depth, level.seabed.spacing) == (dunes.seabed.depth, dunes.seabed.spacing)


@pytest.mark.parametrize(
    ("changes", "least", "most"),
    [({}, 0.0, 4e-4), ({"track.altitude": 25.0}, 0.05, 0.1), ({"sonar.law": "sonar"}, 0.03, math.inf)],
    ids=["as solved", "another altitude", "another law"],
)
def test_one_trace_has_two_interpretations_at_the_altitude_and_by_the_law_of_the_relief(changes, least, most):
    """From 25 m the difference is 6.9 % of the record, 7.3 % of each bin in the mean square."""
    assert least < difference(*pair(changes)) < most


@pytest.mark.parametrize("law", ["light", "sonar"])
def test_a_finer_grid_brings_the_records_together(law):
    """Cells of even slope and material: 0.14, 0.05, 0.03 and 0.012 % apart under law `light`."""
    grids = ({"seabed.spacing": spacing, "sonar.law": law} for spacing in (0.1, 0.05, 0.025, 0.0125))
    found = [difference(*pair(grid, dunes={"seabed.relief.law": law})) for grid in grids]
    assert found == sorted(found, reverse=True)
    assert found[0] < 2e-3
    assert found[-1] < 1.5e-4


@pytest.mark.parametrize("law", ["light", "sonar"])
def test_stripes_pass_too_and_a_fan_is_deceived_as_a_knife_is(law):
    sonar, relief = {"sonar.law": law}, {"seabed.relief.law": law}
    level, dunes = {"seabed.material.shape": "stripes"}, relief | {"seabed.relief.of.shape": "stripes"}
    assert difference(*pair(sonar | {"seabed.spacing": 0.0125}, level, dunes)) < 2e-3
    fan = sonar | {"sonar.beam": {"kind": "fan", "width": 2.5}}
    assert difference(*pair(fan, dunes=relief)) < 1e-3


def test_a_pattern_too_bright_for_any_slope_is_refused():
    bright = [{"diffuse": 0.1, "specular": 0.0}, {"diffuse": 0.9, "specular": 0.0}]
    dunes = {"kind": "mimic", "of": {"of": bright}}
    with pytest.raises(SceneError, match=r"reflects 1\.8 times the mean 0\.5, more than .*; keep it below 1\.4 times"):
        build_ground(build({"seabed": {"relief": dunes}}))
    build_ground(build({"seabed": {"relief": dunes | {"law": "sonar"}}}))
