"""Levels of noise against hand calculations: energy over density, directivity, spectra of the sea, a wanted ratio."""

import math
import warnings

import numpy as np
import pytest

from insonify.acoustics.beam_patterns import directivity
from insonify.errors import FileWarning, SceneError
from insonify.receiver import receive
from insonify.receiver.levels import Noise
from insonify.scene import edit, load_scene, scene_to_toml
from insonify.scene.receiver.noises import rain_noise, thermal_noise, wind_noise
from insonify.scene_edits import add_dependent_edits
from insonify.simulation import prepare
from receptions import decibels, scene_with

TONE, LONG_TONE = {"kind": "tone", "duration": 1e-4}, {"kind": "tone", "duration": 1e-3}
CHIRP = {"kind": "chirp", "duration": 1e-3, "bandwidth": 30e3}
DENSITY = {"kind": "density", "level": 35.0}
C = 1500.0


def level_bed(**changes):
    """The bed of pipe-on-bed without its pipe, with a source of 200 dB."""
    return scene_with("pipe-on-bed", **{"targets": [], "receiver__source_level": 200.0} | changes)


def noise_of(**changes):
    return decibels(prepare(level_bed(**changes)).reception.find(Noise).level)


def bed_over_noise(pulse, slant_range=30.0, **changes):
    """Mean echo of the bed, measured in the record without noise, over the noise, in dB."""
    scene = level_bed(sonar__pulse=pulse, receiver__noise=DENSITY, **changes)
    bed = prepare(edit(scene, {"receiver.noise": "none"})).intensity(np.arange(1))[0, 0].astype(np.float64)
    k = int(slant_range / scene.sonar.range * scene.sonar.bins)
    return decibels(bed[k - 20 : k + 20].mean() / prepare(scene).reception.find(Noise).level)


@pytest.mark.parametrize("window", ["uniform", "hamming", "hann"])
def test_the_bed_stands_over_noise_as_the_energy_in_its_cell_does(window):
    """E/N₀ times the cell: 10 times the energy, a cell cτ/2 → c/2B a third as long, so 10 log(10/3) = 5.23 dB.

    A window lengthens the cell as much as it lets more noise in.
    """
    gain = bed_over_noise(CHIRP | {"window": window}) - bed_over_noise(TONE)
    assert gain == pytest.approx(decibels(1e-3 / 1e-4 * (1.0 / 30e3) / 1e-4), abs=0.1)
    # Ten times the energy and ten times the cell; both cells about the same middle, cτ/4 nearer than the bin.
    both = [bed_over_noise(pulse, 30.0 + 0.25 * C * pulse["duration"]) for pulse in (LONG_TONE, TONE)]
    assert both[0] - both[1] == pytest.approx(20.0, abs=0.05)


