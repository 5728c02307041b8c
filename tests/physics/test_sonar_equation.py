"""The sonar equation, target strengths and levels of noise against hand calculations, theory and simulated records."""

import csv
import math
import warnings

import numpy as np
import pytest

from beds import icosphere
from insonify.acoustics.beam_patterns import directivity
from insonify.cli import main
from insonify.errors import FileWarning
from insonify.explanation.sonar_equation import solve_sonar_equation, write_sonar_equation
from insonify.receiver import receive
from insonify.receiver.levels import Noise
from insonify.scene import SceneError, edit, load_scene, scene_to_toml
from insonify.scene.receiver.noises import rain_noise, thermal_noise, wind_noise
from insonify.scene.water.absorptions import francois_garrison
from insonify.scene_edits import add_dependent_edits
from insonify.simulation import prepare, simulate
from receptions import decibels, scene_with

BARE = {"targets": [], "seabed__relief": "flat", "track__pings": 400}
BARE |= {"receiver__speckle": "none", "receiver__fluctuation": "none"}
DISTURBED = {"receiver.noise": {"kind": "density", "level": 55.0}, "receiver.source_level": 200.0}
QUIET = {"receiver.noise": "none", "receiver.reverberation": "none"}


def raw(**changes):
    """The scene raw-record over a level bed, without anything random but its noise."""
    return scene_with("raw-record", **BARE | changes)


SONARS = {
    "tone and fan": {},
    "chirp and array": {
        "sonar__beam": {"kind": "array", "length": 0.4, "taper": "hamming"},
        "sonar__pulse": {"kind": "chirp", "duration": 5e-4, "bandwidth": 40e3},
    },
    "vertical beam": {"sonar__vertical": {"kind": "gaussian", "tilt": 15.0, "width": 30.0}},
    "knife": {"sonar__beam": "knife"},
    "long tone": {"sonar__pulse": {"kind": "tone", "duration": 1e-3}},
}


@pytest.mark.parametrize("changes", SONARS.values(), ids=SONARS)
def test_it_is_the_mean_record_of_a_level_bed(changes):
    """The bed alone, noise alone and all together, within 0.1 dB from 1.4 altitudes on."""
    scene = edit(raw(**changes), DISTURBED)
    solved, _ = solve_sonar_equation(scene)
    beyond = solved.slant_range > 14.0
    quiet = edit(scene, {**QUIET, "receiver.tvg": "none"})
    bed = prepare(quiet, tolerance=0.005).intensity(np.arange(1))[0].astype(np.float64).mean(axis=0)
    np.testing.assert_allclose(solved.bed.decibels[beyond], decibels(bed[beyond]), atol=0.1)
    record = prepare(scene).intensity(np.arange(400)).astype(np.float64)
    mean = record.reshape(400, 2, -1, 50).mean(axis=(0, 1, 3))
    predicted = (10.0 ** (solved.record / 10.0)).reshape(-1, 50).mean(axis=1)
    np.testing.assert_allclose(decibels(predicted)[6:], decibels(mean)[6:], atol=0.1)


def test_terms_against_a_calculation_by_hand():
    """Urick's equation with numbers: 400 kHz, fan of 1°, tone of 0.1 ms, medium sand, sonar 10 m above the bed."""
    solved, _ = solve_sonar_equation(raw())
    r, k = 40.025, 800  # centre of the bin
    theta, alpha = math.asin(10.0 / r), francois_garrison(400e3, 10.0, depth=20.0) / 1e3
    strength = math.sin(theta) ** 2 * 0.2371 / math.pi  # as strong as the model of the sediment at 30° and 400 kHz
    area = math.radians(1.0) * r * 1500.0 * 1e-4 / 2.0 / math.cos(theta)
    terms = {name: float(term[k]) for name, term in solved.bed.terms.items()}
    by_hand = {"source level": 190.0, "beam vertically": 0.0, "backscatter": decibels(strength), "area": decibels(area)}
    for way in ("out", "back"):
        by_hand |= {f"spreading {way}": -20.0 * math.log10(r), f"absorption {way}": -alpha * r}
    assert terms == pytest.approx(by_hand, abs=0.05)
    assert solved.energy == pytest.approx(150.0)
    volume = next(each for each in solved.disturbances if each.name == "volume reverberation")
    angle = 2.0 * math.sin(math.radians(0.5)) * (math.asin(10.0 / r) + math.asin(20.0 / r))  # up to surface and bed
    of_volume = 190.0 - 60.0 + decibels(angle * r**2 * 0.075) - 40.0 * math.log10(r) - 2.0 * alpha * r
    assert float(volume.decibels[k]) == pytest.approx(of_volume, abs=0.05)


