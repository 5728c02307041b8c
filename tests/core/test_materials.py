"""Named materials against the table they come from, and what they pass on to the tracers."""

import math
from itertools import pairwise

import numpy as np
import pytest

from insonify.kernels.common.scattering import backscatter
from insonify.scene import build, edit, load_scene
from insonify.scene.seabed.materials import Material
from insonify.scene.seabed.materials.catalogue import MATERIALS, Reflectivity
from insonify.simulation import prepare

GRAZING = (10.0, 20.0, 30.0, 45.0, 60.0)
# Jackson model at 300 kHz: R0, S_b in dB at those grazing angles, 10 log μ of the Lambert fit at 30°.
TABLE: dict[str, tuple[float, tuple[float, ...], float]] = {
    "silt": (0.063, (-35.7, -31.8, -29.9, -28.3, -27.4), -23.9),
    "fine_sand": (0.233, (-34.5, -25.5, -23.5, -22.6, -20.4), -17.5),
    "medium_sand": (0.370, (-29.8, -21.6, -18.2, -18.7, -16.8), -12.2),
    "coarse_sand": (0.472, (-26.9, -18.6, -15.0, -15.1, -15.0), -9.0),
    "sandy_gravel": (0.538, (-19.1, -12.0, -11.2), -5.2),
    "cobble": (0.636, (-21.3, -12.4, -11.4), -5.4),
    "rock": (0.704, (-20.2, -14.7, -13.5), -7.5),
}


def decibels(name: str, grazing: float) -> float:
    """Backscattering strength of a named material."""
    return 10.0 * math.log10(backscatter(math.sin(math.radians(grazing)), *MATERIALS[name].reflectivity[:3]))


@pytest.mark.parametrize("name", TABLE)
def test_numbers_are_those_of_the_table(name):
    """Lambert's law is a fit at 30° grazing; sands shine less than it when steeper.

    Farthest: silt -3.4 dB at 10°, coarse sand +4.8 dB at 60°.
    """
    reflection, strengths, fit = TABLE[name]
    numbers = MATERIALS[name].reflectivity
    assert numbers.reflection == pytest.approx(reflection, abs=6e-4)
    assert 10.0 * math.log10(numbers.diffuse / math.pi) == pytest.approx(fit, abs=0.06)
    # At 30° the lobe is gone: what remains is the fit.
    assert decibels(name, 30.0) == pytest.approx(strengths[2], abs=0.06)
    assert numbers.specular == pytest.approx(min(reflection**2, 1.0 - numbers.diffuse), abs=7e-4)
    far = {angle: decibels(name, angle) - value for angle, value in zip(GRAZING, strengths)}
    assert abs(far[20.0]) < 2.6, far
    assert max(map(abs, far.values())) < 5.0, far


def test_coarser_sediments_reflect_more_and_blur_the_lobe_and_none_returns_more_than_arrives():
    sediments = [MATERIALS[name].reflectivity for name in TABLE]
    assert all(a.reflection < b.reflection for a, b in pairwise(sediments))
    assert all(a.shininess >= b.shininess for a, b in pairwise(sediments))
    muds_and_sands = [row.diffuse for row in sediments[:5]]
    assert muds_and_sands == sorted(muds_and_sands)
    for name in MATERIALS:
        numbers = MATERIALS[name].reflectivity
        assert numbers.diffuse + numbers.specular <= 1.0 + 1e-9, name
        assert 0.0 <= numbers.reflection <= 1.0, name
    mirror = MATERIALS["mirror"].reflectivity
    assert (mirror.diffuse, mirror.specular, mirror.reflection) == (0.0, 1.0, 1.0)


@pytest.mark.parametrize("name", ["medium_sand", "rock", "mirror"])
def test_the_lobe_of_a_level_bed_is_the_echo_of_the_mirror_image(name):
    _, specular, shininess = MATERIALS[name].reflectivity[:3]
    altitude = 10.0
    incidence = np.linspace(0.0, math.pi / 4, 20001)
    ring = 2.0 * math.pi * altitude**2 * np.tan(incidence) / np.cos(incidence) ** 2
    echo = [
        backscatter(math.cos(a), 0.0, specular, shininess) * r / (altitude / math.cos(a)) ** 4
        for a, r in zip(incidence, ring)
    ]
    image = specular / (2.0 * altitude) ** 2
    assert np.trapezoid(echo, incidence) == pytest.approx(image * (1.0 + 0.5 / (shininess + 1.0)), rel=1e-4)


def test_sediments_side_by_side_are_as_loud_as_their_numbers_say():
    scene = edit(load_scene("sediments"), {"seabed.relief": "flat", "sonar.beam": "knife"})
    step = scene.track.speed / scene.sonar.ping_rate
    pings = np.array([round((10.0 * k + 5.0) / step) for k in range(7)])
    far = prepare(scene).intensity(pings)[:, :, 600:].astype(float)  # beyond the lobes
    diffuse = np.array([MATERIALS[name].reflectivity_at(scene.sonar.frequency).diffuse for name in TABLE])
    np.testing.assert_allclose(far / far[6], np.tile((diffuse / diffuse[6])[:, None, None], far.shape[1:]), rtol=1e-3)


def test_given_numbers_override_the_name():
    numbers = Material(name="rock", diffuse=0.1, reflection=0.2, speed_ratio=1.5, speckle_shape=4.0).reflectivity
    rock = MATERIALS["rock"].reflectivity
    assert numbers == Reflectivity(0.1, rock.specular, rock.shininess, 0.2, 1.5, 4.0)
    assert Material(name="rock").reflectivity.speckle_shape is None


def test_interfaces_follow_the_ground_and_then_the_targets():
    patches = {"kind": "patches", "of": ["silt", {"name": "rock", "reflection": 0.5}]}
    balls = [
        {"kind": "sphere", "position": [0.0, y], "material": material}
        for y, material in ((10.0, "mirror"), (20.0, {"name": "steel", "speed_ratio": 3.0}))
    ]
    arrays = prepare(build({"seabed": {"material": patches}, "targets": balls})).arrays
    silt, rock, steel = MATERIALS["silt"].reflectivity, MATERIALS["rock"].reflectivity, MATERIALS["steel"].reflectivity
    np.testing.assert_array_equal(
        arrays.interface,
        [(silt.reflection, silt.speed_ratio), (0.5, rock.speed_ratio), (1.0, 1.0), (steel.reflection, 3.0)],
    )
    assert arrays.interface.shape[0] == arrays.reflectivity.shape[0]
