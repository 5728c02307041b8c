"""The sonar equation against simulated records and hand calculations; target strengths of the record against theory."""

import csv
import math

import numpy as np
import pytest

from insonify.cli import main
from insonify.explanation.sonar_equation import solve_sonar_equation, write_sonar_equation
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.water.absorptions import francois_garrison
from insonify.simulation import prepare, simulate
from receptions import decibels, scene_with

BARE = {
    "targets": [],
    "seabed__relief": "flat",
    "receiver__speckle": "none",
    "receiver__fluctuation": "none",
    "track__pings": 400,
}
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
    scene = raw(**changes)
    scene = edit(scene, DISTURBED)
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
    assert terms == pytest.approx(
        {
            "source level": 190.0,
            "spreading out": -20.0 * math.log10(r),
            "spreading back": -20.0 * math.log10(r),
            "absorption out": -alpha * r,
            "absorption back": -alpha * r,
            "beam vertically": 0.0,
            "backscatter": decibels(strength),
            "area": decibels(area),
        },
        abs=0.05,
    )
    assert solved.energy == pytest.approx(150.0)
    volume = next(each for each in solved.disturbances if each.name == "volume reverberation")
    angle = 2.0 * math.sin(math.radians(0.5)) * (math.asin(10.0 / r) + math.asin(20.0 / r))  # up to surface and bed
    by_hand = 190.0 - 60.0 + decibels(angle * r**2 * 0.075) - 40.0 * math.log10(r) - 2.0 * alpha * r
    assert float(volume.decibels[k]) == pytest.approx(by_hand, abs=0.05)


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


def test_the_command_prints_and_writes_it(tmp_path, capsys):
    scene, path = load_scene("raw-record"), tmp_path / "levels.csv"
    assert main(["budget", "raw-record", "--range", "30", "--target", "-15", "-o", str(path)]) == 0
    printed = capsys.readouterr().out
    solved, _ = solve_sonar_equation(scene, -15.0)
    k = int(30.0 / 50.0 * 1000)
    for words in ("= bed ", "= noise ", "= target ", "= record of the bed "):
        line = next(line for line in printed.splitlines() if line.startswith(words))
        level = {"= bed ": solved.bed, "= noise ": solved.disturbances[0], "= target ": solved.target}.get(words)
        shown = solved.record if level is None else level.decibels
        assert f"{shown[k]:.2f} dB" in line
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[k]["bed (dB)"]) == pytest.approx(solved.bed.decibels[k], abs=1e-3)
    sums = [float(rows[k][f"bed: {name} (dB)"]) for name in solved.bed.terms]
    assert sum(sums) == pytest.approx(float(rows[k]["bed (dB)"]), abs=1e-3)
    for suffix in (".png", ".svg"):
        write_sonar_equation(tmp_path / f"levels{suffix}", solved)
        assert (tmp_path / f"levels{suffix}").stat().st_size > 1000


def test_a_scene_without_noise_never_drowns(capsys):
    assert main(["budget", "sediments"]) == 0
    printed = capsys.readouterr().out
    assert "= bed " in printed
    assert "over noise" not in printed
    assert "bed: above noise and reverberation up to" in printed
    assert "  sandy_gravel   1.0000" in printed


def test_the_law_of_light_has_no_levels():
    with pytest.raises(SceneError, match="no sonar equation"):
        solve_sonar_equation(edit(load_scene("pipe-on-bed"), {"sonar.law": "light"}))


# Target strengths: energies add, which is geometrical acoustics, ka >> 1 (a sphere of 0.1 m at 400 kHz: ka = 168), with
# the reflected energy R² = 0.8 in a mirror lobe of the exponent n; facets spread it over 1/√n, a factor 1 + 2/n here.
R2, N = 0.8, 1000.0
MIRROR = {"name": "steel", "diffuse": 0.0, "specular": R2, "shininess": N}
DISTANCE = 20.0


def strength_of(target, width=10.0, **changes):
    """Target strength of the record, of a target at the height of the sonar, over a silent bed."""
    target = target | {"position": [0.0, DISTANCE, -20.0], "material": MIRROR} | changes
    fixed = {
        "targets": [target],
        "seabed.depth": 40.0,
        "track.altitude": 20.0,
        "track.pings": 1,
        "sonar.beam": {"kind": "fan", "width": width},
    }
    record = simulate(edit(load_scene("pipe-span"), fixed), truth=True, forced={"planes": "128"})
    return float(record.target_strength.item())


@pytest.mark.parametrize(
    ("target", "width", "area", "bound"),
    [
        # a²/4 of a rigid sphere, ka ≫ 1 (Urick 1983, table 9.1), times (r/(r + a))² of a source at r; planes closer
        # than its glint.
        ({"kind": "sphere", "radius": 0.5}, 1.0, (1.0 + 2.0 / N) * 0.25 / 4.0 * (1.0 - 0.5 / DISTANCE) ** 2, 0.05),
        ({"kind": "sphere", "radius": 1.0}, 1.0, (1.0 + 2.0 / N) * 1.0 / 4.0 * (1.0 - 1.0 / DISTANCE) ** 2, 0.05),
        # Broadside and longer than the first Fresnel zone: (a/4) r of a source at the range r; a r/2 for a plane wave.
        ({"kind": "pipe", "radius": 0.2, "length": 12.0}, 20.0, 0.2 * (DISTANCE - 0.2) / 4.0, 0.3),
        # Larger than the first Fresnel zone, at normal incidence: the image at 2r, r²/4.
        ({"kind": "box", "size": [8.0, 0.2, 8.0]}, 20.0, (DISTANCE - 0.1) ** 2 / 4.0, 0.3),
    ],
)
def test_mirrors_return_what_geometrical_acoustics_has(target, width, area, bound):
    assert strength_of(target, width) == pytest.approx(decibels(R2 * area), abs=bound)


def test_a_mesh_returns_as_the_solid_that_it_stands_for(tmp_path):
    """A Lambert sphere of facets: 2/3 k a², and by its solid as well."""
    path, radius = tmp_path / "ball.obj", 0.5
    around, up = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 129), np.linspace(-0.5 * np.pi, 0.5 * np.pi, 65))
    x, y, z = radius * np.cos(up) * np.cos(around), radius * np.cos(up) * np.sin(around), radius * np.sin(up)
    corners = [f"v {a:.9f} {b:.9f} {c:.9f}" for a, b, c in zip(x.ravel(), y.ravel(), z.ravel())]
    starts = [129 * row + column + 1 for row in range(64) for column in range(128)]
    faces = [f"f {k} {k + 1} {k + 130} {k + 129}" for k in starts]
    path.write_text("\n".join([*corners, *faces]), encoding="utf-8")
    lambert = {"name": "steel", "diffuse": 0.6, "specular": 0.0}
    mesh = strength_of({"kind": "mesh", "path": str(path)}, width=4.0, material=lambert)
    assert mesh == pytest.approx(decibels(2.0 / 3.0 * 0.6 * radius**2), abs=0.3)
    solid = strength_of({"kind": "sphere", "radius": radius}, width=4.0, material=lambert)
    assert mesh == pytest.approx(solid, abs=0.05)
