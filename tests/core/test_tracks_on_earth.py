"""Tracks from recordings, GPX and tables of longitude and latitude, placed on the map of the scene."""

import numpy as np
import pyproj
import pytest

from insonify.cli import main
from insonify.io.navigation import read_navigation
from insonify.io.records import read_record, write_record
from insonify.scene import SceneError, build, edit, load_scene
from insonify.simulation import simulate

GPX = """<?xml version="1.0"?>
<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>{points}</trkseg></trk></gpx>
"""
EASTING, NORTHING = 560_000.0, 6_500_000.0


def fixes():
    """A line at 30° on the map EPSG:32631, 1 m a second, as longitude and latitude."""
    along = np.arange(6.0)
    x, y = along * np.cos(np.pi / 6), along * np.sin(np.pi / 6)
    transform = pyproj.Transformer.from_crs("EPSG:32631", "EPSG:4326", always_xy=True)
    return x, y, *transform.transform(EASTING + x, NORTHING + y)


def write_gpx(path):
    _, _, lon, lat = fixes()
    point = '<trkpt lat="{}" lon="{}"><ele>3</ele><time>2024-05-01T12:00:{:02d}Z</time></trkpt>'
    path.write_text(GPX.format(points="".join(map(point.format, lat, lon, range(6)))))
    return path


def write_table(path, clock="seconds", names="time,lon,lat"):
    _, _, lon, lat = fixes()
    times = [f"{5 + k}" if clock == "seconds" else f"2024-05-01T12:00:{k:02d}" for k in range(6)]
    rows = [f"{time},{a!r},{b!r}" for time, a, b in zip(times, lon.tolist(), lat.tolist())]
    path.write_text("\n".join([names, *rows]))
    return path


def rows(head, row, count=9):
    return "\n".join([head, *(row(k) for k in range(count))])


