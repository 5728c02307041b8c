"""Vertical beams by a table and of an array: their patterns, and what they take from a level bed."""

import math

import numpy as np
import pytest

from insonify.acoustics.beam_patterns import make_pattern
from insonify.kernels.beam.pattern import vertical_responses
from insonify.scene import SceneError, edit, load_scene
from insonify.simulation import simulate

FREQUENCY, SPEED = 400e3, 1500.0
WAVELENGTH = SPEED / FREQUENCY
DOWN = np.radians(np.linspace(0.0, 89.0, 300))  # depressions


def responses(vertical, **changes):
    """Two-way response at depressions."""
    scene = edit(load_scene("default"), {"sonar.vertical": vertical} | changes)
    _, pattern = make_pattern(scene, SPEED)
    out = np.empty(DOWN.size)
    vertical_responses(pattern, -DOWN, out)
    return out


@pytest.mark.parametrize("height", [0.005, 0.02, 0.2])
def test_a_uniform_array_has_its_lobes(height):
    # One way sin²(x)/x² with x = πh sin(angle)/λ, two ways its square (Urick 1983, ch. 3).
    exact = np.sinc(height / WAVELENGTH * np.sin(DOWN - math.radians(30.0))) ** 4
    np.testing.assert_allclose(responses({"kind": "array", "height": height, "tilt": 30.0}), exact, atol=4e-3)


def test_a_taper_lowers_the_sidelobes():
    far = np.abs(np.sin(DOWN - math.radians(30.0))) > 2.2 * WAVELENGTH / 0.02
    uniform, hamming = (
        responses({"kind": "array", "height": 0.02, "tilt": 30.0, "taper": taper})[far].max()
        for taper in ("uniform", "hamming")
    )
    assert hamming < 1e-3 * uniform


def test_a_table_is_what_was_measured():
    levels = [[-90.0, -40.0], [-20.0, -10.0], [0.0, 0.0], [40.0, -6.0]]
    found = responses({"kind": "table", "tilt": 25.0, "levels": levels})
    one_way = np.interp(np.degrees(DOWN) - 25.0, *np.array(levels).T)
    np.testing.assert_allclose(10.0 * np.log10(found), 2.0 * one_way, atol=0.02)


def test_a_one_way_beam_takes_a_table_once():
    levels = [[-90.0, -40.0], [90.0, 0.0]]
    changes = {"sonar.beam": {"kind": "gaussian", "two_way": False}}
    twice, once = (responses({"kind": "table", "levels": levels}, **c) for c in ({}, changes))
    np.testing.assert_allclose(once**2, twice, rtol=1e-5)


def test_angles_out_of_order_are_refused():
    with pytest.raises(SceneError, match=r"^sonar\.vertical\.levels.* increasing angle"):
        edit(load_scene("default"), {"sonar.vertical": {"kind": "table", "levels": [[10.0, 0.0], [0.0, 0.0]]}})


GAUSSIAN = {"kind": "gaussian", "width": 40.0, "tilt": 25.0}
BEAMS = {two_way: {"sonar.beam": {"kind": "gaussian", "width": 1.0, "two_way": two_way}} for two_way in (False, True)}
ROLL = {"track.motion": {"kind": "roll", "amplitude": 8.0, "period": 1e5, "phase": 90.0}}


def level_records(vertical, changes, method="sweep"):
    """Records of a level bed with a vertical beam and without, and depressions of their bins beyond 11 m."""
    level = {
        "seabed.relief": "flat", "seabed.material": {"diffuse": 0.5, "specular": 0.0}, "targets": [],
        "sonar.pulse": "ideal", "sonar.bins": 500, "track.pings": 1, "track.altitude": 10.0,
    }  # fmt: skip
    shaded, plain = (
        simulate(edit(load_scene("default"), level | changes | {"sonar.vertical": beam}), method=method, tolerance=0.01)
        for beam in (vertical, "uniform")
    )
    down = np.arcsin(10.0 / plain.slant_range.values[110:])
    return shaded.intensity.values[:, 0, 110:], plain.intensity.values[:, 0, 110:], down


@pytest.mark.parametrize("vertical", [{"kind": "array", "height": 0.012, "tilt": 20.0}, {"kind": "table"}])
@pytest.mark.parametrize("method", ["sweep", "rays"])
def test_a_level_bed_is_shaded_by_it(vertical, method):
    shaded, plain, down = level_records(vertical, {}, method)
    _, pattern = make_pattern(edit(load_scene("default"), {"sonar.vertical": vertical}), SPEED)
    exact = np.empty(down.size)
    vertical_responses(pattern, -down, exact)
    np.testing.assert_allclose(shaded[0] / plain[0], exact, atol=0.01)


def test_a_top_hat_hears_what_is_within_it_and_nothing_else():
    shaded, plain, down = level_records({"kind": "fan", "width": 30.0, "tilt": 30.0}, {})
    off = np.abs(np.degrees(down) - 30.0)
    assert not shaded[:, off > 16.0].any()
    np.testing.assert_allclose(shaded[:, off < 14.0], plain[:, off < 14.0], rtol=3e-3)


@pytest.mark.parametrize(
    ("changes", "passes", "tilts"),
    [
        (BEAMS[False], 1.0, (25.0, 25.0)),
        (BEAMS[True], 2.0, (25.0, 25.0)),
        (ROLL, 2.0, (17.0, 33.0)),  # port up
    ],
    ids=["one way", "two way", "rolled"],
)
def test_a_gaussian_weighs_a_level_bed_by_its_value(changes, passes, tilts):
    shaded, plain, down = level_records(GAUSSIAN, changes)
    off = np.sin(down - np.radians(tilts)[:, None]) / math.sin(math.radians(20.0))
    np.testing.assert_allclose((shaded / plain)[:, 10:], 2.0 ** (-passes * off**2)[:, 10:], rtol=0.01)
