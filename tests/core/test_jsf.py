"""JSF recordings: messages of side-scan data as EdgeTech describes them."""

import numpy as np
import pytest

from commands import refused
from insonify.cli import main
from insonify.errors import FileWarning
from insonify.io.navigation.formats import read_recording
from insonify.io.records import read_record, write_record
from jsf_files import message, trace, write_jsf
from xtf_files import amplitudes

PING = {"samples": [np.array([1, 2, 3, 4]), np.array([10, 20, 30, 40])]}


def test_envelopes_are_amplitudes_near_to_far(tmp_path):
    record = read_record(write_jsf(tmp_path / "a.jsf", [PING, PING]))
    np.testing.assert_allclose(amplitudes(record)[:, 1], [[1, 2, 3, 4], [10, 20, 30, 40]])
    step = 1480.0 * 40e-6 / 2.0
    np.testing.assert_allclose(record.slant_range, step * np.array([0.5, 1.5, 2.5, 3.5]))
    np.testing.assert_allclose(record.travel_time, 40e-6 * np.array([0.5, 1.5, 2.5, 3.5]))
    np.testing.assert_allclose(record.ping_time, [0.0, 1.0])
    assert record.attrs["frequency"] == 410e3
    assert record.attrs["time_coverage_start"] == "2023-11-14T22:13:20"


MANY = np.arange(70_000) % 1000
SIGNAL = np.array([[3, 4], [-5, 12], [8, -15]])


@pytest.mark.parametrize(
    ("pings", "starboard"),
    [
        ([PING, {**PING, "weight": 3}, {**PING, "weight": -2}], np.outer([1.0, 0.125, 4.0], [10, 20, 30, 40])),
        ([{"samples": [SIGNAL, 2 * SIGNAL], "format": 1}], [[10, 26, 34]]),
        ([{"samples": [MANY, MANY], "interval": 1000}], [MANY]),
    ],
    ids=["weights are taken out", "analytic signals become magnitudes", "more than 65535 samples"],
)
def test_samples_become_amplitudes(tmp_path, pings, starboard):
    record = read_record(write_jsf(tmp_path / "a.jsf", pings))
    np.testing.assert_allclose(amplitudes(record)[1], starboard, rtol=1e-6)


def test_late_recording_fractions_of_a_nanosecond_and_milliseconds_of_the_day_count(tmp_path):
    record = read_record(write_jsf(tmp_path / "a.jsf", [{**PING, "skipped": 2, "fraction": 128, "interval": 1000}]))
    np.testing.assert_allclose(amplitudes(record)[0, 0], [0, 0, 1, 2, 3, 4])
    np.testing.assert_allclose(record.travel_time, 1000.5e-9 * (np.arange(6) + 0.5))
    older = read_record(write_jsf(tmp_path / "b.jsf", [{**PING, "fraction": 128, "interval": 1000}], version=9))
    np.testing.assert_allclose(older.travel_time, 1000e-9 * (np.arange(4) + 0.5))
    day = 1_700_000_000 % 86_400 * 1000
    pings = [{**PING, "time": 1_700_000_000, "milliseconds": day + 250 * n} for n in range(5)]
    record = read_record(write_jsf(tmp_path / "c.jsf", pings))
    np.testing.assert_allclose(record.ping_time, 0.25 * np.arange(5), atol=1e-6)