# Tables of a tow northwards at 2 m/s, a row a second.
DIALECTS = {
    "semicolons and decimal commas": rows("Time (s);x;y", lambda k: f"{k},0;3,5;{2 * k},25"),
    "spaces": rows("time x y", lambda k: f"{k} 3.5 {2 * k}"),
    "units": rows("Time (ms),X (ft),Y (ft)", lambda k: f"{1000 * k},3,{2 * k / 0.3048}"),
    "preamble and map names": rows("Survey\n\nTime,Easting (m),Northing (m)", lambda k: f"{k},7e5,{6e6 + 2 * k:.0f}"),
    "date and clock over midnight": rows("Date;Time;X;Y", lambda k: f"{3 + (k > 4)}.6.2024;"
                                         f"{'00:00' if k > 4 else '23:59'}:{(55 + k) % 60:02d},0;1;{2 * k}"),
    "clock of twelve hours": rows("UTC Time,x,y", lambda k: f"{11 + (k > 3)}:{'00' if k > 3 else '59'}:{(56 + k) % 60} "
                                  f"{'PM' if k <= 3 else 'AM'},1,{2 * k}"),
    "newest first": rows("time,x,y", lambda k: f"{8 - k},1,{2 * (8 - k)}"),
    "a clock of four seconds": rows("time,x,y", lambda k: f"{k // 4 * 4},1,{2 * k}", 12),
    "every row twice": rows("time,x,y", lambda k: f"{k // 2},1,{k // 2 * 2}", 18),
    "degrees and minutes": rows("Timestamp,Latitude,Longitude", lambda k: f"2024-05-06T10:00:0{k}Z,"
                                f"54°{30 + 2 * k / 1855.374:.7f}'N,010°03.10'W"),
    "zones": rows("time,lat,lon", lambda k: f"2024-05-06 1{1 + k % 2}:00:0{k}+0{1 + k % 2}:00,"
                  f"{54 + 2 * k / 111306:.8f},10"),
    "a compass by its unit": rows("time,x,y,Heading (deg T)", lambda k: f"{k},1,{2 * k},0"),
    "no fix at first": rows("time,lat,lon", lambda k: f"{k},{k and 54 + 2 * k / 111306:.8f},{k and 10}", 10),
}  # fmt: skip


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_table_is_a_track_in_any_dialect(tmp_path, dialect):
    for encoding in ("utf-8-sig", "utf-16"):
        (tmp_path / "a.csv").write_bytes(DIALECTS[dialect].encode(encoding))
        tow = read_navigation(str(tmp_path / "a.csv"))
        speeds = np.hypot(np.diff(tow.columns["x"]), np.diff(tow.columns["y"])) / np.diff(tow.time)
        assert tow.time.size >= 9
        np.testing.assert_allclose(np.diff(tow.time), 1.0, atol=1e-6)
        np.testing.assert_allclose(speeds, 2.0, rtol=2e-3)
        assert "heading" not in tow.columns or (tow.columns["heading"] == 90.0).all()
        reported = {
            "newest first": "reversed",
            "a clock of four seconds": "spread over the tick: 9",
            "no fix at first": "1 of 10",
        }
        assert reported.get(dialect, "") in "".join(tow.remarks)
        assert bool(tow.remarks) == (dialect in reported)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (rows("time,x,y", lambda k: f"{k},3,4"), "it stands still: its positions lie within 0 m in 8 s, and its"),
        (rows("time,lat,lon", lambda k: f"{k},54,{10 + 1e-6 * (k % 7)}", 99), "stands still: its positions lie with"),
        (rows("time,x,y", lambda k: f"{45000 + k / 86400:.8f},{k},4"), "are its times not in seconds"),
        (rows("time,x,y", lambda k: f"{k},{9000 if k == 5 else k},4"), "it goes 8996 m in 1 s from row 5 to row 6"),
        (rows("time,x,y,heading", lambda k: f"{k},0,{k},0"), "only if it counts clockwise from north"),
    ],
)  # fmt: skip
def test_a_doubtful_track_is_used_with_a_warning(tmp_path, capsys, content, words):
    path = tmp_path / "a.csv"
    path.write_text(content)
    words_of_command = ["--set", f'track.motion={{ kind = "recorded", path = "{path}" }}', "--set", "track.pings=4"]
    assert main(["render", "default", "-o", str(tmp_path / "a.npz"), "--set", "sonar.bins=20", *words_of_command]) == 0
    assert capsys.readouterr().err.count(words) == 1
    assert main(["info", str(path)]) == 0
    assert words in capsys.readouterr().out


def towed(path, **world):
    track = {"altitude": 5.0, "pings": 6, "motion": {"kind": "recorded", "path": str(path)}}
    sonar = {"bins": 40, "range": 20.0, "ping_rate": 1.0}
    return build({"world": world, "seabed": {"depth": 30.0}, "sonar": sonar, "track": track})


PLACED = {"crs": "EPSG:32631", "origin": [EASTING - 3.0, NORTHING + 4.0]}
WRITERS = {
    "a.gpx": write_gpx,
    "a.csv": write_table,
    "b.csv": lambda path: write_table(path, clock="iso", names="time,longitude,latitude"),
}


@pytest.mark.parametrize("name", WRITERS)
def test_positions_on_earth_become_those_of_the_scene(tmp_path, name):
    path = WRITERS[name](tmp_path / name)
    x, y, _, _ = fixes()
    record = simulate(towed(path, **PLACED))
    np.testing.assert_allclose(record.platform_x, x + 3.0, atol=1e-5)
    np.testing.assert_allclose(record.platform_y, y - 4.0, atol=1e-5)
    np.testing.assert_allclose(record.platform_heading, 30.0, atol=0.01)  # the course on the map, not from true north
    away = simulate(towed(path))
    np.testing.assert_allclose(away.platform_x[0], 0.0, atol=1e-9)
    np.testing.assert_allclose(np.hypot(away.platform_x, away.platform_y), np.arange(6.0), rtol=1e-3, atol=1e-6)


