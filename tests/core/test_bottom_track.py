"""Bottom track: the altitude that a record shows by itself, against the altitude that is known."""

import numpy as np
import pytest

from insonify.cli import main
from insonify.io.records import read_record, write_record
from insonify.io.records.bottom_track import find_altitude, track_bottom
from insonify.scene import edit, load_scene
from insonify.simulation import simulate


def made_echo(edges, bins=400, contrast=100.0, speckle=True, ringing=0):
    """Noise of level 1 before the edge, a bed ``contrast`` times as strong at it which falls as r⁻⁴ beyond."""
    rng = np.random.default_rng(5)
    at, edges = np.arange(bins) + 0.5, np.asarray(edges, dtype=float)[:, None]
    bed = np.where(at > edges, contrast * (edges / at) ** 4, 0.0)
    mean = np.broadcast_to(1e-3 + bed, (2, *bed.shape)).copy()
    mean[..., :ringing] = 1e4
    return (mean * (rng.exponential(size=mean.shape) if speckle else 1.0)).astype(np.float32)


def test_a_clean_edge_is_found_to_half_a_bin_whatever_the_unit_of_intensity():
    edges = 100.0 + np.round(30.0 * np.sin(np.arange(80) / 9.0))
    found = track_bottom(made_echo(edges, speckle=False), 0.1)
    # The steadiest course cuts a peak of one ping by a bin.
    np.testing.assert_allclose(found, 0.1 * edges, atol=0.1501)
    assert np.mean(np.abs(found - 0.1 * edges) < 0.0501) > 0.9
    echo = made_echo(np.full(20, 90.0))
    for gain in (1e-12, 1e8):
        np.testing.assert_array_equal(track_bottom(np.float32(gain) * echo, 1.0), track_bottom(echo, 1.0))


def test_speckle_and_the_transmitted_pulse_and_fish_in_the_water_and_dropped_pings_do_not_move_it():
    for ringing in (0, 12):
        edges = 120.0 + 40.0 * np.sin(np.arange(120) / 15.0)
        found = track_bottom(made_echo(edges, ringing=ringing), 1.0)
        assert np.abs(found - edges).max() < 3.0
        assert np.abs(np.median(found - edges)) < 1.0
    edges = np.full(100, 150.0)
    echo = made_echo(edges)
    echo[:, 40:50, 60:75] = 1e3  # a school
    echo[:, 70:74] = 0.0
    echo[:, 80] = 1.0
    assert np.abs(track_bottom(echo, 1.0) - edges).max() < 4.0


def test_without_an_edge_there_is_no_number_and_small_records_do_no_harm():
    random = np.random.default_rng(1).exponential(size=(2, 40, 300)).astype(np.float32)
    for echo in (np.zeros((2, 9, 50), np.float32), np.ones((2, 9, 50), np.float32), random):
        assert np.isnan(track_bottom(echo, 0.1)).all()
    for pings, bins in ((1, 1), (3, 2), (1, 40)):
        assert track_bottom(random[:, :pings, :bins], 0.1).shape == (pings,)


@pytest.mark.parametrize(("name", "within"), [("wreck", 0.3), ("rough-tow", 0.25), ("sediments", 0.06)])
def test_simulations_show_their_altitude(name, within):
    record = simulate(edit(load_scene(name), {"track.pings": 120}))
    found = track_bottom(record.intensity.values, 2.0 * float(record.slant_range[0]))
    assert np.abs(found - record.platform_altitude).max() < within
    assert abs(float(np.median(found - record.platform_altitude))) < 0.05


def test_a_recording_without_altitude_is_drawn_by_its_bottom_track(tmp_path, capsys):
    record = simulate(edit(load_scene("sediments"), {"track.pings": 40}))
    known = record.platform_altitude.values.copy()
    record["platform_altitude"] = record.platform_altitude * np.nan
    np.testing.assert_allclose(find_altitude(record), known, atol=0.06)
    write_record(tmp_path / "a.xtf", [record])
    read = read_record(tmp_path / "a.xtf")
    assert np.isnan(read.platform_altitude).all()  # what was not measured stays unknown
    np.testing.assert_allclose(read.bottom_track, known, atol=0.06)
    assert read.bottom_track.attrs["units"] == "m"
    assert main(["render", str(tmp_path / "a.xtf"), "-o", str(tmp_path / "a.png"), "--ground-range"]) == 0
    record["intensity"] = 0.0 * record.intensity + 1.0
    write_record(tmp_path / "b.xtf", [record])
    assert main(["render", str(tmp_path / "b.xtf"), "-o", str(tmp_path / "b.png"), "--ground-range"]) == 2
    assert "the record has no altitude and shows no first echo of the bed; leave it out" in capsys.readouterr().err


def test_a_real_recording_keeps_both(real_recording):
    record = read_record(real_recording)
    amplitude = np.sqrt(record.intensity.values.mean(axis=0))
    bins = np.rint(record.bottom_track.values / (2.0 * float(record.slant_range[0]))).astype(int)
    rows = np.arange(len(bins))
    # The altimeter reads 0.3 m to 2.3 m less than where the bed's echo begins.
    assert float((record.bottom_track - record.platform_altitude).min()) > 0.2
    assert float((record.bottom_track - record.platform_altitude).max()) < 2.5
    before = np.median([amplitude[rows, bins - k] for k in range(10, 30)])
    after = np.median([amplitude[rows, bins + k] for k in range(10, 30)])
    assert after > 10.0 * before
