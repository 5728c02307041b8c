"""JSF recordings: messages of side-scan data as EdgeTech describes them."""

import struct
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from commands import refused
from insonify.cli import main
from insonify.errors import FileWarning
from insonify.io.navigation.formats import read_recording
from insonify.io.records import read_record, write_record
from insonify.io.records.jsf_writer import encode_nmea, encode_ping
from insonify.io.records.survey_log import LoggedPing
from jsf_files import message, trace, write_jsf
from xtf_files import amplitudes, made_record, packets, random_counts

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


def test_a_recording_becomes_xtf_and_jsf(tmp_path):
    pings = [{**PING, "x": -408_000_00 + n, "y": 288_000_00, "heading": 4500, "altitude": 5000} for n in range(1, 5)]
    record = read_record(write_jsf(tmp_path / "a.jsf", pings))
    for name in ("b.xtf", "b.jsf"):
        write_record(tmp_path / name, [record])
        copy = read_record(tmp_path / name)
        np.testing.assert_array_equal(copy.intensity, record.intensity)
        np.testing.assert_allclose(copy.platform_x, record.platform_x, atol=1e-4 if name == "b.xtf" else 0.1)
        assert copy.attrs["time_coverage_start"] == record.attrs["time_coverage_start"]


def messages(path: Path) -> list[tuple[int, int, int, bytes]]:
    return split_messages(path.read_bytes())


def split_messages(content: bytes) -> list[tuple[int, int, int, bytes]]:
    """Type, subsystem, channel and body of each message, to the end."""
    found = []
    while content:
        marker, _, _, kind, _, subsystem, channel, _, _, size = struct.unpack_from("<HBBHBBBBHi", content)
        assert marker == 0x1601
        found.append((kind, subsystem, channel, content[16 : 16 + size]))
        content = content[16 + size :]
    return found


def field(body: bytes, code: str, offset: int) -> float:
    return struct.unpack_from(f"<{code}", body, offset)[0]


def samples(body: bytes) -> np.ndarray:
    """Amplitudes by the manufacturer's rule: numbers of 16 bits times 2 to the power of minus the weight."""
    count = field(body, "H", 114) + (field(body, "H", 16) >> 8 & 15) * 65536
    assert len(body) == 240 + 2 * count
    return np.frombuffer(body, "<i2", offset=240) * 2.0 ** -field(body, "h", 168)


