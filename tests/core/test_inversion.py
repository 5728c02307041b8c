"""A bed learned from a record: each estimator against what it must find, whole scenes against known truth, mistakes."""

import numpy as np
import pytest
import xarray as xr

import insonify
from commands import refused
from insonify.acoustics.pulses import pulse_taps
from insonify.cli import main
from insonify.inversion.bed_parameters import (
    BedParameters,
    PowerLaw,
    choose_grid,
    choose_speckle,
    realised_rms,
    set_bed,
    variance_of_looks,
)
from insonify.inversion.footprint import footprint_of
from insonify.inversion.learning import DIFFERS, MATCHED, UNKNOWN
from insonify.inversion.roughness_fit import fit_roughness
from insonify.inversion.segment_spectra import SEGMENT, AngleGroup, SegmentSpectra, fit_level_curve
from insonify.io.records import read_record, write_record
from insonify.receiver.stage import spread_echoes
from insonify.scene import SceneError, edit, load_scene
from known_beds import errors, make_bed

FAN = {"kind": "fan", "width": 0.5}


@pytest.fixture(scope="module")
def scene():
    return make_bed(1.4, 0.08, 10.0, "rayleigh", FAN, "fine_sand", 7)


@pytest.fixture(scope="module")
def record(scene):
    return insonify.simulate(scene)


# Estimators


@pytest.mark.parametrize("law", ["sonar", "light"])
@pytest.mark.parametrize("sine", [0.2, 0.5, 0.7])
def test_slope_response_is_the_derivative_of_the_amplitude(scene, law, sine):
    def amplitude(angle):
        return np.sqrt(np.sin(angle) ** 2 / np.cos(angle) if law == "sonar" else np.sin(angle))

    grazing, small = np.arcsin(sine), 1e-5
    derivative = (amplitude(grazing + small) - amplitude(grazing - small)) / (2.0 * small * amplitude(grazing))
    footprint = footprint_of(edit(scene, {"sonar.law": law}), 1500.0)
    assert footprint.respond_to_slope(sine) == pytest.approx(derivative, rel=1e-6)


def test_a_fan_averages_over_its_arc(scene):
    frequency = np.linspace(0.0, 5.0, 11)
    wide = 2.0 * np.sin(np.radians(0.25)) * 30.0
    left = footprint_of(scene, 1500.0).average_along(frequency, 30.0)
    np.testing.assert_allclose(left, np.sinc(frequency * wide) ** 2, atol=2e-3)
    knife = footprint_of(edit(scene, {"sonar.beam": "knife"}), 1500.0)
    assert (knife.average_along(frequency, 30.0) == 1.0).all()


@pytest.mark.parametrize("frequency", [0.5, 2.0, 3.0])
def test_pulse_and_bins_average_as_the_receiver_does(scene, frequency):
    # A wave of the energy over slant range, its mean in bins of 5 cm, spread by the pulse.
    edges = 0.05 * np.arange(2001)
    wave = np.diff(np.sin(2.0 * np.pi * frequency * edges)) / (2.0 * np.pi * frequency * 0.05)
    spread = spread_echoes(pulse_taps(scene.sonar.pulse, 1500.0, 0.05), 1.0 + 0.1 * wave[None, None])[0, 0, 100:-100]
    relative = spread / spread.mean() - 1.0
    left = footprint_of(scene, 1500.0).average_across(np.array([frequency]))[0]
    assert 2.0 * relative.var() / 0.1**2 == pytest.approx(left, rel=0.02)