def test_a_small_target_has_its_level_in_the_record():
    ball = {"kind": "sphere", "radius": 0.1, "position": [20.0, 25.0, -20.0]}
    ball["material"] = {"name": "steel", "diffuse": 0.9, "specular": 0.0}
    fixed = QUIET | {"targets": [ball], "receiver.tvg": "none", "track.start": [20.0, 0.0], "track.pings": 1}
    silent = {"name": "silt", "diffuse": 0.0, "specular": 0.0}
    scene = edit(raw(), fixed | {"sonar.pulse.duration": 5e-4, "seabed.material": silent})
    record = simulate(scene, truth=True, forced={"planes": "64"})
    solved, _ = solve_sonar_equation(scene, float(record.target_strength.item()))
    loudest = record.intensity[0, 0].values.max()
    assert solved.target.decibels[500] == pytest.approx(decibels(float(loudest)), abs=0.2)


def test_levels_drown_where_they_meet_the_noise():
    """A bed falls as r⁻⁵ and is 15 dB over the noise at 40 m: without absorption it drowns 10^(15/50) as far."""
    noise = {"kind": "snr", "value": 15.0, "at": 40.0}
    scene = raw(receiver__noise=noise, receiver__reverberation="none", water__absorption="none")
    _, farther = solve_sonar_equation(scene)
    assert farther.farthest(farther.bed) == pytest.approx(40.0 * 10.0 ** (15.0 / 50.0), rel=0.02)
    bed, target = farther.bed.decibels[1000], farther.target.decibels[1000]
    assert target > bed
    # A point falls as r⁻⁴.
    by_hand = 50.0 * 10.0 ** ((target - farther.disturbance[1000]) / 40.0)
    assert farther.farthest(farther.target) == pytest.approx(by_hand, rel=0.01)


def test_the_command_prints_and_writes_it_and_a_scene_without_noise_never_drowns(tmp_path, capsys):
    scene, path = load_scene("raw-record"), tmp_path / "levels.csv"
    assert main(["budget", "raw-record", "--range", "30", "--target", "-15", "-o", str(path)]) == 0
    printed = capsys.readouterr().out
    solved, _ = solve_sonar_equation(scene, -15.0)
    k = int(30.0 / 50.0 * 1000)
    levels = {"bed": solved.bed, "noise": solved.disturbances[0], "target": solved.target}
    shown = {name: level.decibels for name, level in levels.items()} | {"record of the bed": solved.record}
    for name, decibels_shown in shown.items():
        line = next(line for line in printed.splitlines() if line.startswith(f"= {name} "))
        assert f"{decibels_shown[k]:.2f} dB" in line
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[k]["bed (dB)"]) == pytest.approx(solved.bed.decibels[k], abs=1e-3)
    sums = [float(rows[k][f"bed: {name} (dB)"]) for name in solved.bed.terms]
    assert sum(sums) == pytest.approx(float(rows[k]["bed (dB)"]), abs=1e-3)
    for suffix in (".png", ".svg"):
        write_sonar_equation(tmp_path / f"levels{suffix}", solved)
        assert (tmp_path / f"levels{suffix}").stat().st_size > 1000
    assert main(["budget", "sediments"]) == 0
    printed = capsys.readouterr().out
    assert "= bed " in printed
    assert "over noise" not in printed
    assert "bed: above noise and reverberation up to" in printed
    assert "  sandy_gravel   1.0000" in printed


# Target strengths: energies add, which is geometrical acoustics, ka >> 1 (a sphere of 0.1 m at 400 kHz: ka = 168), with
# the reflected energy R² = 0.8 in a mirror lobe of the exponent n; facets spread it over 1/√n, a factor 1 + 2/n here.
R2, N = 0.8, 1000.0
MIRROR = {"name": "steel", "diffuse": 0.0, "specular": R2, "shininess": N}
DISTANCE = 20.0


