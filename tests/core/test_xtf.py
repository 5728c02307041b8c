"""Recordings: what a file may hold, what is damaged, cut or of a kind that is not read, and a real one."""

import ctypes
import os
import pickle
from pathlib import Path

import numpy as np
import pytest
import pyxtf
import rasterio
import xarray as xr
from PIL import Image

from commands import refused
from insonify.cli import main
from insonify.display.display_options import DisplayOptions
from insonify.display.sheet import gather_record_sheet
from insonify.errors import FileWarning
from insonify.io import record_schema
from insonify.io.records import bottom_track, read_record, recording, write_record
from insonify.scene import SceneError
from insonify.statistics import record_statistics
from insonify.statistics.record_statistics import measure_statistics
from insonify.surveys import mosaic, swath
from xtf_files import FAR_TO_NEAR, NEAR_TO_FAR, PING, PORT, STARBOARD, SUBBOTTOM, amplitudes, write_xtf

SIDES = [[1, 2, 3, 4], [10, 20, 30, 40]]  # amplitudes of a ping


@pytest.mark.parametrize(
    ("kind", "told"),
    [("u1", True), ("<u2", True), ("<u4", True), ("<f4", True), ("u1", False), ("<u2", False), ("<u4", False)],
)
def test_samples_of_every_format_are_amplitudes_near_to_far(tmp_path, kind, told):
    record = read_record(write_xtf(tmp_path / "a.xtf", [PING, PING], kind=kind, told=told))
    np.testing.assert_allclose(amplitudes(record)[:, 0], SIDES)
    assert record["channel"].values.tolist() == ["port", "starboard"]
    np.testing.assert_allclose(record["slant_range"], [3.75, 11.25, 18.75, 26.25])
    np.testing.assert_allclose(record["travel_time"], record["slant_range"] * 0.04 / 30.0)
    assert record.attrs == {"title": "a.xtf", "frequency": 600e3}


@pytest.mark.parametrize(
    ("ping", "channels", "expected"),
    [
        ({"samples": [[7, 7], NEAR_TO_FAR, FAR_TO_NEAR, [9] * 4]}, (SUBBOTTOM, STARBOARD, PORT, STARBOARD), SIDES),
        ({"samples": [NEAR_TO_FAR]}, (STARBOARD,), [[0, 0, 0, 0], [10, 20, 30, 40]]),
        ({**PING, "Weight": 3}, (PORT, STARBOARD), np.array(SIDES) / 8.0),
    ],
    ids=["type counts, not order", "one side alone", "weight"],
)
def test_channels_become_sides(tmp_path, ping, channels, expected):
    record = read_record(write_xtf(tmp_path / "a.xtf", [ping], channels=channels))
    np.testing.assert_allclose(amplitudes(record)[:, 0], expected)


def test_pings_of_other_lengths_and_ranges_share_the_usual_grid(tmp_path):
    short, ramp = {"samples": [[2, 1], [10, 20]]}, np.arange(16) * 5
    pings = [
        PING,
        {**short, "reaches": [15.0, 15.0]},  # the same samples, fewer
        {"samples": [ramp[::-1], ramp], "reaches": [60.0, 60.0]},  # twice as fine, twice as far
    ]
    record = read_record(write_xtf(tmp_path / "a.xtf", pings))
    assert record.sizes["range_sample"] == 8
    np.testing.assert_allclose(record["slant_range"], (np.arange(8) + 0.5) * 7.5)
    got = amplitudes(record)
    np.testing.assert_allclose(got[1, 0], [10, 20, 30, 40, 0, 0, 0, 0])
    np.testing.assert_allclose(got[0, 1], [1, 2, 0, 0, 0, 0, 0, 0])
    np.testing.assert_allclose(got[:, 2], np.tile(np.arange(8) * 10 + 2.5, (2, 1)), rtol=1e-6)