def exact_spectra(scene, relief, speckle, patches=None):
    """Densities that a relief, speckle and patches give in theory, without their sampling error."""
    along, across = np.fft.fftfreq(SEGMENT, 0.2), np.fft.rfftfreq(SEGMENT, 0.05)
    footprint = footprint_of(scene, 1500.0)
    groups = []
    for sine, slant_range in ((0.3, 33.0), (0.6, 17.0)):
        cosine = np.sqrt(1.0 - sine**2)
        power = footprint.speckle(across) * np.full((SEGMENT, 1), speckle * 0.2 * 0.05)
        for shift in range(-2, 3):
            fa = along + shift / 0.2
            squared = fa[:, None] ** 2 + (across * cosine) ** 2
            with np.errstate(divide="ignore", invalid="ignore"):
                heights = np.exp(relief[0]) * squared ** -relief[1]
                change = heights * (2.0 * np.pi * across * cosine * footprint.respond_to_slope(sine)) ** 2
                if patches is not None:
                    change = change + 0.25 * np.exp(patches[0]) * squared ** -patches[1]
            left = footprint.average_along(fa, slant_range)[:, None] * footprint.average_across(across)
            power = power + np.nan_to_num(change * left * cosine, posinf=0.0)
        groups.append(AngleGroup(sine, slant_range, power, 40))
    return SegmentSpectra(along, across, tuple(groups), 0.2 * 0.05), footprint


@pytest.mark.parametrize("relief", [(-9.0, 1.0), (-11.0, 1.6), (-12.0, 2.2)])
@pytest.mark.parametrize("speckle", [0.02, 0.273])
def test_exact_spectra_are_fitted_exactly(scene, relief, speckle):
    fit = fit_roughness(*exact_spectra(scene, relief, speckle))
    np.testing.assert_allclose(fit.relief[:2], relief, atol=5e-3)
    assert fit.speckle == pytest.approx(speckle, rel=0.01)


def test_patches_of_material_are_told_from_relief(scene):
    relief, patches = (-11.0, 1.6), (-4.0, 1.2)
    fit = fit_roughness(*exact_spectra(scene, relief, 0.13, patches), patches=True)
    np.testing.assert_allclose([*fit.relief[:2], *fit.patches[:2]], [*relief, *patches], atol=0.02)


def test_variance_of_speckle():
    assert variance_of_looks(1) == pytest.approx(4.0 / np.pi - 1.0)
    assert variance_of_looks(64) == pytest.approx(1.0 / 256.0, rel=0.01)
    assert choose_speckle(0.001).kind == "none"
    for looks in (1, 2, 4, 9):
        assert choose_speckle(variance_of_looks(looks)).looks == looks
    spiky = choose_speckle(0.6)
    assert spiky.kind == "k"
    assert (1.0 + variance_of_looks(1)) * (1.0 + variance_of_looks(spiky.shape)) == pytest.approx(1.6, rel=1e-3)


@pytest.mark.parametrize("law", [PowerLaw(-9.0, 1.1), PowerLaw(-11.5, 2.1)])
def test_the_learned_relief_has_the_spectral_density_asked_for(scene, law):
    made = set_bed(scene, BedParameters(law, None, 0.0, 0.1, True))
    heights = insonify.relief(made.seabed, seed=made.seed)
    spacing, size = made.seabed.spacing, heights.shape[0]
    power = np.abs(np.fft.fft2(heights)) ** 2 * spacing**2 / heights.size
    f = np.fft.fftfreq(size, spacing)
    distance = np.hypot(f[:, None], f)
    ring = (distance > 0.3) & (distance < 2.0)
    expected = np.exp(law.log_level) * distance[ring] ** (-2.0 * law.exponent)
    np.testing.assert_allclose(power[ring], expected, rtol=2e-3)
    assert heights.std() == pytest.approx(realised_rms(law, *choose_grid(scene)), rel=1e-4)


