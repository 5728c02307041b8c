"""Kinds of somebody else's go the whole way: scene, plan, tracers, picture and command."""

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

import insonify
from insonify.acoustics.beam_patterns import make_pattern
from insonify.acoustics.pulses import coherence, coherent_taps, pulse_taps
from insonify.acoustics.water import absorption_coefficient
from insonify.cli import main
from insonify.scene import Scene, SceneError, edit, load_scene, scene_from_toml, scene_to_toml
from insonify.scene.seabed.materials import catalogue
from insonify.scene.seabed.materials.catalogue import MATERIALS, Catalogue, read_materials
from insonify.simulation import prepare
from insonify.statistics.record_errors import compare_records
from insonify.terrain import build_ground, relief
from insonify.tow.poses import make_poses
from insonify.tracers import rays, sweep
from own_kinds import OWN_MATERIALS, own_kinds, own_scene

CORAL = (OWN_MATERIALS / "coral.toml").read_text()
SEDIMENT = "sediment = { loss = 0.02, volume = 0.002, spectral_strength = 0.004, spectral_exponent = 3.2 }"


@pytest.fixture(autouse=True, scope="module")
def _known():
    with own_kinds():
        yield


@pytest.mark.parametrize(
    ("kind", "radius", "extents"),
    [("hoop", math.hypot(2.5, 2.5, 0.5), [2.5, 2.5, 0.5]), ("dumbbell", 2.1, [2.1, 0.6, 0.6])],
)
def test_a_shape_is_placed_and_measured(kind, radius, extents):
    scene = own_scene(kind)
    arrays, outline = prepare(scene).arrays, scene.targets[0].outline
    assert outline.radius == pytest.approx(radius)
    assert [outline.extent(axis) for axis in np.eye(3)] == pytest.approx(extents)
    if kind == "hoop":
        corners = arrays.mesh.corners
        found = [corners.min(axis=(0, 1)), corners.max(axis=(0, 1))]
        np.testing.assert_allclose(found, [[2.5, 15.5, 0.0], [7.5, 20.5, 1.0]], atol=1e-9)
        assert outline.triangles == len(corners)
    else:
        np.testing.assert_allclose(arrays.solids.start - [5.0, 18.0, 0.6], [[-1.5, 0, 0], [-1.5, 0, 0], [1.5, 0, 0]])


@pytest.mark.parametrize("kind", ["hoop", "dumbbell"])
def test_sweep_and_rays_hear_the_same(kind):
    simulation = prepare(own_scene(kind))
    poses = simulation.poses(np.array([20, 25, 32]))
    swept = sweep.trace(simulation.arrays, poses, planes=64)
    traced = rays.trace(simulation.arrays, poses, rays=60000)
    assert compare_records(simulation.arrays, poses, swept, traced).beyond < 0.05
    bare = prepare(edit(own_scene(kind), {"targets": []}))
    without = sweep.trace(bare.arrays, poses, planes=64)
    assert compare_records(simulation.arrays, poses, without, swept).beyond > 0.3


def test_the_plan_and_the_truth_take_it_into_account():
    chosen = insonify.plan(own_scene())
    targets = next(entry for entry in chosen.entries if entry.subject == "targets")
    assert "with 6,144 triangles" in targets.reason
    truth = insonify.simulate(own_scene(), truth=True)
    assert "hoop_0" in truth.target_id.attrs["flag_meanings"]
    assert "coral" in truth.material.attrs["flag_meanings"]


@pytest.mark.parametrize(
    "relief", [{"kind": "flat"}, {"period": 25.6}, {"extent": "endless", "clamp": "soft", "coefficients": "gaussian"}]
)
def test_a_map_is_laid_on_every_kind_of_bed(relief):
    material = {"kind": "halves", "of": ["silt", "coral"], "border": 3.0}
    scene = edit(own_scene(), {"seabed.relief": {"kind": "fractal"} | relief, "seabed.material": material})
    ground = build_ground(scene)
    assert ground.names == ("silt", "coral")
    near = ground.around((0.0, 6.0), 5.0)
    assert set(np.unique(near.materials)) == {0, 1}
    assert insonify.plan(scene).entries
    record = insonify.simulate(edit(scene, {"track.pings": 2}))
    assert np.isfinite(record.intensity).all()