def test_the_platform_is_in_the_conventions_of_scenes_and_what_is_not_valid_is_not_a_number(tmp_path):
    places = (-68.0, 48.0), (-68.0, 48.0), (-67.999, 48.001), (-67.999, 48.001)
    ping = PING | {"heading": 9000, "pitch": 546, "roll": -1092, "depth": 20_000, "altitude": 5_250}
    pings = [ping | {"x": round(x * 60e4), "y": round(y * 60e4)} for x, y in places]
    record = read_record(write_jsf(tmp_path / "a.jsf", pings))
    np.testing.assert_allclose(record.platform_x, np.array([0, 0.5, 1, 1]) * 74.6286, rtol=1e-4)
    np.testing.assert_allclose(record.platform_y, np.array([0, 0.5, 1, 1]) * 111.2, rtol=1e-3)
    np.testing.assert_allclose(record.platform_heading, 0.0, atol=1e-9)
    np.testing.assert_allclose(record.platform_pitch, 3.0, atol=0.003)
    np.testing.assert_allclose(record.platform_roll, -6.0, atol=0.003)
    np.testing.assert_allclose(record.platform_depth, 20.0)
    np.testing.assert_allclose(record.platform_altitude, 5.25)
    assert "+lat_0=48.0 +lon_0=-68.0" in record.attrs["crs"]
    pings = [{**PING, "validity": 1 << 6, "altitude": 5000, "heading": 100, "depth": 7000, "x": 1, "y": 1}] * 2
    record = read_record(write_jsf(tmp_path / "b.jsf", pings))
    np.testing.assert_allclose(record.platform_altitude, 5.0)
    for name in ("depth", "heading", "pitch", "roll"):
        assert np.isnan(record[f"platform_{name}"]).all()
    assert "origin_x" not in record.attrs


@pytest.mark.parametrize(("units", "metres"), [(1, 1e-3), (3, 0.1), (4, 0.01)])
def test_positions_may_be_in_parts_of_a_metre(tmp_path, units, metres):
    pings = [{**PING, "x": round((5e5 + 2.0 * n) / metres), "y": round(4e5 / metres), "units": units} for n in range(4)]
    record = read_record(write_jsf(tmp_path / "a.jsf", pings))
    np.testing.assert_allclose(record.platform_x, 2.0 * np.arange(4), atol=1e-9)
    assert (record.attrs["origin_x"], record.attrs["origin_y"]) == (5e5, 4e5)
    assert "crs" not in record.attrs


@pytest.mark.parametrize(("wanted", "frequency"), [(None, 410e3), (4e5, 410e3), (9e5, 887.68e3)])
def test_each_subsystem_can_be_read(tmp_path, wanted, frequency):
    # 65536 + 22000 to 65536 + 24464 in units of 10 Hz: the top bits stand in another field.
    path = write_jsf(tmp_path / "a.jsf", [PING, PING], subsystems=(21, 20))
    record = read_record(path, wanted)
    np.testing.assert_allclose(record.attrs["frequency"], frequency)
    assert record.attrs["frequencies"] == "410000, 887680"
    assert record.sizes["ping_time"] == 2


@pytest.mark.parametrize("less", [5, 250, 3 * 248 + 20])
def test_a_cut_file_keeps_its_whole_pings_and_warns(tmp_path, capsys, less):
    path = write_jsf(tmp_path / "a.jsf", [PING] * 4)
    path.write_bytes(path.read_bytes()[: -60 - less])
    with pytest.warns(FileWarning, match="ends within the packet at byte .*; the whole pings before are read"):
        record = read_record(path)
    assert record.sizes["ping_time"] == (2 if less > 500 else 3)
    assert (record.intensity.values > 0.0).all()
    assert main(["render", str(path), "-o", str(tmp_path / "a.png")]) == 0
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "holds no side-scan pings; give a recording of subsystem 20, 21 or 22"),
        (b"title = 'a scene'\n", "holds no JSF message at byte 0; copy or export it again"),
        (message(80, trace([1], 0))[:100], "ends within the packet at byte 0, before one ping is whole; copy it again"),
        (message(80, bytes(100)), "has a ping too short for its header; export it again"),
        (message(80, trace([1], format=2)), "has data of format 2 in ping 0, which is not an envelope; export it"),
        (message(80, trace([1])[:-2]), "has a ping with less than the 1 samples it announces; export it again"),
        (message(80, trace([1], interval=0)), "has no sampling interval of ping 0; export it again"),
        (message(80, trace([1], skipped=2**31)), "has no sampling interval of ping 0; export it again"),
        (message(80, trace([1]), subsystem=0), "holds no side-scan pings"),
    ],
)
def test_a_broken_file_is_one_sentence(tmp_path, capsys, content, expected):
    path = tmp_path / "a.jsf"
    path.write_bytes(content)
    error = refused(capsys, "render", str(path), "-o", str(tmp_path / "a.png"))
    assert "a.jsf: " in error
    assert expected in error
    assert list(tmp_path.iterdir()) == [path]


