"""The sweep over a level bed, against integrals done by hand."""

import math
from functools import partial

import numpy as np
import pytest

from beds import arrays_of, gaussian_pattern, poses_of
from brute_force import strength
from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.packing.packed_scene import pack
from insonify.planning import plan
from insonify.planning.probe import trace_model
from insonify.scene import edit, load_scene
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.simulation import prepare
from insonify.tow.poses import make_poses
from insonify.tracers import rays, sweep
from insonify.tracers.azimuth_fan import FORESHORTENED

MATERIAL = Reflectivity(0.6, 0.3, 5.0)
flat = partial(arrays_of, np.zeros((4, 4)), 0.1, periodic=True)
ALTITUDE = 10.02
TRACERS = ["sweep", "rays"]
many_rays = partial(rays.trace, rays=79950)
NEAR_FIELD_END = ALTITUDE / math.sqrt(1.0 - (1.0 - FORESHORTENED) ** 2)


def integral(law, half_width, altitude=ALTITUDE, bins=1000, bin_length=0.05, material=MATERIAL, decay=0.0):
    """What every bin hears of a level bed: rings of slant range, dA = φ r dr, cut by the beam's cone."""
    samples = 400
    r = (np.arange(bins * samples) + 0.5) * bin_length / samples
    heard = r > altitude
    cos_incidence = np.where(heard, altitude / r, 0.0)
    density = strength(cos_incidence, material, law)
    if law == LIGHT:
        density /= bin_length
    else:
        cos_grazing = np.sqrt(1.0 - cos_incidence**2)
        azimuths = 2.0 * np.arcsin(np.minimum(math.sin(half_width) / cos_grazing, 1.0))
        width = azimuths * r if half_width > 0.0 else 1.0 / cos_grazing
        density *= width * r**-decay
    return np.where(heard, density, 0.0).reshape(bins, samples).sum(axis=1) * bin_length / samples


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("width", [0.0, 0.01, 0.5, 2.5, 10.0, 30.0, 60.0])
@pytest.mark.parametrize("planes", [2, 16])
def test_every_bin_is_its_integral(law, width, planes):
    arrays = flat(law=law, half_width=math.radians(width / 2.0), reflectivity=[MATERIAL])
    port, starboard = sweep.trace(arrays, poses_of(3.0, 5.0, ALTITUDE, 0.7), planes=planes)[0]
    expected = integral(law, arrays.half_width)
    assert not port[:200].any()
    np.testing.assert_allclose(starboard, port, rtol=1e-6)
    ratio = port[200:] / expected[200:]
    # Nadir's first bin takes in all azimuths; one segment may lie across the near field's end.
    assert ratio[0] == pytest.approx(1.0, abs=0.04)
    border = slice(*(int(NEAR_FIELD_END / 0.05) - 200 + k for k in (-4, 5)))
    np.testing.assert_allclose(ratio[border], 1.0, atol=0.04)
    ratio[border] = 1.0
    np.testing.assert_allclose(ratio[1:], 1.0, atol=0.02)
    if width <= 2.5:
        np.testing.assert_allclose(ratio[6:], 1.0, atol=0.006)
    assert port.sum(dtype=float) == pytest.approx(expected.sum(), rel=0.005)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("width", [0.5, 2.5, 10.0])
def test_one_plane_stands_for_a_whole_fan(law, width):
    arrays = flat(law=law, half_width=math.radians(width / 2.0), reflectivity=[MATERIAL])
    port = sweep.trace(arrays, poses_of(3.0, 5.0, ALTITUDE, 0.7), planes=1)[0, 0]
    ratio = port[200:] / integral(law, arrays.half_width)[200:]
    np.testing.assert_allclose(ratio[8:], 1.0, atol=0.004)


@pytest.mark.parametrize(
    ("beam", "bound"),
    [
        ({"kind": "gaussian", "width": 1.5}, 0.002),
        ({"kind": "gaussian", "width": 1.0, "two_way": True}, 0.002),
        # The azimuth of a squinted cone's axis changes with range, that of a plane does not.
        ({"kind": "fan", "width": 1.0, "squint": 12.0}, 0.03),
        ({"kind": "array", "length": 0.3}, 0.002),
    ],
)
def test_one_plane_stands_for_a_whole_pattern(beam, bound):
    scene = edit(load_scene("default"), {"seabed.relief": "flat", "targets": [], "sonar.beam": beam})
    simulation = prepare(scene)
    poses = simulation.poses(np.zeros(1, dtype=np.int64))
    one, many = (sweep.trace(simulation.arrays, poses, planes=planes)[0, 0] for planes in (1, 64))
    np.testing.assert_allclose(one[280:] / many[280:], 1.0, atol=bound)