@pytest.mark.parametrize(
    ("given", "speed"), [(750.0, 1500.0), (1480.0, 1480.0), (740.0, 1480.0), (0.0, 1500.0), (9e9, 1500.0)]
)
def test_sound_speed_may_be_odd(tmp_path, given, speed):
    path = write_xtf(tmp_path / "a.xtf", [{**PING, "SoundVelocity": given}])
    content = bytearray(path.read_bytes())
    where = 1024 + ctypes.sizeof(pyxtf.XTFPingHeader) + pyxtf.XTFPingChanHeader.TimeDuration.offset
    content[where : where + 4] = bytes(4)  # else range and duration tell the speed
    path.write_bytes(content)
    record = read_record(path)
    np.testing.assert_allclose(2.0 * record["slant_range"] / record["travel_time"], speed)


def test_the_platform_in_the_conventions_of_scenes(tmp_path):
    told = {"SensorPitch": 3.0, "SensorRoll": 2.0, "SensorDepth": 20.0, "SensorPrimaryAltitude": 5.0}
    told["SensorHeading"] = 90.0  # east, which is 0 in a scene
    # The first ping has no fix, others repeat theirs.
    fixes = [(0.0, 0.0), (-68.0, 48.0), (-68.0, 48.0), (-67.999, 48.001), (-67.999, 48.001)]
    pings = [{**PING, **(told if x else {}), "SensorXcoordinate": x, "SensorYcoordinate": y} for x, y in fixes]
    record = read_record(write_xtf(tmp_path / "a.xtf", pings))
    np.testing.assert_allclose(record["platform_x"], np.array([0, 0, 0.5, 1, 1]) * 74.6286, rtol=1e-4)
    np.testing.assert_allclose(record["platform_y"], np.array([0, 0, 0.5, 1, 1]) * 111.2, rtol=1e-3)
    for name, value in (("heading", 0.0), ("pitch", 3.0), ("roll", 2.0), ("depth", 20.0), ("altitude", 5.0)):
        np.testing.assert_allclose(record[f"platform_{name}"], value, atol=1e-9)


def test_wild_positions_do_not_count(tmp_path):
    xs = [-68.0, 1e300, -68.0, np.nan, -67.999]
    pings = [{**PING, "SensorXcoordinate": x, "SensorYcoordinate": 48.0} for x in xs]
    x = read_record(write_xtf(tmp_path / "a.xtf", pings))["platform_x"]
    np.testing.assert_allclose(x[[0, 4]], [0.0, 74.63], atol=0.01)
    assert (np.diff(x) >= 0.0).all()


UNKNOWN = dict.fromkeys(("platform_altitude", "platform_heading"), np.nan)
LATE, EARLY = {"Hour": 23, "Minute": 59, "Second": 59, "HSeconds": 50}, {"Second": 0, "HSeconds": 25}
METRES = [{**PING, "ShipXcoordinate": 5e5 + 2.0 * n, "ShipYcoordinate": 4e6} for n in range(4)]


@pytest.mark.parametrize(
    ("pings", "header", "expected"),
    [
        (METRES, {"NavUnits": 0}, {"platform_x": [0.0, 2.0, 4.0, 6.0], "platform_y": 0.0}),
        ([{**PING, **LATE}, {**PING, **EARLY}], {}, {"ping_time": [0.0, 0.75]}),
        ([{**PING, "Second": 0}] * 3, {}, {"ping_time": [0.0, 1.0, 2.0]}),
        ([{**PING, "SensorSpeed": 2.0}] * 3, {}, {"platform_y": np.arange(3) * 2.0 * 1852.0 / 3600.0} | UNKNOWN),
    ],
    ids=["positions in metres", "past midnight", "without a clock, a second a ping", "speed alone gives the way"],
)
def test_positions_and_times(tmp_path, pings, header, expected):
    record = read_record(write_xtf(tmp_path / "a.xtf", pings, **header))
    for name, values in expected.items():
        np.testing.assert_allclose(record[name], values)


def test_other_packets_padding_and_an_index_beside_the_file_are_passed_over(tmp_path):
    path = write_xtf(tmp_path / "a.xtf", [PING, PING])
    other = pyxtf.XTFAttitudeData()
    other.NumBytesThisRecord = 64
    content = path.read_bytes()
    path.write_bytes(content[:1024] + bytes(other) + bytes(64 - ctypes.sizeof(other)) + content[1024:] + bytes(500))
    index = tmp_path / "a.pyxtf_idx"
    index.write_bytes(pickle.dumps({}))
    assert read_record(path).sizes["ping_time"] == 2
    index.unlink()
    read_record(path)
    assert list(tmp_path.iterdir()) == [path]