def test_a_written_record_is_what_an_independent_parser_and_this_reader_find(tmp_path):
    record = made_record(1e-3 * random_counts(11), crs="EPSG:32631", origin_x=560_000.0, origin_y=6_500_000.0)
    record = record.assign_attrs(frequency=900e3, time_coverage_start="2024-02-29T23:59:59.500000")
    write_record(tmp_path / "a.jsf", [record.isel(ping_time=slice(4)), record.isel(ping_time=slice(4, None))])
    found = messages(tmp_path / "a.jsf")
    assert [each[:3] for each in found] == [(2020, 101, 0), (80, 20, 0), (80, 20, 1)] * 7
    port, starboard = ([body for kind, _, side, body in found if (kind, side) == (80, row)] for row in (0, 1))
    exact = np.sqrt(record.intensity.values)
    got = np.array([list(map(samples, port)), list(map(samples, starboard))])
    unit = 2.0 ** -field(port[0], "h", 168)
    assert 2**14 <= exact.max() / unit < 2**15
    np.testing.assert_allclose(got, exact, atol=0.5 * unit)
    write_record(tmp_path / "a.xtf", [record])
    _, other = packets(tmp_path / "a.xtf")
    for number, (body, ping) in enumerate(zip(port, other)):
        seconds = 1_709_251_199.5 + number / 4.0
        assert (field(body, "i", 0), field(body, "I", 8)) == (int(seconds), number)
        assert field(body, "I", 200) == round(seconds % 86_400 * 1000)
        day = (2024, 60, 23, 59) if number < 2 else (2024, 61, 0, 0)
        assert struct.unpack_from("<4h", body, 156) == day
        places = [field(body, "i", at) / 60e4 for at in (80, 84)]
        np.testing.assert_allclose(places, [ping.SensorXcoordinate, ping.SensorYcoordinate], atol=0.5 / 60e4)
        np.testing.assert_allclose(field(body, "H", 172) / 100.0, ping.SensorHeading, atol=0.0051)
        turn = 180.0 / 32768.0
        np.testing.assert_allclose(field(body, "h", 174) * turn, ping.SensorPitch, atol=0.51 * turn)
        np.testing.assert_allclose(field(body, "h", 176) * turn, ping.SensorRoll, atol=0.51 * turn)
        np.testing.assert_allclose(field(body, "i", 136) / 1e3, ping.SensorDepth, atol=6e-4)
        np.testing.assert_allclose(field(body, "i", 144) / 1e3, ping.SensorPrimaryAltitude, atol=6e-4)
        knots = field(body, "h", 194) / 10.0 + (field(body, "H", 20) & 15) / 100.0
        np.testing.assert_allclose(knots, ping.SensorSpeed, atol=0.0051)
        np.testing.assert_allclose(field(body, "f", 148), 1480.0, rtol=1e-6)
        step = field(body, "I", 116) + (field(body, "H", 18) & 255) / 256.0
        np.testing.assert_allclose(step * 1e-9, 2.0 * 0.05 / 1480.0, rtol=1e-6)
        assert field(body, "H", 126) + (field(body, "H", 16) & 15) * 65536 == 90_000
        assert field(body, "H", 30) == 0b100001001101101
    attitude = next(body for kind, *_, body in found if kind == 2020)
    assert len(attitude) == 44
    assert field(attitude, "i", 36) == 1 << 6 | 1 << 7 | 1 << 9
    np.testing.assert_allclose(field(attitude, "h", 24) * 180.0 / 32768.0, 2.0, atol=0.003)
    read, same = read_record(tmp_path / "a.jsf"), read_record(tmp_path / "a.xtf")
    np.testing.assert_array_equal(read.intensity, same.intensity)
    for name in ("slant_range", "travel_time", "ping_time"):
        np.testing.assert_allclose(read[name], record[name], rtol=1e-6, atol=1e-9)
    for name, close in {"x": 0.3, "y": 0.2, "heading": 0.006, "depth": 1e-3, "pitch": 0.003, "roll": 0.003}.items():
        np.testing.assert_allclose(read[f"platform_{name}"], same[f"platform_{name}"], atol=close)
    assert (read.attrs["frequency"], read.attrs["time_coverage_start"]) == (900e3, "2024-02-29T23:59:59.500000")


@pytest.mark.filterwarnings("ignore::FutureWarning", "ignore::DeprecationWarning", "ignore::ResourceWarning")
def test_programs_of_others_draw_the_same_picture_of_both_formats(tmp_path):
    pytest.importorskip("pingverter")
    pyjsf = pytest.importorskip("pyjsf")
    import pingverter

    # Weight 0, so that the numbers in both files are the amplitudes.
    record = made_record(np.maximum(random_counts(11), 2.0**14 * (np.arange(40) == 3)))
    for name in ("a.jsf", "a.xtf"):
        write_record(tmp_path / name, [record])
    exact = np.sqrt(record.intensity.values)
    read = [each for each in pyjsf.jsf_read(tmp_path / "a.jsf") if each[0].message_type == 80]
    np.testing.assert_array_equal(
        [[data.data for head, _, data in read if head.channel_number == k] for k in (0, 1)], exact
    )
    _, pings = packets(tmp_path / "a.xtf")
    xtf = np.array([[ping.data[side][:: 2 * side - 1] for ping in pings] for side in (0, 1)])
    np.testing.assert_array_equal(xtf, exact)
    table = pingverter.jsf2pingmapper(str(tmp_path / "a.jsf"), str(tmp_path / "out")).header_dat
    content = (tmp_path / "a.jsf").read_bytes()
    for beam, side in ((2, 0), (3, 1)):
        rows = table[table.beam == beam]
        places = zip(rows["index"] + rows["son_offset"], rows["ping_cnt"])
        np.testing.assert_array_equal([np.frombuffer(content, "<i2", count, at) for at, count in places], exact[side])
        np.testing.assert_allclose(rows["pixM"], 0.05, rtol=1e-4)
        np.testing.assert_allclose(np.diff(rows["time_s"]), 0.25, atol=1e-6)
        np.testing.assert_allclose(rows["lat"], [ping.SensorYcoordinate for ping in pings], atol=1e-6)
        np.testing.assert_allclose(rows["pitch"], record.platform_pitch, atol=0.003)