def strength_of(target, width=10.0, **changes):
    """Target strength of the record, of a target at the height of the sonar, over a silent bed."""
    target = target | {"position": [0.0, DISTANCE, -20.0], "material": MIRROR} | changes
    place = {"targets": [target], "seabed.depth": 40.0, "track.altitude": 20.0, "track.pings": 1}
    scene = edit(load_scene("pipe-span"), place | {"sonar.beam": {"kind": "fan", "width": width}})
    record = simulate(scene, truth=True, forced={"planes": "128"})
    return float(record.target_strength.item())


@pytest.mark.parametrize(
    ("target", "width", "area", "bound"),
    [
        # a²/4 of a rigid sphere, ka ≫ 1 (Urick 1983, table 9.1), times (r/(r + a))² of a source at r; planes closer
        # than its glint.
        ({"kind": "sphere", "radius": 0.5}, 1.0, (1.0 + 2.0 / N) * 0.25 / 4.0 * (1.0 - 0.5 / DISTANCE) ** 2, 0.05),
        ({"kind": "sphere", "radius": 1.0}, 1.0, (1.0 + 2.0 / N) * 1.0 / 4.0 * (1.0 - 1.0 / DISTANCE) ** 2, 0.05),
        # Broadside and longer than the first Fresnel zone: a r²/4(r + a) of a source at r, a r/2 of a plane wave.
        ({"kind": "pipe", "radius": 0.2, "length": 12.0}, 20.0, 0.2 * (DISTANCE - 0.2) ** 2 / DISTANCE / 4.0, 0.1),
        # Larger than the first Fresnel zone, at normal incidence: the image at 2r, r²/4.
        ({"kind": "box", "size": [8.0, 0.2, 8.0]}, 20.0, (DISTANCE - 0.1) ** 2 / 4.0, 0.3),
    ],
)
def test_mirrors_return_what_geometrical_acoustics_has(target, width, area, bound):
    assert strength_of(target, width) == pytest.approx(decibels(R2 * area), abs=bound)


def test_a_mesh_returns_as_the_solid_that_it_stands_for(tmp_path):
    """A Lambert sphere of facets: 2/3 k a², and by its solid as well."""
    path, radius = tmp_path / "ball.obj", 0.5
    vertices, facets = icosphere(4, radius)
    lines = [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in vertices] + [f"f {a} {b} {c}" for a, b, c in facets + 1]
    path.write_text("\n".join(lines), encoding="utf-8")
    lambert = {"name": "steel", "diffuse": 0.6, "specular": 0.0}
    mesh = strength_of({"kind": "mesh", "path": str(path)}, width=4.0, material=lambert)
    assert mesh == pytest.approx(decibels(2.0 / 3.0 * 0.6 * radius**2), abs=0.3)
    solid = strength_of({"kind": "sphere", "radius": radius}, width=4.0, material=lambert)
    assert mesh == pytest.approx(solid, abs=0.05)


TONE, LONG_TONE = {"kind": "tone", "duration": 1e-4}, {"kind": "tone", "duration": 1e-3}
CHIRP = {"kind": "chirp", "duration": 1e-3, "bandwidth": 30e3}
DENSITY = {"kind": "density", "level": 35.0}
C = 1500.0


def level_bed(**changes):
    """The bed of pipe-on-bed without its pipe, with a source of 200 dB."""
    return scene_with("pipe-on-bed", **{"targets": [], "receiver__source_level": 200.0} | changes)


def noise_of(**changes):
    return decibels(prepare(level_bed(**changes)).reception.find(Noise).level)


