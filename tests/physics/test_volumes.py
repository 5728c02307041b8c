"""Schools and plumes: their energy by the sonar equation, where they lie, and their speckle."""

import math

import numpy as np
import pytest

from insonify.receiver.water_column import WaterColumn
from insonify.scene import SceneError, edit, scene_from_toml, scene_to_toml
from insonify.simulation import prepare, simulate
from receptions import RAYLEIGH, scene_with, variation

SCHOOL = {"kind": "school", "position": [10.0, 15.0, -25.0], "length": 6.0, "width": 4.0, "height": 3.0}
PLUME = {"kind": "plume", "position": [10.0, -20.0, -30.0], "height": 12.0, "radius": 1.0}
BARE = {
    "seabed__relief": "flat", "seabed__material": {"diffuse": 0.0, "specular": 0.0}, "targets": [],
    "track__pings": 100, "sonar__pulse": "ideal",
}  # fmt: skip


def scene(*volumes, **changes):
    return scene_with(**BARE | {"volumes": list(volumes)} | changes)


def record(*volumes, **changes):
    return simulate(scene(*volumes, **changes)).intensity.values.astype(float)


@pytest.mark.parametrize(("volume", "cubic_metres"), [(SCHOOL, math.pi * 12.0), (PLUME, math.pi * 4.0)])
def test_samples_fill_the_volume_evenly(volume, cubic_metres):
    declared = scene(volume).volumes[0]
    points, each = declared.sample()
    assert each * len(points) == pytest.approx(cubic_metres)
    own = points - np.array(declared.position)
    if declared.kind == "school":
        radii = np.linalg.norm(own / np.array([3.0, 2.0, 1.5]), axis=1)
        assert radii.max() <= 1.0
        assert (radii < 0.5).mean() == pytest.approx(1.0 / 8.0, abs=0.005)
    else:
        assert (np.hypot(own[:, 0], own[:, 1]) <= own[:, 2] / 12.0 + 1e-12).all()
        assert (own[:, 2] < 6.0).mean() == pytest.approx(1.0 / 8.0, abs=0.005)


@pytest.mark.parametrize("beam", ["knife", {"kind": "fan", "width": 1.0}, {"kind": "gaussian", "width": 1.0}])
@pytest.mark.parametrize("volume", [SCHOOL, PLUME])
def test_the_energy_is_that_of_the_sonar_equation(volume, beam):
    # Σ over pings and bins of E r⁴, at a pitch of d between pings: s_v V times the beam's width at r, over d.
    pitch, sv = 0.2, 10.0**-2.5
    found = record(volume, sonar__beam=beam)
    r = (np.arange(1000) + 0.5) * 0.05
    points, each = scene(volume).volumes[0].sample()
    y, z = points[:, 1], points[:, 2] + 20.0  # the sonar's height over the bed 30 m deep is 10 m
    abeam = np.hypot(y, z)
    if beam == "knife":
        width = np.ones(abeam.size)
    elif beam["kind"] == "fan":
        width = 2.0 * math.tan(math.radians(0.5)) * abeam
    else:  # two-way Gaussian of −3 dB half width: ∫ 2^(−2 (s/s₃)²) ds
        width = math.sin(math.radians(0.5)) * math.sqrt(math.pi / (2.0 * math.log(2.0))) * abeam
    expected = (sv * each * width / pitch).sum()
    side = 0 if volume["position"][1] > 0.0 else 1
    total = (found * r**4).sum(axis=(1, 2))
    assert total[side] == pytest.approx(expected, rel=0.03)
    assert total[1 - side] == 0.0


def test_they_lie_where_they_are_and_under_the_bed_or_in_the_air_they_are_silent():
    heard = np.nonzero(record(SCHOOL)[0])
    r, x = (heard[1] + 0.5) * 0.05, heard[0] * 0.2
    y, z = 15.0, -5.0
    assert abs(r - math.hypot(y, z)).max() < 2.6
    assert 6.8 < x.min() < 7.2
    assert 12.8 < x.max() < 13.2
    leaning = np.nonzero(record(PLUME | {"drift": 5.0, "heading": 0.0})[1])
    assert 15.0 < leaning[0].max() * 0.2 < 16.5
    half = record(SCHOOL | {"position": [10.0, 15.0, -30.0]}).sum()
    high = record(SCHOOL | {"position": [10.0, 15.0, 0.0]}, track__altitude=20.0).sum()
    whole = record(SCHOOL | {"position": [10.0, 15.0, -26.0]}).sum()
    assert 0.25 * whole < half < 0.75 * whole
    assert high > 0.0
    assert not record(SCHOOL | {"position": [10.0, 15.0, -40.0]}).any()
    assert not record(SCHOOL | {"position": [10.0, 15.0, 10.0]}).any()


def test_their_speckle_is_rayleigh_s():
    school = SCHOOL | {"length": 60.0}
    dense, mean = record(school, receiver__speckle="rayleigh", track__speed=5.0), record(school, track__speed=5.0)
    inside = mean[0] > 0.2 * mean[0].max()
    energy = dense[0][inside] / mean[0][inside]
    assert variation(energy) == pytest.approx(RAYLEIGH, abs=0.02)
    assert energy.mean() == pytest.approx(1.0, abs=0.04)


def test_they_are_written_edited_and_refused():
    declared = scene(SCHOOL, PLUME)
    assert scene_from_toml(scene_to_toml(declared)) == declared
    assert edit(declared, {"volumes.1.radius": 2.0}).volumes[1].cubic_metres == pytest.approx(math.pi * 16.0)
    with pytest.raises(SceneError, match=r"^volumes.*law 'light'"):
        edit(declared, {"sonar.law": "light"})
    with pytest.raises(SceneError, match=r"volumes.*whale.*choose one of school, plume"):
        scene({"kind": "whale"})


LIVE = {"seabed__material": "medium_sand", "track__pings": 40}


def test_labels_name_the_volume_that_is_heard_most():
    """Against the mean echoes of the bed alone and of each volume alone."""
    bed = record(**LIVE)
    plumes = [PLUME | {"position": [x, -20.0, -30.0], "strength": sv} for x, sv in ((4.0, -18.0), (5.0, -15.0))]
    volumes = [SCHOOL | {"strength": -18.0}, *plumes]
    alone = [prepare(scene(volume, **LIVE)).reception.find(WaterColumn).volumes for volume in volumes]
    heard = np.array([np.moveaxis(one.energy(np.arange(40)), 1, 0) for one in alone])
    found = simulate(scene(*volumes, **LIVE), truth=True)
    ranked = np.sort([bed, *heard], axis=0)
    clear = (ranked[-1] > 1.02 * ranked[-2]) & (ranked[-1] > 0.0)
    loudest = np.argmax([bed, *heard], axis=0) - 1
    expected = np.where(loudest >= 0, loudest, -2)
    np.testing.assert_array_equal(found.volume_id.values[clear], expected[clear])
    assert set(np.unique(found.volume_id.values[clear])) == {-2, 0, 1, 2}
    assert found.volume_id.attrs["flag_meanings"] == "nothing school_0 plume_1 plume_2"
    # All that is told of the bed stays.
    plain = simulate(scene(**LIVE), truth=True)
    assert "volume_id" not in plain
    np.testing.assert_array_equal(found.target_id, plain.target_id)
    # A volume that leaks into the other side is named there.
    leaking = scene(SCHOOL, receiver__crosstalk=-20.0, track__pings=40)
    port, starboard = simulate(leaking, truth=True).volume_id.values == 0
    assert port.any()
    np.testing.assert_array_equal(starboard, port)