def test_a_recording_becomes_xtf(tmp_path):
    pings = [{**PING, "x": -408_000_00 + n, "y": 288_000_00, "heading": 4500, "altitude": 5000} for n in range(1, 5)]
    record = read_record(write_jsf(tmp_path / "a.jsf", pings))
    write_record(tmp_path / "a.xtf", [record])
    copy = read_record(tmp_path / "a.xtf")
    np.testing.assert_array_equal(copy.intensity, record.intensity)
    np.testing.assert_allclose(copy.platform_x, record.platform_x, atol=1e-4)
    assert copy.attrs["time_coverage_start"] == record.attrs["time_coverage_start"]


def course(pings: int, **fields) -> list[dict]:
    """Pings at 5 Hz on a course to the east at 1.5 m/s, by a clock of whole seconds."""
    east = np.arange(pings) * 0.3 / 73_200.0
    return [
        {**PING, "time": 1_700_000_000 + n // 5, "milliseconds": 0, "x": round((7.5 + each) * 60e4), "y": 29_280_000,
         "altitude": 4000, **fields}
        for n, each in enumerate(east)
    ]  # fmt: skip


def test_a_clock_of_whole_seconds_is_spread_over_its_pings_and_navigation_has_them_all(tmp_path):
    path = write_jsf(tmp_path / "a.jsf", course(60))
    record = read_record(path)
    np.testing.assert_allclose(record.ping_time, 0.2 * np.arange(60), atol=1e-6)
    np.testing.assert_allclose(record.platform_x, 0.3 * np.arange(60), atol=0.15)
    assert read_recording(str(path))["time"].size == 60


@pytest.mark.parametrize("number", [0, 77])
def test_pings_without_numbers_of_their_own_stay_apart(tmp_path, number):
    record = read_record(write_jsf(tmp_path / "a.jsf", course(20, ping=number)))
    assert record.sizes["ping_time"] == 20
    np.testing.assert_allclose(amplitudes(record)[:, 7], [[1, 2, 3, 4], [10, 20, 30, 40]])


def test_a_lost_side_shifts_no_other(tmp_path):
    content = message(182, bytes(24))
    for number in range(8):
        for channel, samples in enumerate(PING["samples"]):
            if (number, channel) != (3, 1):
                content += message(80, trace(samples, number), channel=channel)
    path = tmp_path / "a.jsf"
    path.write_bytes(content)
    got = amplitudes(read_record(path))
    assert got.shape[1] == 8
    assert (got[1, 3] == 0.0).all()
    np.testing.assert_allclose(np.delete(got[1], 3, axis=0), [[10, 20, 30, 40]] * 7)


def test_positions_without_a_unit_are_read_as_degrees_and_told(tmp_path):
    right = read_record(write_jsf(tmp_path / "a.jsf", course(40)))
    for units in (0, 1):  # not declared; declared as millimetres
        with pytest.warns(FileWarning, match="they are read as degrees"):
            read = read_record(write_jsf(tmp_path / "b.jsf", course(40, units=units)))
        np.testing.assert_allclose(read.platform_x, right.platform_x, atol=1e-6)


def test_a_measured_sound_speed_and_pings_of_unequal_length_share_a_grid(tmp_path):
    pings = course(30)
    for n, ping in enumerate(pings):
        ping["speed"] = 1480.0 + 0.01 * n
        if n % 10 == 9:
            ping["samples"] = [np.array([1, 2]), np.array([10, 20])]
    record = read_record(write_jsf(tmp_path / "a.jsf", pings))
    assert dict(record.sizes) == {"channel": 2, "ping_time": 30, "range_sample": 4}
    got = amplitudes(record)
    np.testing.assert_allclose(got[1, 8], [10, 20, 30, 40], rtol=1e-4)
    np.testing.assert_allclose(got[1, 9], [10, 20, 0, 0], rtol=1e-4)