def test_a_material_has_the_numbers_of_its_table_and_packages_announce_folders_of_them(monkeypatch):
    coral = MATERIALS["coral"]
    impedance = 2.1 * 1.9
    assert coral.reflectivity.reflection == pytest.approx((impedance - 1.0) / (impedance + 1.0))
    assert coral.reflectivity[:3] == coral.reflectivity_at(100e3)[:3] == (0.7, 0.2, 12.0)
    assert "coral" in list(MATERIALS)
    entry = SimpleNamespace(load=lambda: str(OWN_MATERIALS))
    monkeypatch.setattr(catalogue, "announced", lambda group: [entry] if group == "insonify.materials" else [])
    assert set(Catalogue()) == set(MATERIALS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[chalk]\ndiffuse = 2.0", ["chalk.toml: chalk.diffuse: 2.0", "less than or equal to 1"]),
        ("[chalk]\ncolor = 1", ["chalk.toml: chalk.diffuse"]),
        ("[chalk", ["chalk.toml", "not valid TOML"]),
        (CORAL.replace("0.2", "0.4"), ["chalk.toml: coral: ", "exceed 1, the energy that arrives"]),
        (f"{CORAL}\n{SEDIMENT}".replace("2.1", "inf"), ["chalk.toml: coral: ", "is not a sediment"]),
        (f"{CORAL}\n{SEDIMENT}".replace("0.02", "-1"), ["chalk.toml: coral.sediment.loss: -1"]),
    ],
)
def test_a_wrong_material_is_told_by_its_file_and_field(tmp_path: Path, text: str, words: list[str]):
    (tmp_path / "chalk.toml").write_text(text)
    with pytest.raises(SceneError) as caught:
        read_materials(tmp_path)
    assert all(word in str(caught.value) for word in words)
    assert "\n" not in str(caught.value)


SMALL = {"targets": [], "sonar.range": 30.0, "sonar.bins": 150, "track.pings": 40}
BAND = {"kind": "band", "wavelength": 4.0, "rms": 0.1, "period": 51.2}


def scene_of(**changes: object) -> Scene:
    return edit(load_scene("default"), SMALL | {path.replace("__", "."): value for path, value in changes.items()})


def test_a_relief_has_the_spectrum_that_it_says_and_is_masked_added_up_and_checked_as_others():
    for extent, error in (("periodic", 1e-6), ("endless", 0.1)):
        scene = scene_of(seabed__relief=BAND | {"extent": extent})
        heights = relief(scene.seabed, (512, 512))
        assert heights.std() == pytest.approx(0.1, rel=error)
        power = np.abs(np.fft.fft2(heights)) ** 2
        f = np.hypot(*np.meshgrid(*[np.fft.fftfreq(512, scene.seabed.spacing)] * 2))
        assert (power * f).sum() / power.sum() == pytest.approx(0.25, rel=0.1)
    patches = {"kind": "patches", "share": 0.3, "softness": 0.05}
    masked = relief(scene_of(seabed__relief=BAND | {"mask": patches}).seabed)
    assert (masked == 0.0).mean() == pytest.approx(0.7, abs=0.15)
    total = {"kind": "sum", "of": [BAND, BAND | {"wavelength": 2.0}]}
    assert relief(scene_of(seabed__relief=total).seabed).std() == pytest.approx(math.hypot(0.1, 0.1), rel=0.05)
    with pytest.raises(SceneError, match=r'relief\.period .* cells a side; .* extent = "endless"'):
        scene_of(seabed__relief=BAND | {"period": 1e5})


def test_finer_waves_and_wider_beams_of_any_kind_ask_for_more_planes():
    def planes(**changes: object) -> int:
        return insonify.plan(scene_of(**{"seabed__relief": BAND} | changes), 0.005).settings["planes"]

    assert planes(seabed__relief=BAND | {"wavelength": 1.0}) > 2 * planes()
    narrow, wide = ({"kind": "parabola", "width": width} for width in (1, 8))
    assert planes(sonar__beam=wide) > planes(sonar__beam=narrow)


def test_a_bed_is_as_its_heights():
    ground = build_ground(scene_of(seabed__relief={"kind": "terrace", "height": 2.0}))
    np.testing.assert_allclose(ground.height_at(np.zeros(2), np.array([10.0, 30.0])), [0.0, 2.0])
    record = insonify.simulate(scene_of(seabed__relief="terrace"), tolerance=0.1)
    assert np.isfinite(record.intensity).all()