@pytest.mark.parametrize("planes", [1, 16, 256])
@pytest.mark.parametrize("pitch", [0.0, 4.0])
@pytest.mark.parametrize("squint", [0.0, -5.0, 10.0, 20.0])
def test_light_of_a_level_bed_does_not_depend_on_where_the_beam_points(squint, pitch, planes):
    """Law `light` averages over the beam: H / r, whatever its squint and the pitch of the fish."""
    pattern = gaussian_pattern(math.radians(3.0), squint=math.radians(squint))
    arrays = flat(law=LIGHT, half_width=math.radians(3.0), pattern=pattern)
    record = sweep.trace(arrays, poses_of(3.0, 5.0, ALTITUDE, 0.7, math.radians(pitch)), planes=planes)[0]
    radiance = ALTITUDE / ((np.arange(1000) + 0.5) * 0.05)
    # Nearer, the beam's cone may miss the bed, or graze it over many azimuths at once.
    near = int(ALTITUDE / math.cos(math.radians(abs(squint) + pitch + 8.0)) / 0.05) + 2
    np.testing.assert_allclose(record[:, near:], np.tile(radiance[near:], (2, 1)), rtol=0.01)


@pytest.mark.parametrize("law", [LIGHT, SONAR])
@pytest.mark.parametrize("half_width", [0.0, 0.01])
def test_the_curve_is_the_integral(law, half_width):
    curve = flat_bed_curve(flat(law=law, half_width=half_width), ALTITUDE, MATERIAL)
    expected = integral(law, half_width)
    np.testing.assert_array_equal(curve > 0.0, expected > 0.0)
    np.testing.assert_allclose(curve[220:], expected[220:], rtol=3e-4)
    sharp = flat_bed_curve(flat(law=law, half_width=half_width), 49.0, Reflectivity(0.2, 0.5, 1000.0))
    np.testing.assert_array_equal(sharp > 0.0, np.arange(1000) >= 980, "overflows nowhere before the first return")


@pytest.mark.parametrize("altitude", [2.0, 9.99, 10.02, 25.0, 49.97])
@pytest.mark.parametrize("half_width", [0.0, 0.02])
@pytest.mark.parametrize("trace", [sweep.trace, partial(rays.trace, rays=4000)], ids=TRACERS)
def test_first_return_comes_from_the_altitude(altitude, half_width, trace):
    record = trace(flat(half_width=half_width), poses_of(1.0, 1.0, altitude))[0, 0]
    assert np.flatnonzero(record)[0] == int(altitude / 0.05)


@pytest.mark.parametrize(("trace", "bound"), [(sweep.trace, 2e-3), (many_rays, 1e-3)], ids=TRACERS)
def test_light_of_a_half_lit_bin_is_half_its_radiance(trace, bound):
    # The bed begins in the middle of bin 200.
    record = trace(flat(law=LIGHT), poses_of(0.0, 0.0, 10.025))[0, 0]
    assert record[200] == pytest.approx(0.5 * 10.025 / 10.0375, rel=bound)
    assert record[201] == pytest.approx(10.025 / 10.075, rel=bound)


@pytest.mark.parametrize("trace", [sweep.trace, many_rays], ids=TRACERS)
@pytest.mark.parametrize(("half_width", "order"), [(0.0, -6.0), (math.radians(1.25), -5.0)])
def test_a_knife_falls_as_60_log_r_and_a_fan_as_50(half_width, order, trace):
    # Far out, where cos θ is 1.
    sonar = {"bins": 2000, "half_width": half_width, "bin_length": 0.1, "spreading": True}
    record = trace(arrays_of(np.zeros((4, 4)), 0.5, periodic=True, **sonar), poses_of(0.0, 0.0, 4.0))[0, 0]
    r = (np.arange(2000) + 0.5) * 0.1
    slope = np.polyfit(np.log10(r[1000:]), np.log10(record[1000:]), 1)[0]
    assert slope == pytest.approx(order, abs=0.01)


CHANGES = {"targets": [], "seabed.relief": "flat", "track.altitude": 10.0, "track.pings": 1, "sonar.bins": 5000}
LEVEL = edit(load_scene("default"), CHANGES)


@pytest.mark.parametrize("material", [Reflectivity(0.3, 0.0, 1.0), Reflectivity(0.2, 0.5, 1000.0)])
@pytest.mark.parametrize("width", [10.0, 30.0, 60.0])
def test_the_first_return_of_a_wide_fan_is_as_its_integral(width, material):
    scene = edit(LEVEL, {"seabed.material": material._asdict(), "sonar.beam.width": width})
    packed, made = pack(scene), plan(scene)
    record = trace_model(packed, made.model, make_poses(scene, packed.ground, np.zeros(1, np.int64)))[0, 0]
    # Of the first 0.3 m: bins of 0.01 m.
    right = integral(SONAR, math.radians(0.5 * width), 10.0, 1030, 0.01, material, 4.0)
    assert record[1000:1030].sum() == pytest.approx(right.sum(), rel=0.02)
    assert made.planes == 1
    assert made.near_error < 0.03
