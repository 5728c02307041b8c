"""XTF written here: what this reader, pyxtf and the formulas of other readers find in it."""

import warnings

import numpy as np
import pyproj
import pytest
import pyxtf

from insonify.io.records import read_record, write_record
from insonify.scene import SceneError
from xtf_files import SPEED, made_record, packets, random_counts

BITS = {"8": 8, "16": 15, "32": 31}


def sides(pings: list[pyxtf.XTFPingHeader]) -> np.ndarray:
    """Samples of port and starboard from near to far, (2, pings, bins)."""
    return np.array([[ping.data[0][::-1] for ping in pings], [ping.data[1] for ping in pings]])


@pytest.mark.parametrize("bits", BITS)
def test_integers_round_amplitudes_to_their_unit_and_come_back_exactly(tmp_path, bits):
    record = made_record(np.random.default_rng(3).exponential(1e-3, (5, 2, 64)))
    write_record(tmp_path / "a.xtf", [record], bits=bits)
    header, pings = packets(tmp_path / "a.xtf")
    exact = np.sqrt(record.intensity.values)
    unit = header.ChanInfo[0].VoltScale / 256.0 ** header.ChanInfo[0].BytesPerSample
    assert 0.5 * 2 ** BITS[bits] <= exact.max() / unit < 2 ** BITS[bits]
    np.testing.assert_array_equal(sides(pings), np.rint(exact.astype(np.float64) / unit))
    read = np.sqrt(read_record(tmp_path / "a.xtf").intensity.values)
    np.testing.assert_allclose(read, exact, rtol=2e-7, atol=0.5 * unit)
    rounded = made_record(np.ldexp(random_counts(min(BITS[bits], 12)), -20))
    write_record(tmp_path / "b.xtf", [rounded], bits=bits)
    np.testing.assert_array_equal(read_record(tmp_path / "b.xtf").intensity, rounded.intensity)


def test_floats_keep_every_amplitude(tmp_path):
    record = made_record(np.random.default_rng(3).exponential(1e-6, (5, 2, 64)))
    write_record(tmp_path / "a.xtf", [record], bits="float")
    np.testing.assert_array_equal(sides(packets(tmp_path / "a.xtf")[1]), np.sqrt(record.intensity.values))
    np.testing.assert_allclose(read_record(tmp_path / "a.xtf").intensity, record.intensity, rtol=2e-7)


def test_navigation_comes_back_and_what_is_not_known_stays_unknown_in_silence_too(tmp_path):
    record = made_record(random_counts(8))
    write_record(tmp_path / "a.xtf", [record])
    read = read_record(tmp_path / "a.xtf")
    # North at the first fix, 3 m east of the map's meridian, is 2e-5° off its grid.
    for name in ("platform_x", "platform_y"):
        np.testing.assert_allclose(read[name], record[name] - record[name][0], atol=1e-5)
    for name in ("depth", "altitude", "pitch", "roll", "heading"):
        np.testing.assert_allclose(read[f"platform_{name}"], record[f"platform_{name}"], rtol=1e-6, atol=2e-5)
    np.testing.assert_allclose(read.ping_time, record.ping_time, atol=1e-9)
    for name in ("slant_range", "travel_time"):
        np.testing.assert_allclose(read[name], record[name], rtol=1e-6)
    assert read.attrs["frequency"] == 400e3
    unknown = ["platform_altitude", "platform_heading", "platform_depth"]
    record = made_record(np.zeros((3, 2, 8)))
    record = record.assign({name: record[name] * np.nan for name in unknown})
    write_record(tmp_path / "a.xtf", [record])
    read = read_record(tmp_path / "a.xtf")
    assert not read.intensity.any()
    assert all(np.isnan(read[name]).all() for name in unknown)