def test_a_beam_has_the_response_that_it_says_and_a_pulse_spreads_the_energy_of_its_envelope():
    half_width, pattern = make_pattern(scene_of(sonar__beam={"kind": "parabola", "width": 4.0}), 1500.0)
    assert half_width == pytest.approx(math.radians(2.0))
    s = np.linspace(-1.0, 1.0, pattern.energy.shape[1])
    np.testing.assert_allclose(pattern.energy[0], (1.0 - s**2) ** 2, atol=1e-12)
    # ∫(1 − s²)² ds = 16/15 of half the extent.
    assert pattern.integral[0, -1] == pytest.approx(16.0 / 15.0 * math.sin(half_width), rel=1e-4)
    pulse = scene_of(sonar__pulse={"kind": "decay", "time": 1e-4}).sonar.pulse
    taps = pulse_taps(pulse, 1500.0, 0.01)
    assert taps.before == 0
    # ∫ exp(−2t/τ) dt = τ/2, of which half the sound's way counts, in bins.
    assert taps.weights.sum() == pytest.approx(0.5 * 1500.0 * 0.5e-4 / 0.01, rel=1e-3)
    lags = np.arange(20)
    np.testing.assert_allclose(coherence(pulse, 1500.0, 0.01)[:20], np.exp(-lags * 0.01 / (750.0 * 1e-4)), atol=2e-3)
    assert np.linalg.norm(coherent_taps(pulse, 1500.0, 0.01)) == pytest.approx(1.0)


def test_an_absorption_is_heard():
    scene = scene_of(water__absorption={"kind": "square", "factor": 5.0})
    assert absorption_coefficient(scene.water.absorption, 4e5, 0.0) == pytest.approx(0.08 * math.log(10.0) / 20.0)
    near, far = (insonify.simulate(one, tolerance=0.1).intensity.mean() for one in (scene_of(), scene))
    assert far < 0.8 * near


def test_a_motion_moves_the_fish():
    scene = scene_of(track__motion={"kind": "sum", "of": [{"kind": "drift", "speed": 0.5}, {"kind": "heave"}]})
    poses = make_poses(scene, build_ground(scene), np.array([0, 20]))
    assert np.diff(poses.y) == pytest.approx(0.5 * 20 / scene.sonar.ping_rate)


def test_speckle_of_few_scatterers_is_spikier_than_rayleigh():
    spread = {}
    for kind in ("rayleigh", "grains"):
        record = insonify.simulate(scene_of(seabed__relief="flat", receiver__speckle={"kind": kind}), tolerance=0.1)
        bins = record.intensity.values[:, :, 80:]
        spread[kind] = float((bins / bins.mean(axis=1, keepdims=True)).var())
    assert spread["grains"] > 1.5 * spread["rayleigh"]


def test_all_of_them_go_through_files_commands_and_records(tmp_path: Path):
    scene = scene_of(
        seabed__relief=BAND,
        sonar__beam="parabola",
        sonar__pulse="decay",
        water={"kind": "gradient", "absorption": {"kind": "square"}},
        track__motion={"kind": "drift"},
        targets=own_scene().targets,
    )
    assert scene_from_toml(scene_to_toml(scene)) == scene
    file = tmp_path / "own.toml"
    file.write_text(scene_to_toml(scene))
    changes = ["seabed.relief.wavelength=3.0", "sonar.pulse.time=1e-4", "water.absorption.factor=2.0"]
    changes += ["targets.0.tube=0.8", "track.pings=3"]
    words = [str(file), *(word for change in changes for word in ("--set", change))]
    for name in ("own.nc", "own.png"):
        assert main(["render", *words, "-o", str(tmp_path / name)]) == 0
    assert main(["plan", *words]) == 0
    with xr.open_dataset(tmp_path / "own.nc") as record:
        kept = scene_from_toml(record.attrs["scene"])
        found = kept.seabed.relief.wavelength, kept.sonar.pulse.time, kept.targets[0].tube
        assert found == (3.0, 1e-4, 0.8)
        assert (record.intensity.values > 0.0).any()
    for path in ("sonar.beam.width", "targets.0.tube"):
        with pytest.raises(SceneError, match=rf"{path}: -1 is out of bounds"):
            edit(scene, {path: -1})
    with pytest.raises(SceneError, match=r"choose one of knife, fan, gaussian, array, parabola$"):
        scene_of(sonar__beam="nonsense")  # kinds of others stand behind those of the package