@pytest.mark.parametrize(
    ("pulse", "window"),
    [(TONE, 1.0), (LONG_TONE, 1.0), (CHIRP | {"window": "uniform"}, 1.0), (CHIRP | {"window": "hamming"}, 1.3628)],
    ids=["tone 0.1 ms", "tone 1 ms", "chirp", "chirp by Hamming's window"],
)
def test_bed_and_noise_against_a_calculation_by_hand(pulse, window):
    """200 dB - 40 log r + S_b + 10 log(1 m cell / cosθ); 35 dB + 10 log(w/T) - 3 dB: docs/theory/levels.md.

    The cell is cT/2 of a tone, whose middle is half of it nearer than the bin, and cw/2B of a chirp.
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
    assert decibels(record[k - 20 : k + 20].mean()) == pytest.approx(bed, abs=0.05)
    assert decibels(prepare(scene).reception.find(Noise).level) == pytest.approx(noise, abs=0.01)


@pytest.mark.parametrize(
    ("pulse", "gain"),
    [
        (TONE, 0.0),
        (CHIRP | {"window": "uniform"}, decibels(30.0)),
        (CHIRP, decibels(30.0) - 1.34),  # Harris 1978, table 1: the noise bandwidth of a Hamming window is 1.36 bins
        (CHIRP | {"window": "hann"}, decibels(30.0) - 1.76),
    ],
)
def test_processing_gain_is_the_product_of_time_and_bandwidth(pulse, gain):
    assert decibels(level_bed(sonar__pulse=pulse).sonar.pulse.processing_gain(1e-5)) == pytest.approx(gain, abs=0.01)


def test_noise_is_density_times_band_over_directivity():
    """35 + 40 dB in the 10 kHz of a tone of 0.1 ms; a knife with an even vertical beam hears one half space: 3 dB."""
    assert noise_of(sonar__pulse=TONE, receiver__noise=DENSITY) == pytest.approx(35.0 + 40.0 - decibels(2.0), abs=1e-9)
    # A point's echo keeps its level, and energy over density is E/N₀ = SL + 10 log T - N₀ whatever the bandwidth.
    chirp = CHIRP | {"window": "uniform"}
    assert noise_of(sonar__pulse=chirp, receiver__noise=DENSITY) == pytest.approx(35.0 + 30.0 - decibels(2.0), abs=1e-9)
    # A pulse shorter than any bin stands for one of a bin: 2.5 cm of slant range, 1/30 ms.
    ideal = noise_of(sonar__pulse="ideal", receiver__noise=DENSITY)
    assert ideal == pytest.approx(35.0 + decibels(C / 0.05) - decibels(2.0), abs=0.05)


def test_the_record_has_the_declared_noise():
    simulation = prepare(level_bed(sonar__pulse=CHIRP, receiver__noise=DENSITY))
    silence = np.zeros((200, 2, simulation.arrays.bins), np.float32)
    measured = receive(simulation.reception, silence, np.arange(200)).astype(np.float64).mean()
    assert decibels(measured) == pytest.approx(decibels(simulation.reception.find(Noise).level), abs=0.05)


@pytest.mark.parametrize(
    ("sonar", "expected"),
    [
        ({"sonar__beam": "knife"}, 2.0),
        # One half space of a line array: twice the 2L/λ of a line (Urick 1983, table 3.2).
        ({"sonar__beam": {"kind": "array", "length": 0.5}}, 4.0 * 0.5 * 400e3 / C),
        # A rectangle in a baffle: 4πLh/λ² (Urick 1983, table 3.2).
        (
            {
                "sonar__beam": {"kind": "array", "length": 0.5},
                "sonar__vertical": {"kind": "array", "height": 0.05, "tilt": 20.0},
            },
            4.0 * math.pi * 0.5 * 0.05 * (400e3 / C) ** 2,
        ),
        ({"sonar__beam": {"kind": "fan", "width": 2.0}}, 4.0 / (2.0 * math.sin(math.radians(1.0)))),
        (
            {"sonar__beam": {"kind": "fan", "width": 2.0}, "sonar__vertical": {"kind": "fan", "width": 40.0}},
            4.0 * math.pi / (2.0 * math.sin(math.radians(1.0)) * math.radians(40.0)),
        ),
    ],
)
def test_directivity_against_closed_forms(sonar, expected):
    sonar = level_bed(sonar__frequency=400e3, **sonar).sonar
    assert decibels(directivity(sonar, C)) == pytest.approx(decibels(expected), abs=0.1)


# Spectrum levels in dB re 1 µPa²/Hz by sea state at 10 and 100 kHz (Sadowski 1984, NUSC Technical Document 7265).
SEA_STATES = {0.0: (27.1, 9.0), 2.5: (36.5, 18.4), 4.5: (42.8, 24.6), 6.7: (46.6, 28.4), 9.4: (48.9, 30.8),
              12.3: (50.9, 32.8), 15.5: (53.5, 35.4)}  # fmt: skip


@pytest.mark.parametrize(("wind", "levels"), SEA_STATES.items())
def test_wind_noise_follows_the_tabulated_sea_states(wind, levels):
    assert [wind_noise(f, wind) for f in (10e3, 100e3)] == pytest.approx(levels, abs=3.5)


def test_thermal_noise_is_that_of_the_available_power():
    """4πKTρf²/c per hertz (Mellen 1952), at 10 °C."""
    pressure = 4.0 * math.pi * 1.380649e-23 * 283.15 * 1027.0 * (100e3) ** 2 / 1490.0 * 1e12
    assert thermal_noise(100e3) == pytest.approx(decibels(pressure), abs=0.4)
    assert thermal_noise(100e3) == pytest.approx(25.0, abs=0.1)  # as tabulated


def test_the_noises_of_the_sea_add_up():
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
        {"sonar__beam": {"kind": "array", "length": 0.5}, "sonar__pulse": CHIRP},
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


def test_a_range_without_bed_is_refused():
    for at in (5.0, 60.0):
        with pytest.raises(SceneError, match=r"receiver\.noise: there is no echo of the bed at"):
            noise_of(receiver__noise={"kind": "snr", "at": at})


def test_noise_in_micropascals_needs_a_source():
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