def test_fields_are_what_other_readers_need(tmp_path):
    pings, bins = 7, 40
    write_record(tmp_path / "a.xtf", [made_record(random_counts(15, pings, bins))])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        header, found = packets(tmp_path / "a.xtf")
    assert header.NavUnits == 3
    reach = bins * 0.05
    times = [ping.get_time() for ping in found]  # pyxtf sorts by it
    np.testing.assert_allclose(np.diff(times) / np.timedelta64(1, "s"), 0.25)
    assert pyxtf.concatenate_channel(found, header, 0).shape == (pings, bins)
    for ping in found:
        assert ping.NumBytesThisRecord % 64 == 0
        assert 0.0 not in (ping.SensorXcoordinate, ping.SensorYcoordinate)  # MBES-lib takes 0 for no position
        assert 0.0 < ping.SensorHeading <= 360.0  # 0 is taken for no compass
        assert ping.SensorSpeed > 0.0
        assert 1 <= ping.JulianDay <= 366
        np.testing.assert_allclose(2.0 * ping.SoundVelocity, ping.ComputedSoundVelocity)
        np.testing.assert_allclose(ping.ComputedSoundVelocity, SPEED, rtol=1e-6)
        for channel, samples in zip(ping.ping_chan_headers, ping.data):
            assert (channel.Weight, channel.Frequency) == (0, 400)  # auvlib shifts samples by the weight
            assert (samples.view(np.int16) >= 0).all()  # auvlib reads them as signed
            # SidescanTools computes the range from the first, other readers from TimeDuration.
            ranges = channel.SecondsPerPing * ping.SoundVelocity, channel.TimeDuration * SPEED / 2.0, channel.SlantRange
            np.testing.assert_allclose(ranges, reach, rtol=1e-6)
            assert 0.0 <= channel.GroundRange < channel.SlantRange
    for info in header.ChanInfo[:2]:
        assert min(info.TiltAngle, info.BeamWidth) > 0.0  # MBES-lib, auvlib
        assert (info.Frequency, info.CorrectionFlags) == (400.0, 1)


def test_places_on_a_map_become_degrees_and_true_headings(tmp_path):
    origin = (560_000.0, 6_500_000.0)
    record = made_record(random_counts(8), crs="EPSG:32631", origin_x=origin[0], origin_y=origin[1])
    write_record(tmp_path / "a.xtf", [record])
    _, pings = packets(tmp_path / "a.xtf")
    to_degrees = pyproj.Transformer.from_crs("EPSG:32631", "EPSG:4326", always_xy=True)
    lon, lat = to_degrees.transform(record.platform_x.values + origin[0], record.platform_y.values + origin[1])
    places = [(ping.SensorXcoordinate, ping.SensorYcoordinate) for ping in pings]
    np.testing.assert_allclose(places, np.transpose([lon, lat]), rtol=0.0, atol=1e-10)
    bend = pyproj.Proj("EPSG:32631").get_factors(lon[0], lat[0]).meridian_convergence
    expected = 90.0 - record.platform_heading + bend
    off = (np.array([ping.SensorHeading for ping in pings]) - expected + 180.0) % 360.0 - 180.0
    np.testing.assert_allclose(off, 0.0, atol=1e-4)
    # What is read keeps its place on Earth: a local map about the first fix.
    read = read_record(tmp_path / "a.xtf")
    back = pyproj.Transformer.from_crs(read.attrs["crs"], "EPSG:32631", always_xy=True)
    found = np.array(back.transform(read.platform_x.values, read.platform_y.values)) - np.array(origin)[:, None]
    np.testing.assert_allclose(found, [record.platform_x, record.platform_y], atol=1e-3)


def test_metres_without_a_map_stay_metres_and_a_map_that_is_not_known_is_one_sentence(tmp_path):
    record = made_record(random_counts(8), crs="EPSG:nowhere", origin_x=5e5, origin_y=6e6)
    with pytest.raises(SceneError, match="crs 'EPSG:nowhere' is not a coordinate reference system known to PROJ"):
        write_record(tmp_path / "a.xtf", [record])
    assert list(tmp_path.iterdir()) == []
    del record.attrs["crs"]
    write_record(tmp_path / "a.xtf", [record])
    header, pings = packets(tmp_path / "a.xtf")
    assert header.NavUnits == 0
    np.testing.assert_allclose([ping.SensorXcoordinate for ping in pings], 5e5 + record.platform_x)
    read = read_record(tmp_path / "a.xtf")
    assert "crs" not in read.attrs
    np.testing.assert_allclose(read.attrs["origin_x"], 5e5 + 3.0)
    np.testing.assert_allclose(read.attrs["origin_y"], 6e6 - 7.0)


def test_a_real_recording_is_copied_without_loss(real_recording, tmp_path):
    record = read_record(real_recording)
    write_record(tmp_path / "a.xtf", [record])
    (_, before), (_, after) = packets(real_recording), packets(tmp_path / "a.xtf")
    for one, other in zip(before, after, strict=True):
        np.testing.assert_array_equal(one.data, other.data)
    write_record(tmp_path / "a.jsf", [record])
    np.testing.assert_array_equal(read_record(tmp_path / "a.jsf").intensity, record.intensity)
    # The first ping has no fix. The second repeats its place in the copy, and repeated fixes are interpolated.
    record, read = (each.isel(ping_time=slice(2, None)) for each in (record, read_record(tmp_path / "a.xtf")))
    assert read.attrs["time_coverage_start"] == "2013-09-10T21:13:08"
    for name in ("x", "y", "depth", "altitude", "heading", "pitch", "roll"):
        np.testing.assert_allclose(read[f"platform_{name}"], record[f"platform_{name}"], rtol=1e-5, atol=1e-4)