def test_a_recording_is_towed_again(tmp_path):
    """The track of a simulated recording, from XTF, is the track of the simulation."""
    changes = {
        "world.crs": "EPSG:32631", "world.origin": [EASTING, NORTHING], "track.pings": 8, "sonar.bins": 60,
        "track.heading": 70.0, "track.start": [5.0, -2.0],
    }  # fmt: skip
    scene = edit(load_scene("rough-tow"), changes)
    first = simulate(scene)
    write_record(tmp_path / "a.xtf", [first])
    motion = {"kind": "recorded", "path": str(tmp_path / "a.xtf")}
    again = simulate(edit(scene, {"track.motion": motion}))
    for name, within in (("x", 1e-3), ("y", 1e-3), ("heading", 1e-2), ("pitch", 1e-2), ("roll", 1e-2), ("depth", 1e-3)):
        # XTF resolves 10 ms, in which the sonar goes a centimetre or two.
        np.testing.assert_allclose(again[f"platform_{name}"], first[f"platform_{name}"], atol=within + 0.02)


def test_a_real_recording_is_a_track(real_recording, tmp_path):
    tow = read_navigation(str(real_recording))
    record = read_record(real_recording)
    assert tow.place is not None
    np.testing.assert_allclose(tow.columns["x"], record.platform_x, atol=1e-3)
    assert (np.diff(tow.time) > 0.0).all()
    words = ["--set", f'track.motion={{ kind = "recorded", path = "{real_recording}" }}', "--set", "track.pings=12"]
    assert main(["render", "default", "-o", str(tmp_path / "a.nc"), "--set", "sonar.bins=50", *words]) == 0
    simulated, times = read_record(tmp_path / "a.nc"), np.arange(12) / load_scene("default").sonar.ping_rate
    np.testing.assert_allclose(simulated.platform_x, np.interp(times, tow.time, tow.columns["x"]), atol=1e-3)


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("a.gpx", "<gpx><trk/></gpx>", "holds 0 rows; give at least two"),
        ("a.gpx", "<gpx", "cannot be read"),
        ("a.gpx", '<!DOCTYPE a [<!ENTITY b "c">]><gpx/>', "declares a document type; export the track again"),
        ("a.gpx", '<gpx><trkpt lat="1" lon="2"/></gpx>', "has points without a time; export a recorded track"),
        ("a.gpx", '<gpx><trkpt lat="91" lon="2"><time>2024-05-01T12:00:00Z</time></trkpt>'
         '<trkpt lat="1" lon="2"><time>2024-05-01T12:00:01Z</time></trkpt></gpx>', "has latitude 91 ° in row 1"),
        ("a.gpx", '<gpx><trkpt lat="1" lon="2"><time>noon</time></trkpt></gpx>', "cannot be read"),
        ("a.csv", "time,lon\n0,1\n1,1", "has only one of longitude and latitude; give both or neither"),
        ("a.csv", "time,lon,lat\nnoon,1,1\n1,1,1", "cannot be read"),
        ("a.csv", "time,lon,lat\n0,1,5,2,5\n1,1,6,2,6", "has 5 numbers a row below 3 names: commas within and between"),
        ("a.csv", "time,lon,lat\n0,1,2\nend of file", "cannot be read .row 2 has the time 'end of file'"),
        ("a.csv", "time,x (kn),y\n0,1,2\n1,2,3", "has x in kn; give it in m"),
        ("a.csv", "time,lon,lat\n0,1,5412.3\n1,1,5412.4", "has latitude 5412.4 ° in row 2"),
        ("a.nmea", "$GPGGA", "is in the format NMEA 0183, which is not read here; convert it to .gpx"),
    ],
)  # fmt: skip
def test_a_broken_track_is_one_sentence(tmp_path, name, content, expected):
    path = tmp_path / name
    path.write_text(content)
    with pytest.raises(SceneError, match=rf"^[^\n]*track\.motion\.path[^\n]*{expected}[^\n]*$"):
        read_navigation(str(path))
    # Latitude and longitude do not displace x and y.
    (tmp_path / "b.csv").write_text("time,x,y,lon,lat\n0,1,2,3,4\n1,2,3,4,5\n")
    tow = read_navigation(str(tmp_path / "b.csv"))
    assert tow.place is None
    np.testing.assert_allclose(tow.columns["x"], [1.0, 2.0])
