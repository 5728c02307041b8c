"""Planes of the sonar's image in the sea surface: those of the sonar first, all azimuths in its beam taken in."""

import numpy as np
import pytest

from insonify.packing.packed_scene import pack
from insonify.scene import edit, load_scene
from insonify.tow.poses import make_poses
from insonify.tracers.azimuth_fan import lay_planes_of_images


@pytest.mark.parametrize("planes", [5, 8, 16, 33])
@pytest.mark.parametrize("beam", [{"kind": "fan", "width": 1.0}, {"kind": "array", "length": 0.3, "two_way": True}])
def test_the_image_of_a_level_fish_has_the_planes_of_the_fish(planes, beam):
    scene = edit(load_scene("ghosts"), {"sonar.beam": beam})
    packed = pack(scene)
    [(_, fan, image)] = lay_planes_of_images(packed.arrays, make_poses(scene, packed.ground, np.arange(4)), planes)
    for name in ("azimuth", "s_low", "s_high", "angle", "near_field"):
        np.testing.assert_array_equal(getattr(image, name)[: fan.azimuth.size], getattr(fan, name))
    if beam["kind"] == "fan":
        # From a greater height the same directions lead to places as much farther out, but for the grid of places.
        heard, near = image.reach[: fan.azimuth.size], fan.reach < 0.5
        np.testing.assert_allclose(heard[near], fan.reach[near], rtol=0.06)
    order = np.argsort(image.s_low)
    np.testing.assert_allclose(image.s_low[order][1:], image.s_high[order][:-1], atol=1e-12)
    assert image.s_low.min() == pytest.approx(-1.0)
    assert image.s_high.max() == pytest.approx(1.0)


def test_no_pings_have_no_planes():
    scene = load_scene("ghosts")
    packed = pack(scene)
    assert lay_planes_of_images(packed.arrays, make_poses(scene, packed.ground, np.arange(0)), 4) == []