def moving(pings: int, rate: float, *, whole: bool, degrees: bool = True, **fields) -> list[dict]:
    """Pings on a course to the north-east at 1.2 m/s, from half a second after a tick of the clock on."""
    made = []
    for n in range(pings):
        time, way = 10.5 + n / rate, 1.2 * n / rate
        place = (7.5 + way / 2**0.5 / 73_200.0, 48.8 + way / 2**0.5 / 111_200.0) if degrees else (3.0 + way, 5.0)
        fix = dict(zip(("SensorXcoordinate", "SensorYcoordinate"), place))
        clock = {"Minute": int(time) // 60, "Second": int(time) % 60, "HSeconds": 0 if whole else round(time % 1 * 100)}
        made.append({**PING, **clock, **fix, "SensorSpeed": 2.333, **fields})
    return made


@pytest.mark.parametrize("rate", [4.0, 7.0])
def test_a_clock_of_whole_seconds_is_spread_over_its_pings(tmp_path, rate):
    """Positions are those of a clock of hundredths, within what a ping moves in the tick that begins the recording."""
    rough, fine = (read_record(write_xtf(tmp_path / "a.xtf", moving(90, rate, whole=whole))) for whole in (True, False))
    assert (np.diff(rough.ping_time) > 0.0).all()
    np.testing.assert_allclose(rough.ping_time, fine.ping_time, atol=1.0 / rate)
    for axis in ("platform_x", "platform_y"):
        np.testing.assert_allclose(rough[axis], fine[axis], atol=0.02)
    # A pause is not filled: the pings before it keep their rate.
    paused = moving(40, 4.0, whole=True)
    for ping in paused[22:]:
        ping["Minute"] += 3
    times = read_record(write_xtf(tmp_path / "b.xtf", paused)).ping_time.values
    assert np.sort(np.diff(times))[-2] < 0.5
    assert np.argmax(np.diff(times)) == 21


def test_a_clock_that_goes_back_counts_on_and_is_told(tmp_path):
    pings = moving(60, 5.0, whole=False)
    for ping in pings[30:]:
        ping["Second"] -= 2
    with pytest.warns(FileWarning, match="its clock goes back at ping 30"):
        record = read_record(write_xtf(tmp_path / "a.xtf", pings))
    assert (np.diff(record.ping_time) > 0.0).all()
    assert np.diff(record.platform_x).max() < 1.0
    with pytest.warns(FileWarning, match="its clock goes back at ping 1"):
        record = read_record(write_xtf(tmp_path / "a.xtf", [{**pings[0], "Second": 9 - n} for n in range(5)]))
    np.testing.assert_array_equal(record.ping_time, np.arange(5.0))


@pytest.mark.parametrize("numbered", ["alike", "each", "not"])
@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_sides_that_are_stored_one_by_one_are_joined(tmp_path, numbered, order):
    pings = []
    for n in range(12):
        for at, row in enumerate(order):
            number = {"alike": n, "each": 2 * n + at, "not": 0}[numbered]
            one = {"samples": [None, None], "Second": n, "PingNumber": number}
            one["samples"][row] = [[4 + n, 3, 2, 1], NEAR_TO_FAR][row]
            pings.append(one)
    record = read_record(write_xtf(tmp_path / "a.xtf", pings))
    assert record.sizes["ping_time"] == 12
    expected = np.array([[[1, 2, 3, 4 + n] for n in range(12)], [NEAR_TO_FAR] * 12])
    np.testing.assert_allclose(amplitudes(record), expected)
    if numbered != "alike":
        return
    del pings[7]  # the second side of a ping is lost, and no other takes its place
    got = amplitudes(read_record(write_xtf(tmp_path / "a.xtf", pings)))
    expected[order[1], 3] = 0
    np.testing.assert_allclose(got, expected)


def test_the_unit_of_positions_is_the_one_that_gives_the_speed(tmp_path):
    right = read_record(write_xtf(tmp_path / "a.xtf", moving(60, 5.0, whole=False)))
    for speed in (2.333, 0.0):
        pings = moving(60, 5.0, whole=False, SensorSpeed=speed)
        with pytest.warns(FileWarning, match=r"declares positions in metres, .* they are read as degrees: 1\.2 m/s"):
            read = read_record(write_xtf(tmp_path / "b.xtf", pings, NavUnits=0))
        np.testing.assert_allclose(read.platform_x, right.platform_x, atol=1e-6)
        assert read.attrs["crs"] == right.attrs["crs"]
    pings = [{**ping, "SensorXcoordinate": 4.1e5 + n} for n, ping in enumerate(moving(20, 5.0, whole=False))]
    with pytest.warns(FileWarning, match="they are read as metres"):
        read = read_record(write_xtf(tmp_path / "b.xtf", pings, NavUnits=3))
    np.testing.assert_allclose(read.platform_x, np.arange(20.0))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("jitter", [0.0, 2e-3])
def test_metres_stay_metres_where_the_fish_stands_still_or_moves(tmp_path, jitter):
    rng = np.random.default_rng(4)
    moved = read_record(write_xtf(tmp_path / "a.xtf", moving(40, 5.0, whole=False, degrees=False), NavUnits=0))
    np.testing.assert_allclose(moved.platform_x, 1.2 * np.arange(40) / 5.0)
    still = moving(40, 5.0, whole=False, degrees=False, SensorSpeed=0.0)
    still = [{**ping, "SensorXcoordinate": 3.0 + jitter * rng.normal(), "SensorYcoordinate": 5.0} for ping in still]
    record = read_record(write_xtf(tmp_path / "a.xtf", still, NavUnits=0))
    assert np.ptp(record.platform_x.values) < 0.02


def test_a_fish_that_stands_still_has_a_picture_and_a_mosaic_and_a_speed_against_it_is_told(tmp_path, capsys):
    rng = np.random.default_rng(5)
    pings = [
        {"samples": rng.integers(1, 999, (2, 100)), "SensorPrimaryAltitude": 5.0, "SensorXcoordinate": 7.5,
         "SensorYcoordinate": 48.8, "SensorHeading": 30.0, "SensorSpeed": 4.0, "Second": n}
        for n in range(40)
    ]  # fmt: skip
    path = str(write_xtf(tmp_path / "a.xtf", pings))
    with pytest.warns(FileWarning, match="its positions move by 0 m, its speed gives 80.3 m"):
        assert np.ptp(read_record(path).platform_x.values) == 0.0
    for words in (["render", path, "-o", str(tmp_path / "a.png")], ["mosaic", path, "-o", str(tmp_path / "a.tif")]):
        assert main(words) == 0
    assert capsys.readouterr().err.count("the positions are taken") == 2


@pytest.fixture
def read_in_parts(monkeypatch):
    """Let recordings of any size stay in their files, and be read a few pings at a time."""
    monkeypatch.setattr(recording, "FEW_ECHOES", 0)
    monkeypatch.setattr(recording, "ECHOES_TOGETHER", 500)
    for module, name in ((bottom_track, "SUMS_TOGETHER"), (record_schema, "BLOCK_ECHOES")):
        monkeypatch.setattr(module, name, 3000)
    monkeypatch.setattr(record_statistics, "STRETCH", 64)
    monkeypatch.setattr(swath, "BLOCK", 3000)
    monkeypatch.setattr(mosaic, "STRIP", 5000)


def long_recording(path: Path, pings: int = 300, bins: int = 330) -> Path:
    """Write pings of three lengths, some of one side alone, over a bed 4 m beneath."""
    rng, made = np.random.default_rng(7), moving(pings, 5.0, whole=False, SensorHeading=45.0)
    for n, ping in enumerate(made):
        count = bins if n % 50 else bins // 2
        echo = np.where(np.arange(count) < 40 + 5 * np.sin(n / 20.0), 3.0, 900.0) * rng.rayleigh(size=(2, count))
        reach = 33.0 if n % 7 else 30.0
        ping |= {"samples": [np.ceil(echo[0])[::-1], None if n % 60 == 59 else np.ceil(echo[1])]}
        ping |= {"reaches": [reach * count / bins] * 2}
    return write_xtf(path, made)


def test_a_recording_that_stays_in_its_file_gives_the_same_as_one_in_memory(tmp_path, request):
    path = long_recording(tmp_path / "a.xtf")

    def everything():
        record = read_record(path)
        main(["mosaic", str(path), "-o", str(tmp_path / "a.tif"), "--cell", "0.2", "--overlap", "nearest"])
        with rasterio.open(tmp_path / "a.tif") as file:
            level = file.read(1)
        sheet = gather_record_sheet(record, DisplayOptions())
        return record, level, measure_statistics(record), sheet

    record, level, measured, sheet = everything()
    request.getfixturevalue("read_in_parts")
    stored, parts, in_parts, sheet_of_parts = everything()
    assert not stored.intensity.variable._in_memory
    xr.testing.assert_identical(stored.load(), record)
    np.testing.assert_array_equal(parts, level)
    np.testing.assert_array_equal(sheet_of_parts.amplitude, sheet.amplitude)
    for one, other in zip(in_parts, measured):
        np.testing.assert_array_equal(one, other)
    some = read_record(path)
    wanted = np.array([5, 250, 17])
    np.testing.assert_array_equal(some.intensity[1, wanted, 3:9], record.intensity[1, wanted, 3:9])
    np.testing.assert_array_equal(some.bottom_track[-1], record.bottom_track[-1])


def test_a_file_that_changes_after_it_was_opened_is_one_sentence(tmp_path, read_in_parts):
    path = long_recording(tmp_path / "a.xtf")
    record = read_record(path)
    path.write_bytes(path.read_bytes()[:-64])
    with pytest.raises(SceneError, match=r"a.xtf: has changed since it was opened; open it again$"):
        record.intensity.load()
    path.unlink()
    with pytest.raises(SceneError, match=r"a.xtf: .*open it again$"):
        record.intensity.load()


def two_frequencies(tmp_path: Path) -> Path:
    """Write low port, low starboard, high port and high starboard channels in each ping."""
    pings = [{"samples": [FAR_TO_NEAR, NEAR_TO_FAR, [7] * 8, [9] * 8]}] * 3
    path = write_xtf(tmp_path / "a.xtf", pings, channels=(PORT, STARBOARD, PORT, STARBOARD))
    content = bytearray(path.read_bytes())
    for number, frequency in enumerate((100.0, 100.0, 400.0, 400.0)):
        where = 256 + 128 * number + pyxtf.XTFChanInfo.Frequency.offset
        content[where : where + 4] = np.float32(frequency).tobytes()
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(("wanted", "frequency", "bins"), [(None, 100e3, 4), (1e5, 100e3, 4), (4.1e5, 400e3, 8)])
def test_both_frequencies_can_be_read_and_no_other(tmp_path, capsys, wanted, frequency, bins):
    path = two_frequencies(tmp_path)
    record = read_record(path, wanted)
    assert record.attrs["frequency"] == frequency
    assert record.attrs["frequencies"] == "100000, 400000"
    expected = SIDES if bins == 4 else [[7] * 8, [9] * 8]
    np.testing.assert_allclose(amplitudes(record)[:, 2], expected)
    words = [] if wanted is None else ["--frequency", str(wanted)]
    assert main(["render", str(path), "-o", str(tmp_path / "a.npz"), *words]) == 0
    assert f"2 x {bins} bins" in capsys.readouterr().out
    with pytest.raises(SceneError, match=r"has no channels of 900000 Hz; choose 100000 or 400000$"):
        read_record(path, 9e5)
    write_record(tmp_path / "a.nc", [record])
    with pytest.raises(SceneError, match="has a single frequency; leave the frequency out"):
        read_record(tmp_path / "a.nc", 4e5)


def test_channels_that_ping_in_turn_are_told_apart(tmp_path):
    """A sonar may ping at one frequency, then at the other."""
    path = two_frequencies(tmp_path)
    content = bytearray(path.read_bytes())
    chan = ctypes.sizeof(pyxtf.XTFPingChanHeader)
    size = -(-(256 + 4 * chan + 2 * 2 * (4 + 8)) // 64) * 64
    ping = content[1024 : 1024 + size]
    low = 256 + 2 * (chan + 8)
    high = ping[:256] + ping[low : low + 2 * (chan + 16)]
    lower = content[1024 + size : 1024 + 2 * size]
    for packet in (high, lower):
        packet[4:6] = (2).to_bytes(2, "little")
    high[10:14] = len(high).to_bytes(4, "little")
    path.write_bytes(bytes(content[:1024] + high + lower))
    assert read_record(path, 4e5).sizes["ping_time"] == read_record(path, 1e5).sizes["ping_time"] == 1
    np.testing.assert_allclose(amplitudes(read_record(path, 4e5))[:, 0], [[7] * 8, [9] * 8])


FOREIGN = {
    "a.slg": "Lowrance", "b.SVLOG": "Cerulean", "d.s7k": "Teledyne Reson s7k",
    "e.all": "Kongsberg", "f.sdf": "Klein",
}  # fmt: skip


@pytest.mark.parametrize("command", [["render", "-o", "out.png"], ["plan"], ["compare", "wreck", "-o", "out.png"]])
def test_formats_of_others_are_named_with_a_converter(tmp_path, capsys, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    for name, called in FOREIGN.items():
        (tmp_path / name).write_bytes(bytes(range(256)))
        error = refused(capsys, command[0], name, *command[1:])
        assert error.startswith(f"insonify: {name}: is in the format {called}")
        assert "which is not read here; export it as XTF, for example with S" in error


@pytest.mark.parametrize("content", [b"\0" * 100, b"title\0\0", bytes(range(256)), b"\x7fELF\x02\x01\x01\0"])
def test_a_binary_file_is_not_taken_for_toml(tmp_path, capsys, content):
    (tmp_path / "a.bin").write_bytes(content)
    error = refused(capsys, "plan", str(tmp_path / "a.bin"))
    assert "TOML (" not in error
    assert "give a" in error
    assert "TOML file" in error


@pytest.mark.parametrize("suffix", [".png", ".nc", ".npz"])
def test_render_takes_a_recording(tmp_path, capsys, suffix):
    rng = np.random.default_rng(1)
    pings = [{"samples": rng.integers(1, 999, (2, 100)), "SensorPrimaryAltitude": 5.0} for _ in range(9)]
    source, path = write_xtf(tmp_path / "a.xtf", pings), tmp_path / f"b{suffix}"
    assert main(["render", str(source), "-o", str(path)]) == 0
    assert "9 pings of 2 x 100 bins" in capsys.readouterr().out
    if suffix == ".png":
        with Image.open(path) as picture:
            assert min(picture.size) > 400
    else:
        xr.testing.assert_equal(read_record(path), read_record(source))


@pytest.mark.parametrize(
    "words", [("--set", "track.pings=3"), ("--seed", "3"), ("--method", "rays"), ("--tolerance", "0.1")]
)
def test_a_recording_takes_no_options_of_scenes(tmp_path, capsys, words):
    source = write_xtf(tmp_path / "a.xtf", [PING])
    error = refused(capsys, "render", str(source), "-o", str(tmp_path / "a.png"), *words)
    assert f"{words[0]} applies to scenes" in error


def test_a_real_recording(real_recording):
    before = sorted(real_recording.parent.iterdir())
    record = read_record(real_recording)
    assert sorted(real_recording.parent.iterdir()) == before
    assert dict(record.sizes) == {"channel": 2, "ping_time": 461, "range_sample": 1024}
    np.testing.assert_allclose(float(record["slant_range"][-1]), 29.98, atol=0.03)
    np.testing.assert_allclose(2.0 * record["slant_range"] / record["travel_time"], 1500.0, rtol=1e-6)
    x, y = record["platform_x"].values, record["platform_y"].values
    assert np.hypot(x[-1] - x[0], y[-1] - y[0]) == pytest.approx(54.7, abs=0.5)
    course = np.degrees(np.arctan2(y[-1] - y[0], x[-1] - x[0]))
    assert abs(course - float(record["platform_heading"].mean())) < 25.0
    amplitude = amplitudes(record)
    # The water above the bed is quiet, and the bed begins at the altitude.
    assert np.median(amplitude[:, :, 10:80]) < 0.05 * np.median(amplitude[:, :, 400:600])


FIRST_CUT = "ends within the packet at byte 1024, before one ping is whole; copy it again"
NO_PINGS = "holds no side-scan pings; give a recording with port or starboard channels"
# What becomes of the bytes of a file, and what is said of it.
BROKEN = {
    "empty": (lambda file: b"", "has 0 bytes, less than the header of an XTF file; copy it again"),
    "text": (lambda file: b"title = 'a scene'\n" * 100, "is not an XTF file"),
    "header alone": (lambda file: file[:1024], NO_PINGS),
    "first cut": (lambda file: file[:1200], FIRST_CUT),
    "no length": (lambda file: file[:1034] + bytes(4) + file[1038:], "holds no XTF packet at byte 1024"),
    "noise": (lambda file: file[:1024] + b"\x5a" * 2000, "holds no XTF packet at byte 1024"),
    "too few channels": (lambda file: file[:1028] + b"\x09" + file[1029:], "declares more channels than ping 0 has"),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_a_broken_file_is_one_sentence(tmp_path, capsys, fault):
    spoil, expected = BROKEN[fault]
    path = write_xtf(tmp_path / "a.xtf", [PING, PING])
    path.write_bytes(spoil(path.read_bytes()))
    assert expected in refused(capsys, "render", str(path), "-o", str(tmp_path / "a.png"))
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("whole", [1, 2])
def test_a_cut_file_keeps_its_whole_pings_and_warns(tmp_path, capsys, whole):
    path = write_xtf(tmp_path / "a.xtf", [PING, PING, PING])
    size = (len(path.read_bytes()) - 1024) // 3
    os.truncate(path, 1024 + size + 9 if whole == 1 else 1024 + 3 * size - 100)  # in a start, or behind it
    assert main(["render", str(path), "-o", str(tmp_path / "a.npz")]) == 0
    written = capsys.readouterr()
    assert f"{whole} pings of 2 x 4 bins" in written.out
    assert written.err.count("\n") == 1
    assert "a.xtf: ends within the packet at byte" in written.err
    assert "the whole pings before are read" in written.err
    with pytest.warns(FileWarning, match="ends within the packet"):
        record = read_record(path)
    np.testing.assert_allclose(amplitudes(record)[:, 0], SIDES)


def test_what_cannot_be_understood_is_refused(tmp_path):
    path = write_xtf(tmp_path / "a.xtf", [PING], channels=(SUBBOTTOM, SUBBOTTOM))
    with pytest.raises(SceneError, match=NO_PINGS):
        read_record(path)
    for field, value, fault in (
        (pyxtf.XTFChanInfo.SampleFormat, 1, "samples of format 1 and 2 bytes, which is not read here"),
        (pyxtf.XTFChanInfo.CorrectionFlags, 2, "is corrected to ground range; export it in slant range"),
    ):
        content = bytearray(write_xtf(path, [PING]).read_bytes())
        for number in (0, 1):
            content[256 + 128 * number + field.offset] = value
        path.write_bytes(content)
        with pytest.raises(SceneError, match=fault):
            read_record(path)
    for pings, kind, fault in (
        ([{"samples": [[np.nan], [1.0]]}], "<f4", "that are not echoes"),
        ([PING, PING, {**PING, "reaches": [3e4, 3e4]}], "<u2", "has slant ranges up to 3e"),
    ):
        with pytest.raises(SceneError, match=fault):
            read_record(write_xtf(path, pings, kind=kind))
    content = bytearray(write_xtf(path, [PING], kind="<u4").read_bytes())
    size = ctypes.sizeof(pyxtf.XTFPingHeader) + ctypes.sizeof(pyxtf.XTFPingChanHeader) + 8  # of two samples alone
    content[1024 + 10 : 1024 + 14] = size.to_bytes(4, "little")
    path.write_bytes(content[: 1024 + size])
    with pytest.raises(SceneError, match="less than the 4 samples it announces"):
        read_record(path)