@pytest.mark.parametrize(
    ("pulse", "window", "gain"),
    [
        (TONE, 1.0, 0.0),
        (LONG_TONE, 1.0, 0.0),
        (CHIRP | {"window": "uniform"}, 1.0, decibels(30.0)),
        (CHIRP, 1.3628, decibels(30.0) - 1.34),  # Harris 1978, table 1: a Hamming window lets in the noise of 1.36 bins
        (CHIRP | {"window": "hann"}, 1.5, decibels(30.0) - 1.76),
    ],
    ids=["tone 0.1 ms", "tone 1 ms", "chirp", "chirp by Hamming's window", "chirp by Hann's window"],
)
def test_bed_noise_and_processing_gain_against_a_calculation_by_hand(pulse, window, gain):
    """200 dB - 40 log r + S_b + 10 log(1 m cell / cosθ); 35 dB + 10 log(w/T) - 3 dB: docs/theory/levels.md.

    The cell is cT/2 of a tone, whose middle is half of it nearer than the bin, and cw/2B of a chirp:
    a window lengthens the cell as much as it lets more noise in. A knife with an even vertical beam hears one half
    space: 3 dB. A point's echo keeps its level, so that energy over density is E/N₀ = SL + 10 log T - N₀.
    The gain is the product of time and bandwidth.
    """
    scene = level_bed(sonar__pulse=pulse, receiver__noise=DENSITY, seabed__material__diffuse=0.2)
    cell = 0.5 * C * (window / pulse["bandwidth"] if "bandwidth" in pulse else pulse["duration"])
    sine = 10.0 / 30.0
    strength = 0.2 / math.pi * sine**2
    bed = 200.0 - 40.0 * math.log10(30.0) + decibels(strength * cell / math.sqrt(1.0 - sine**2))
    noise = 35.0 + decibels(window / pulse["duration"]) - decibels(2.0)
    slant_range = 30.0 + (0.0 if "bandwidth" in pulse else 0.5 * cell)
    record = prepare(edit(scene, {"receiver.noise": "none"})).intensity(np.arange(1))[0, 0].astype(np.float64)
    k = int(slant_range / scene.sonar.range * scene.sonar.bins)
    assert decibels(record[k - 10 : k + 10].mean()) == pytest.approx(bed, abs=0.02)
    level = decibels(prepare(scene).reception.find(Noise).level)
    assert level == pytest.approx(noise, abs=1e-9 if window == 1.0 else 0.005)
    assert decibels(scene.sonar.pulse.processing_gain(1e-5)) == pytest.approx(gain, abs=0.01)


def test_the_record_has_the_declared_noise_and_the_shortest_pulse_that_of_a_bin():
    ideal = noise_of(sonar__pulse="ideal", receiver__noise=DENSITY)  # 2.5 cm of slant range, 1/30 ms
    assert ideal == pytest.approx(35.0 + decibels(C / 0.05) - decibels(2.0), abs=0.05)
    simulation = prepare(level_bed(sonar__pulse=CHIRP, receiver__noise=DENSITY))
    silence = np.zeros((200, 2, simulation.arrays.bins), np.float32)
    measured = receive(simulation.reception, silence, np.arange(200)).astype(np.float64).mean()
    assert decibels(measured) == pytest.approx(decibels(simulation.reception.find(Noise).level), abs=0.05)


ARRAY, FAN = {"kind": "array", "length": 0.5}, {"kind": "fan", "width": 2.0}


@pytest.mark.parametrize(
    ("beam", "vertical", "expected"),
    [
        ("knife", "uniform", 2.0),
        # One half space of a line array: twice the 2L/λ of a line (Urick 1983, table 3.2).
        (ARRAY, "uniform", 4.0 * 0.5 * 400e3 / C),
        # A rectangle in a baffle: 4πLh/λ² (Urick 1983, table 3.2).
        (ARRAY, {"kind": "array", "height": 0.05, "tilt": 20.0}, 4.0 * math.pi * 0.5 * 0.05 * (400e3 / C) ** 2),
        (FAN, "uniform", 4.0 / (2.0 * math.sin(math.radians(1.0)))),
        (FAN, {"kind": "fan", "width": 40.0}, 4.0 * math.pi / (2.0 * math.sin(math.radians(1.0)) * math.radians(40.0))),
    ],
)
def test_directivity_against_closed_forms(beam, vertical, expected):
    sonar = level_bed(sonar__frequency=400e3, sonar__beam=beam, sonar__vertical=vertical).sonar
    assert decibels(directivity(sonar, C)) == pytest.approx(decibels(expected), abs=0.1)


# Spectrum levels in dB re 1 µPa²/Hz by sea state at 10 and 100 kHz (Sadowski 1984, NUSC Technical Document 7265).
SEA_STATES = {0.0: (27.1, 9.0), 2.5: (36.5, 18.4), 4.5: (42.8, 24.6), 6.7: (46.6, 28.4), 9.4: (48.9, 30.8),
              12.3: (50.9, 32.8), 15.5: (53.5, 35.4)}  # fmt: skip