def test_levels_by_range_and_by_angle_are_separated():
    pings, bins, bin_length = 512, 512, 0.05
    altitude = np.linspace(3.0, 9.0, pings)
    r = (np.arange(bins) + 0.5) * bin_length
    sine = np.minimum(altitude[:, None] / r, 1.0)
    angle = np.degrees(np.arcsin(sine))
    level = 5.0 * np.sin(r / 4.0) - 6.0 * ((angle - 40.0) / 40.0) ** 2
    speckle = np.random.default_rng(1).exponential(size=(2, pings, bins))
    bed = r > altitude[:, None]
    intensity = (10.0 ** (level / 10.0) * sine**2 * speckle * bed).astype(np.float32)
    found = fit_level_curve(intensity, altitude, bin_length, separate=True)
    curve = 10.0 * np.log10(found.intensity(altitude, r) / sine**2)
    checked = (r > 1.1 * altitude[:, None]) & (r > 1.0) & (r < 25.0)
    off = (curve - level)[checked]
    assert (off - np.median(off)).std() < 0.5


# Whole scenes


@pytest.mark.parametrize(
    ("beta", "slope", "altitude", "speckle", "beam", "material"),
    [
        (1.2, 0.06, 6.0, "rayleigh", FAN, "silt"),
        (1.6, 0.10, 10.0, "none", {"kind": "fan", "width": 1.0}, "coarse_sand"),
        (2.0, 0.05, 10.0, "rayleigh", {"kind": "knife"}, "medium_sand"),
    ],
)
def test_a_known_bed_is_learned(beta, slope, altitude, speckle, beam, material):
    truth = make_bed(beta, slope, altitude, speckle, beam, material, 21)
    learned = insonify.learn(insonify.simulate(truth)).scene
    off = np.abs(errors(truth, learned))
    assert (off <= [0.15, 0.2, 1.0]).all(), off
    assert learned.receiver.speckle == truth.receiver.speckle
    assert learned.sonar == truth.sonar
    assert learned.track == truth.track


def test_patches_of_material_are_learned():
    truth = make_bed(1.4, 0.04, 10.0, "rayleigh", FAN, "fine_sand", 5)
    levels = 0.06 * 10.0 ** (np.linspace(-6.0, 6.0, 9) / 10.0)
    of = [{"name": "fine_sand", "diffuse": float(level), "specular": 0.0} for level in levels]
    patchy = edit(truth, {"seabed.material": {"kind": "fractal", "beta": 1.3, "of": of}})
    learned = insonify.learn(insonify.simulate(patchy)).scene
    spread = np.std(10.0 * np.log10([one.reflectivity.diffuse for one in learned.seabed.material.materials]))
    assert learned.seabed.material.kind == "fractal"
    assert spread == pytest.approx(np.std(10.0 * np.log10(levels)), rel=0.35)
    assert learned.seabed.relief.beta == pytest.approx(1.4, abs=0.2)


def test_a_level_bed_without_speckle_stays_level(scene):
    level = edit(scene, {"seabed.relief": "flat", "receiver.speckle": "rayleigh"})
    learned = insonify.learn(insonify.simulate(level)).scene
    assert getattr(learned.seabed.relief, "rms", 0.0) < 1e-3
    assert learned.receiver.speckle.kind == "rayleigh"


def test_a_recording_does_not_tell_gains_and_material_but_pulse_and_beam_leave_traces(record):
    recording = record.drop_attrs()
    recording.attrs = {"title": "unknown sonar"}
    learned = insonify.learn(recording, {"sonar.pulse": {"kind": "tone", "duration": 1e-4}, "sonar.beam": FAN})
    verdicts = {found.quantity: found.verdict for found in learned.findings}
    assert verdicts["material level"] == verdicts["frequency"] == UNKNOWN
    assert verdicts["level over range"] == verdicts["variation in even patches"] == MATCHED
    assert learned.scene.receiver.tvg.kind == "table"
    assert learned.scene.seabed.relief.beta == pytest.approx(1.4, abs=0.15)
    learned = insonify.learn(record.drop_attrs())
    assert learned.scene.sonar.pulse.length == pytest.approx(1e-4, rel=0.25)
    # A Gaussian beam, heard twice, that is as wide in the mean as the fan of 0.5 degrees.
    assert 0.3 <= learned.scene.sonar.beam.width <= 0.75


# The command