def test_what_is_not_known_is_not_valid_and_a_made_up_place_is_said(tmp_path):
    record = made_record(np.zeros((3, 2, 70_000)))
    unknown = ["platform_altitude", "platform_heading", "platform_depth"]
    write_record(tmp_path / "a.jsf", [record.assign({name: record[name] * np.nan for name in unknown})])
    body = messages(tmp_path / "a.jsf")[1][3]
    assert field(body, "H", 30) == 1 << 0 | 1 << 2 | 1 << 5 | 1 << 10 | 1 << 14
    assert body[90:114].rstrip(b"\0") == b"place made up"
    assert samples(body).size == 70_000
    read = read_record(tmp_path / "a.jsf")
    assert read.sizes["range_sample"] == 70_000
    assert not read.intensity.any()
    assert all(np.isnan(read[name]).all() for name in unknown)
    metres = made_record(random_counts(8), origin_x=5e5, origin_y=6e6)
    write_record(tmp_path / "b.jsf", [metres])
    read = read_record(tmp_path / "b.jsf")
    assert "crs" not in read.attrs
    np.testing.assert_allclose((read.attrs["origin_x"], read.attrs["origin_y"]), (5e5 + 3.0, 6e6 - 7.0), atol=0.006)
    np.testing.assert_allclose(read.platform_x, metres.platform_x - 3.0, atol=0.011)


def test_a_ping_of_a_stream_takes_the_greatest_weight_that_fits_and_sentences_pass_through():
    time = datetime(2024, 5, 1, 12, 0, 0, 999_600)
    ping = LoggedPing(5, time, 7.5, 54.25, True, *[float("nan")] * 6, 50.0, 0.0667, 4e5)
    for scale in (1e-12, 1.0, 3e4, 1e9):
        sides = scale * np.random.default_rng(2).random((2, 50)).astype(np.float32)
        port, starboard = (body for *_, body in split_messages(encode_ping(ping, sides, subsystem=21)))
        weight = field(port, "h", 168)
        assert 2**14 <= sides.max() * 2.0**weight < 2**15
        np.testing.assert_allclose([samples(port), samples(starboard)], sides, atol=0.5 * 2.0**-weight)
        assert field(port, "i", 0) == 1_714_564_801  # rounded to the millisecond
        assert field(port, "H", 30) == 1 << 0 | 1 << 14
    clipped = samples(split_messages(encode_ping(ping, np.full((2, 3), 9e9, np.float32), 0))[0][3])
    np.testing.assert_array_equal(clipped, 32767.0)
    ((kind, subsystem, _, body),) = split_messages(encode_nmea(time, "$SDDBT,,f,5.0,M,,F*00\r\n"))
    assert (kind, subsystem, field(body, "i", 4), body[12:]) == (2002, 101, 0, b"$SDDBT,,f,5.0,M,,F*00\r\n")


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


def test_rounding_of_positions_does_not_lengthen_the_way(tmp_path):
    pings, step = 400, 0.1
    degrees = 7.5 + step * np.arange(pings) / 73_200.0, 48.8 + 0.7 * step * np.arange(pings) / 111_220.0
    places = np.rint(60e4 * np.array(degrees)).astype(int).T
    record = read_record(write_jsf(tmp_path / "a.jsf", [{**PING, "x": x, "y": y} for x, y in places]))
    way = np.hypot(np.diff(record.platform_x), np.diff(record.platform_y)).sum()
    np.testing.assert_allclose(way, np.hypot(1.0, 0.7) * step * (pings - 1), rtol=0.02)


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