def test_noises_of_the_sea_are_as_tabulated_and_add_up():
    for wind, levels in SEA_STATES.items():
        assert [wind_noise(f, wind) for f in (10e3, 100e3)] == pytest.approx(levels, abs=3.5), wind
    # The available power, 4πKTρf²/c per hertz (Mellen 1952), at 10 °C.
    pressure = 4.0 * math.pi * 1.380649e-23 * 283.15 * 1027.0 * (100e3) ** 2 / 1490.0 * 1e12
    assert thermal_noise(100e3) == pytest.approx(decibels(pressure), abs=0.4)
    assert thermal_noise(100e3) == pytest.approx(25.0, abs=0.1)  # as tabulated
    sea = {"kind": "sea", "wind": 8.0, "rain": "heavy"}
    parts = wind_noise(455e3, 8.0), rain_noise(455e3, "heavy"), thermal_noise(455e3)
    density = decibels(sum(10.0 ** (part / 10.0) for part in parts))
    level = noise_of(sonar__frequency=455e3, sonar__pulse=TONE, receiver__noise=sea)
    assert level == pytest.approx(density + 40.0 - decibels(2.0), abs=1e-9)
    calm = level_bed(sonar__frequency=455e3, receiver__noise="sea", receiver__noise__wind=0.0).receiver.noise
    assert calm.density(455e3) == pytest.approx(thermal_noise(455e3), abs=0.1)  # thermal noise alone above 300 kHz


@pytest.mark.parametrize(
    "changes",
    [
        {"sonar__beam": "knife"},
        {"sonar__beam": ARRAY, "sonar__pulse": CHIRP},
        {"sonar__pulse": LONG_TONE, "sonar__vertical": {"kind": "gaussian", "tilt": 10.0, "width": 30.0}},
        {"seabed__material": {"kind": "patches", "of": ["silt", "medium_sand"], "size": 4.0}},
        {"sonar__law": "light", "receiver__source_level": 0.0},
    ],
    ids=["knife", "chirp", "long tone", "two materials", "light"],
)
def test_noise_by_the_wanted_ratio(changes):
    """15 dB under the mean echo of the bed at 40 m, as measured in the record without noise."""
    noise = {"kind": "snr", "value": 15.0, "at": 40.0}
    scene = level_bed(**{"sonar__pulse": TONE} | changes)
    tow = {"track.speed": 5.0, "track.pings": 80} if scene.seabed.material.kind == "patches" else {}
    bed = prepare(edit(scene, tow)).intensity(np.arange(80 if tow else 1)).astype(np.float64)
    k = int(40.0 / scene.sonar.range * scene.sonar.bins)
    measured = bed[..., k - 20 : k + 20].mean()
    level = prepare(edit(scene, {"receiver.noise": noise})).reception.find(Noise).level
    assert decibels(measured / level) == pytest.approx(15.0, abs=0.6 if tow else 0.1)


def test_levels_need_a_bed_in_range_a_source_and_the_law_of_sonar():
    with pytest.raises(SceneError, match="no sonar equation"):
        solve_sonar_equation(edit(load_scene("pipe-on-bed"), {"sonar.law": "light"}))
    for at in (5.0, 60.0):
        with pytest.raises(SceneError, match=r"receiver\.noise: there is no echo of the bed at"):
            noise_of(receiver__noise={"kind": "snr", "at": at})
    with pytest.raises(SceneError, match=r"receiver\.source_level 0 is relative"):
        level_bed(receiver__source_level=0.0, receiver__noise="sea")
    scene = level_bed(receiver__source_level=0.0)
    changes, remark = add_dependent_edits(scene, {"receiver.noise.kind": "sea"})
    assert edit(scene, changes).receiver.source_level == 210.0
    assert "source level" in remark


def test_a_scene_with_noise_in_the_band_loads_with_one_line_of_advice(tmp_path):
    path = tmp_path / "old.toml"
    path.write_text(scene_to_toml(load_scene("raw-record")), encoding="utf-8")
    with pytest.warns(FileWarning, match="keeps its level whatever the pulse") as caught:
        assert load_scene(path) == load_scene("raw-record")
    assert len(caught) == 1
    path.write_text(scene_to_toml(edit(load_scene("raw-record"), {"receiver.noise": "sea"})), encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load_scene(path)