def test_learn_writes_the_scene_of_the_record_alone_and_says_how_it_compares(record, tmp_path, capsys):
    other = record.copy()
    other.attrs["scene"] = record.attrs["scene"].replace('name = "fine_sand"', 'name = "rock"')
    assert other.attrs["scene"] != record.attrs["scene"]
    write_record(tmp_path / "line.npz", [other])
    out = tmp_path / "scene.toml"
    assert main(["learn", str(tmp_path / "line.npz"), "-o", str(out)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["record", "scene"]
    assert any(line.startswith("relief") and line.endswith("matched") for line in lines)
    assert lines[-1] == f"{out}: its record matches the recording"
    learned = load_scene(out)
    assert learned == insonify.learn(record).scene
    assert learned.title == "Learned from known bed 7"
    assert learned.sonar.range == 40.0


def test_a_track_that_bends_is_written_beside_the_scene(scene, tmp_path, monkeypatch, capsys):
    motion = {"kind": "heave", "amplitude": 4.0, "period": 60.0}
    towed = edit(scene, {"track.motion": motion, "track.pings": 300})
    write_record(tmp_path / "line.xtf", [insonify.simulate(towed)])
    assert main(["learn", str(tmp_path / "line.xtf"), "-o", str(tmp_path / "s.toml")]) == 0
    *_, track, summary = capsys.readouterr().out.splitlines()
    assert track == str(tmp_path / "s-track.csv")
    assert summary.startswith(f"{tmp_path / 's.toml'}: its record ")
    monkeypatch.chdir(tmp_path.parent)
    own = insonify.simulate(edit(load_scene(tmp_path / "s.toml"), {"track.pings": 200}))
    altitude = own["platform_altitude"].values
    expected = 10.0 + 4.0 * np.sin(2.0 * np.pi * np.arange(200) / 600.0)
    assert np.abs(altitude - expected).max() < 0.8


def silent(record: xr.Dataset) -> xr.Dataset:
    unknown = record["platform_altitude"] * np.nan
    return record.assign(intensity=0.0 * record["intensity"] + 1.0, platform_altitude=unknown)


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (lambda record: record.isel(ping_time=slice(0, 100)), "at least 128 pings that move on"),
        (lambda record: record.isel(range_sample=slice(0, 300)), "128 bins beyond 1.4 altitudes"),
        (lambda record: record.assign(platform_x=0.0 * record["platform_x"]), "at least 128 pings that move on"),
        (silent, "has no altitude and shows no first echo of the bed"),
    ],
)
def test_a_record_that_tells_too_little_is_refused(record, spoil, sentence):
    recording = spoil(record)
    recording.attrs = {"title": "short"}
    with pytest.raises(SceneError, match=f"^short: .*{sentence}"):
        insonify.learn(recording)


def test_a_mistake_is_one_sentence(record, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_record(tmp_path / "line.npz", [record])
    (tmp_path / "text.xtf").write_text("no recording " * 200)
    for words, sentence in (
        (["line.npz", "-o", "s.toml", "--set", "seabed.relief.beta=1"], "is learned from the record"),
        (["line.npz", "-o", "s.toml", "--set", "sonar.beem=1"], "unknown key"),
        (["default", "-o", "s.toml"], "is not a record"),
        (["none.xtf", "-o", "s.toml"], "does not exist"),
        (["text.xtf", "-o", "s.toml"], "is not an XTF file"),
        (["line.npz", "-o", "s.png"], "end the name in .toml"),
    ):
        assert sentence in refused(capsys, "learn", *words)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["line.npz", "text.xtf"]


def test_a_real_recording_is_learned(real_recording):
    learned = insonify.learn(read_record(real_recording).isel(ping_time=slice(0, 256)))
    verdicts = {found.quantity: found.verdict for found in learned.findings}
    assert learned.navigation is not None
    for quantity in ("speckle, variance of amplitude", "variation in even patches", "level over range"):
        assert verdicts[quantity] == MATCHED
    assert [quantity for quantity, verdict in verdicts.items() if verdict == DIFFERS] in ([], ["shadows"])
