"""Sound-speed casts in the layouts of instruments and programs: what is read, cleaned and refused."""

import re

import gsw
import numpy as np
import pytest

from insonify.acoustics.water import make_sound_speed_field
from insonify.cli import main
from insonify.display.ray_diagram.tracing import trace_ray_diagram
from insonify.errors import FileWarning
from insonify.io.sound_speed_casts import read_cast
from insonify.scene import SceneError, edit, load_scene
from insonify.scene.water.layered import CastWater
from insonify.scene.water.sound_speed import EQUATIONS


def text(path, content):
    path.write_text(content)
    return str(path)


def seabird(path, names, rows):
    head = ["* Sea-Bird SBE19plus  Data File:", f"# nquan = {len(names)}"]
    head += [f"# name {number} = {name}" for number, name in enumerate(names)]
    table = ["".join(f"{cell:11.6g}" for cell in row) for row in rows]
    return text(path, "\n".join([*head, "# bad_flag = -9.990e-29", "*END*", *table, ""]))


@pytest.fixture(scope="session")
def casts(real_data):
    return real_data / "casts"


@pytest.mark.parametrize(
    ("name", "depths", "speeds", "rows"),
    [
        ("20120321_224205.asvp", [0.0, 6.87, 10.0], [1531.4, 1531.4, 1675.82], 35),
        ("7-30cast2.csv", [0.9], [1504.3, 1497.4], None),  # a table without names shows what it holds
    ],
)
def test_a_profile_is_taken_as_it_is(casts, name, depths, speeds, rows):
    cast = read_cast(str(casts / name))
    np.testing.assert_array_equal(cast.depth[: len(depths)], depths)
    np.testing.assert_array_equal([*cast.sound_speed[: len(speeds) - 1], cast.sound_speed[-1]], speeds)
    assert rows is None or cast.depth.size == rows
    assert cast.depth[-1] == 24.4 or rows
    assert cast.temperature is None


def test_a_profile_with_noise_at_the_surface_becomes_steps(casts):
    cast = read_cast(str(casts / "assvt13246_d26.svp"))
    assert (np.diff(cast.depth) > 0.25).all()
    assert cast.depth.size == 18
    noise = [1524.07, 1523.95, 1524.19, 1524.03, 1524.10, 1524.03, 1524.12, 1523.98, 1523.85]
    assert cast.sound_speed[0] == pytest.approx(np.mean(noise))


def test_a_seabird_cast_leaves_out_soak_and_way_up_and_has_salinity_from_conductivity(casts):
    cast = read_cast(str(casts / "Hotin.cnv"))
    # The pump runs from 1.25 m on; before, the salinity rises from -3.9 to 33.6.
    assert cast.salinity.min() > 34.2
    assert cast.depth[0] <= 1.5
    assert cast.depth[-1] == pytest.approx(14.0)
    speed = make_sound_speed_field(CastWater(path=str(casts / "Hotin.cnv"))).speed
    assert 1478.0 < speed.min() < speed.max() < 1480.0
    cast = read_cast(str(casts / "PIRA001.cnv"))
    np.testing.assert_allclose(cast.salinity, 36.32, atol=0.01)  # the western tropical Atlantic
    np.testing.assert_allclose(cast.temperature, 27.05, atol=0.01)
    speed = make_sound_speed_field(CastWater(path=str(casts / "PIRA001.cnv"))).speed
    np.testing.assert_allclose(speed, 1540.55, atol=0.1)


@pytest.mark.parametrize("interpolation", ["linear", "pchip"])
def test_few_points_keep_to_a_real_cast(casts, interpolation):
    for name in ("20120321_224205.asvp", "7-30cast2.csv", "Hotin.cnv", "PIRA001.cnv", "assvt13246_d26.svp"):
        path = str(casts / name)
        cast, layers = read_cast(path), make_sound_speed_field(CastWater(path=path, interpolation=interpolation))
        speed = cast.sound_speed
        if speed is None:
            speed = EQUATIONS["teos10"](cast.temperature, cast.salinity, cast.depth)
        assert np.abs(layers.speed_at(0.0, 0.0, cast.depth) - speed).max() <= 0.0201
        assert (np.diff(layers.depth) > 0.0).all()


def test_soak_raise_and_way_up_are_told_from_the_descent_and_flagged_and_missing_scans_left_out(tmp_path):
    # Down to 8 m, a minute's wait, up to 1 m, down to 30 m, up; the water of the first way is not the water's own.
    depth = np.concatenate([np.arange(0.2, 8, 0.2), np.full(240, 8.0), np.arange(8, 1, -0.2), np.arange(1, 30, 0.2)])
    depth = np.concatenate([depth, depth[:-20:-1], np.arange(26, 0, -0.2)])
    rows = len(depth)
    salinity = np.where(np.arange(rows) < 290, 20.0, 35.0)
    salinity[int(depth.argmax()) + 1 :] = 30.0
    names = ["timeS: Time", "depSM: Depth [salt water, m]", "t090C: Temperature", "sal00: Salinity", "flag: flag"]
    table = np.column_stack([0.25 * np.arange(rows), depth, np.full(rows, 12.0), salinity, np.zeros(rows)])
    cast = read_cast(seabird(tmp_path / "cast.cnv", names, table))
    np.testing.assert_array_equal(cast.salinity, 35.0)
    assert cast.depth[0] < 1.5
    assert cast.depth[-1] > 29.0
    names = ["prDM: Pressure, Digiquartz [db]", "t068C: Temperature", "sal00: Salinity", "svCM: Velocity", "flag: flag"]
    bad = -9.99e-29
    rows = [(d, 10.0024, 35.0, 1500.0 + d, 0.0) for d in range(1, 21)]
    rows[4] = (5, 10.0, 35.0, 9999.0, bad)
    rows[9] = (10, 10.0, 35.0, bad, 0.0)
    rows[14] = (-9.99e-29, 10.0, 35.0, 9999.0, 0.0)
    cast = read_cast(seabird(tmp_path / "flagged.cnv", names, rows))
    assert cast.depth.size == 17
    assert cast.sound_speed.max() == 1520.0
    np.testing.assert_allclose(cast.depth[0], -gsw.z_from_p(1.0, 45.0))
    np.testing.assert_allclose(cast.temperature, 10.0, atol=1e-6)


ROWS = ((0, 1510, 15), (5, 1505, 12), (9, 1500, 10))
CARIS = "[SVP_VERSION_2]\ncast.svp\nSection 2013-246 17:44:19 40:29:11.40 -74:07:46.80\n0 1510.0\n5 1505\n9.0 1500\n"


@pytest.mark.parametrize(
    ("name", "head", "mark"),
    [
        ("cast.csv", "depth,sound_speed,temperature", ","),
        ("cast.csv", "Depth (m);Sound Velocity (m/s);Temp", ";"),
        ("cast.csv", '"Depth [m]","Sound Speed","T"', ","),
        ("cast.csv", "DEPTH\tSV\tt", "\t"),
        ("cast.csv", "depth speed temperature", " "),
        ("cast.svp", CARIS, None),
    ],
)
def test_columns_go_by_their_names(tmp_path, name, head, mark):
    rows = [] if mark is None else ["# a note", *(mark.join(map(str, row)) for row in ROWS), ""]
    cast = read_cast(text(tmp_path / name, "\n".join([*rows[:1], head, *rows[1:]])))
    np.testing.assert_array_equal(cast.depth, [0.0, 5.0, 9.0])
    np.testing.assert_array_equal(cast.sound_speed, [1510.0, 1505.0, 1500.0])


def test_a_descent_of_centimetres_with_times_and_unsorted_and_repeated_depths_become_one_profile(tmp_path):
    rows = "".join(f"{k},{1.3 + 0.01 * k:.2f},1500\n" for k in range(31))
    cast = read_cast(text(tmp_path / "short.csv", "time,depth,sound_speed\n" + rows))
    assert cast.depth.size == 2
    rng = np.random.default_rng(3)
    depth = rng.uniform(0.0, 20.0, 400).round(1)
    lines = [f"{d},{1500 - 2 * d}" for d in depth]
    cast = read_cast(text(tmp_path / "cast.csv", "\n".join(["depth,speed", *lines])))
    assert (np.diff(cast.depth) > 0.0).all()
    np.testing.assert_allclose(cast.sound_speed, 1500.0 - 2.0 * cast.depth)  # means keep a gradient


def test_a_cast_is_read_anew_beside_its_scene_and_an_equation_takes_precedence_and_needs_its_columns(tmp_path):
    scene = text(tmp_path / "scene.toml", 'water = { kind = "cast", path = "cast.csv" }\n')
    for speed in (1500.0, 1490.0):
        text(tmp_path / "cast.csv", f"depth,speed\n0,{speed}\n20,1501.5\n")
        assert make_sound_speed_field(load_scene(scene).water).speed.tolist() == [[speed, 1501.5]]
    path = text(tmp_path / "cast.csv", "depth,sound_speed,temperature,salinity\n0,1500,10,35\n20,1501,10,35\n")
    np.testing.assert_array_equal(make_sound_speed_field(CastWater(path=path)).speed, [[1500.0, 1501.0]])
    by_paper = make_sound_speed_field(CastWater(path=path, equation="paper")).speed
    np.testing.assert_allclose(by_paper, [[1489.8, 1489.8 + 20.0 / 61.0]])
    path = text(tmp_path / "speed.csv", "depth,speed\n0,1500\n20,1501\n")
    with pytest.raises(SceneError, match=r"water.equation: 'paper' needs temperature and salinity"):
        make_sound_speed_field(CastWater(path=path, equation="paper"))


def logged(path, depth, speed=None, time=None):
    """Write a table of depths, speeds (1500 m/s if left out) and times (1 m/s of descent if left out)."""
    speed = np.full(len(depth), 1500.0) if speed is None else speed
    rows = zip(depth if time is None else time, depth, speed)
    return text(path, "time,depth,sound_speed\n" + "".join(f"{t:.3f},{d:.4f},{c:.3f}\n" for t, d, c in rows))


@pytest.mark.parametrize("step", [0.2, 0.6, 1.1, 1.7, 2.5, 4.0, 7.0])
def test_a_steady_descent_keeps_its_top_and_a_wait_is_cut_whatever_the_distance_of_rows(tmp_path, step):
    depth = np.arange(0.8, 75.0, step)
    cast = read_cast(logged(tmp_path / "steady.csv", depth, 1540.0 - 0.5 * depth))
    assert cast.depth[0] < 0.8 + 0.5
    assert cast.remarks == ()
    np.testing.assert_allclose(cast.sound_speed, 1540.0 - 0.5 * cast.depth, atol=1e-3)
    waited = depth + 90.0 * (depth > 9.1)
    cast = read_cast(logged(tmp_path / "soak.csv", depth, time=waited))
    assert 8.8 < cast.depth[0] < 9.1 + step + 0.5
    (remark,) = cast.remarks
    assert re.search(r"\d before the descent and up to the end of a wait of 9\d(\.\d)? s at [6-9](\.\d+)? m", remark)
    # Half as fast near the surface, where the rope is let out by hand, and the clock in whole seconds.
    slow = np.floor(np.where(depth < 10.0, 2.0 * depth, depth + 10.0))
    assert read_cast(logged(tmp_path / "slow.csv", depth, time=slow)).remarks == ()


FINE = np.arange(0.0, 40.0, 0.25)


@pytest.mark.parametrize(
    ("rows", "values", "words"),
    [
        ([60], [0.0], "1 with an impossible sound speed (0 m/s at 15 m)"),
        ([60, 61, 62, 90], [2800.0] * 4, "4 with an impossible sound speed (2800 m/s at 15 m)"),
        ([81], [1621.0], "1 with a spike of sound speed (1621 m/s at 20.25 m)"),
        ([81, 82], [1475.0, 1470.0], "2 with a spike of sound speed (1475 m/s at 20.25 m)"),
        ([0], [1580.0], "1 with a spike of sound speed (1580 m/s at 0 m)"),
        ([33], [np.nan], "1 without a number or flagged as bad"),
    ],
)
def test_values_that_water_cannot_have_take_no_part(tmp_path, rows, values, words):
    speed = 1510.0 - 0.3 * FINE + 0.02 * np.cos(9.0 * FINE)
    dirty = speed.copy()
    dirty[rows] = values
    cast = read_cast(logged(tmp_path / "a.csv", FINE, dirty))
    np.testing.assert_allclose(cast.sound_speed, 1510.0 - 0.3 * cast.depth, atol=0.03)
    assert f"{len(rows)} of {FINE.size} rows are left out: {words}; the cast begins at" in cast.remarks[0]
    depth = FINE.copy()
    depth[50] = 900.0
    cast = read_cast(logged(tmp_path / "b.csv", depth, speed, time=FINE))
    assert cast.depth[-1] < 40.0
    assert "1 with a spike of depth (900 m)" in cast.remarks[0]


@pytest.mark.parametrize(
    "points",
    [
        [(0, 1521), (7, 1520), (15, 1503), (70, 1501)],
        [(0, 1476), (10, 1476), (14, 1441), (26, 1421), (38, 1440), (60, 1447), (80, 1451)],  # cold intermediate water
        [(0, 1532), (150, 1511), (900, 1483), (2100, 1493), (3200, 1510), (5100, 1549)],  # a deep channel
        [(0, 1442), (2, 1442), (2.6, 1481), (12, 1482)],  # fresh above salt water
    ],
)
def test_layers_are_no_spikes(tmp_path, points):
    places, speeds = np.array(points, dtype=float).T
    for step in (None, 0.3):
        depth = places if step is None else np.arange(0.0, places[-1], step)
        cast = read_cast(logged(tmp_path / "a.csv", depth, np.interp(depth, places, speeds)))
        assert cast.remarks == ()


def test_a_dead_sensor_takes_no_part_and_depths_may_count_upwards(tmp_path):
    rows = [f"{-z},0.0,{9 + 0.1 * z},34.5" for z in range(25)]
    cast = read_cast(text(tmp_path / "a.csv", "\n".join(["depth,sound_speed,temperature,salinity", *rows])))
    assert cast.sound_speed is None
    np.testing.assert_allclose(cast.temperature, 9.0 + 0.1 * cast.depth)
    assert cast.remarks == (
        "its depths are negative and count downwards",
        "sound speed is left out: 0 of 25 rows have possible values",
    )


def comma(value):
    return f"{value:.3f}".replace(".", ",")


# The lines before the rows, and a row of depth and sound speed. Real depths are 2, 3 … 13 m, speeds 1490 m/s + depth.
DIALECTS = {
    "semicolons and decimal commas": ("Depth (m);Sound Speed (m/s)", lambda d, c: f"{comma(d)};{comma(c)}"),
    "tabs and decimal commas": ("Sound Velocity [m/s]\tDEPTH [M]", lambda d, c: f"{comma(c)}\t{comma(d)}"),
    "decimal commas in quotes": ("Depth,SV", lambda d, c: f'"{comma(d)}","{comma(c)}"'),
    "decimal commas alone": ("", lambda d, c: f"{comma(d)} {comma(c)}"),
    "feet": ("Depth (ft),Sound Speed (ft/s)", lambda d, c: f"{d / 0.3048},{c / 0.3048}"),
    "fathoms": ("depth_fathoms;sound_speed_m_s", lambda d, c: f"{d / 1.8288};{c}"),
    "centimetres": ("Depth in cm,Speed", lambda d, c: f"{100 * d},{c}"),
    "a line of units": ("Depth,Sound speed\nfeet,m/s", lambda d, c: f"{d / 0.3048},{c}"),
    "pressure": ("Pressure (dbar),SV (m/s)", lambda d, c: f"{gsw.p_from_z(-d, 45.0)},{c}"),
    "pressure in psi": ("Press [psi],SV (m/s)", lambda d, c: f"{gsw.p_from_z(-d, 45.0) / 0.6894757},{c}"),
    "pressure named depth": ("Depth (dBar),SV (m/s)", lambda d, c: f"{gsw.p_from_z(-d, 45.0)},{c}"),
    "pressure in metres": ("SV\tPRESSURE;M", lambda d, c: f"{c}\t{d}"),
    "a preamble": (
        "[cast header]\ndepthinmeters=no\ndate=08/16/17\ntime=17:47:28\nslot=p-t.x p.x sn 3, t.x sn 4\n\n[data]\n"
        "Date (mm/dd/yy),Time,SV (m/s),Depth (m),SV-C.Xchange (No Sensor),Battery (V),",
        lambda d, c: f"08/16/17,17:48:{d:05.2f},{c},{d},0.000,007.30,",
    ),
    "prose before names": ("# Sound speed by depth in the bay\n#depth sound speed", lambda d, c: f"{d} {c}"),
    "spaces in names": ("Depth (m)  Sound Velocity (m/s)", lambda d, c: f"  {d:.2f}   {c:.2f}"),
    "a date with points": ("DateTime;Depth;SV", lambda d, c: f"03.04.2021 10:00:{int(d):02d};{comma(d)};{comma(c)}"),
    "grouped digits": ("Depth;Speed", lambda d, c: f"{comma(d)};1.{comma(c)[1:]}"),
}  # fmt: skip


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_table_is_read_in_any_dialect(tmp_path, dialect, encoding):
    head, row = DIALECTS[dialect]
    lines = [*head.splitlines(), *(row(d, 1490.0 + d) for d in np.arange(2.0, 14.0))]
    (tmp_path / "a.csv").write_bytes("\r\n".join(lines).encode(encoding))
    cast = read_cast(str(tmp_path / "a.csv"))
    np.testing.assert_allclose(cast.depth, np.arange(2.0, 14.0), atol=1e-3)
    np.testing.assert_allclose(cast.sound_speed, 1490.0 + cast.depth, atol=1e-2)


def test_temperature_may_be_in_other_units(tmp_path):
    for unit, of in (("°C", lambda t: t), ("deg F", lambda t: 32.0 + 1.8 * t), ("K", lambda t: t + 273.15)):
        rows = [f"{z};{comma(of(8.0 + z))};35" for z in range(9)]
        content = "\n".join([f"Depth (m);Temp [{unit}];Salinity [PSU]", *rows])
        for encoding in ("utf-8", "latin-1"):
            (tmp_path / "a.csv").write_bytes(content.encode(encoding))
            np.testing.assert_allclose(read_cast(str(tmp_path / "a.csv")).temperature, 8.0 + np.arange(9), atol=1e-3)
    names = [
        "timeS: Time",
        "prDE: Pressure [psi]",
        "t090F: Temperature [deg F]",
        "sal00: Salinity",
        "svCF: Speed [ft/s]",
    ]
    rows = [(d, gsw.p_from_z(-d, 45.0) / 0.6894757, 50.0, 35.0, 1500.0 / 0.3048) for d in range(1, 12)]
    cast = read_cast(seabird(tmp_path / "a.cnv", names, rows))
    np.testing.assert_allclose(cast.depth, np.arange(1, 12), atol=1e-3)
    np.testing.assert_allclose(cast.temperature, 10.0, atol=1e-5)
    np.testing.assert_allclose(cast.sound_speed, 1500.0, atol=1e-2)


def test_what_is_left_out_is_reported_once_where_a_cast_is_used_and_by_info(tmp_path, capsys):
    depth = np.concatenate([FINE, FINE[::-1]])
    path = logged(
        tmp_path / "cast.csv", depth, np.where(depth == 30.0, 0.0, 1500.0 - 0.2 * depth), np.arange(depth.size)
    )
    sentence = "161 of 320 rows are left out: 2 with an impossible sound speed (0 m/s at 30 m); 159 of the way up"
    with pytest.warns(FileWarning, match=re.escape(f"{path}: {sentence}")) as warned:
        diagrams = [trace_ray_diagram(edit(load_scene("default"), {"water": {"kind": "cast", "path": path}}))]
    assert len(warned) == 1
    assert sentence in diagrams[0].limits[0]
    assert main(["info", path]) == 0
    shown = capsys.readouterr()
    assert shown.out.startswith(f"{path}: measured cast, 80 depths from 0.125 to 39.625 m, sound speed 149")
    assert sentence in shown.out
    assert shown.err == ""


@pytest.mark.parametrize(
    ("name", "top", "bottom", "speeds", "words"),
    [
        ("midas-svx2-file1.000", 1.992, 2058.506, (1492.0, 1541.5), "9 with an impossible sound speed (0 m/s"),
        ("midas-svx2-file8-6000.000", 1.98, 3656.433, (1483.3, 1543.9), "a wait of"),
        ("midas-svx2-file8.000", 0.86, 43.26, (1414.5, 1420.4), "90 with an impossible sound speed (0 m/s"),
        ("aml-down-cast.csv", 0.24, 8.21, (1539.9, 1545.5), "9 before the descent"),
        ("aml-seacast-440.csv", 1.7, 1152.42, (1486.6, 1537.0), "1998 of the way up"),
    ],
)
def test_a_real_log_keeps_its_top_and_its_values(casts, name, top, bottom, speeds, words):
    cast = read_cast(str(casts / name))
    np.testing.assert_allclose(cast.depth[[0, -1]], [top, bottom], atol=0.01)
    assert speeds[0] < cast.sound_speed.min() < cast.sound_speed.max() < speeds[1]
    assert words in cast.remarks[0]


WRONG = [
    ("nowhere.cnv", None, ["does not exist"]),
    ("cast.xls", "", ["not a format known here", ".cnv"]),
    ("cast.csv", "", ["holds no table"]),
    ("cast.csv", "depth,speed\n", ["holds no table"]),
    ("cast.csv", "depth,colour\n1,2\n2,3\n", ["neither the speed of sound nor", "sound_speed"]),
    ("cast.csv", "place,speed\n1,1500\n2,1501\n", ["has no depth"]),
    ("cast.csv", "1,2\n2,3\n", ["no columns that look like sound speed", "names of the columns"]),
    ("cast.csv", "1,1500,1501\n2,1500,1501\n", ["2 columns that look like sound speed"]),
    ("cast.csv", "depth,speed\n1,1500\n", ["1 usable depths of 1 rows"]),
    ("cast.csv", "depth,speed\n1,1500\n1.1,1500\n1.2,nan\n", ["1 usable depths of 3 rows"]),
    ("cast.csv", "depth,speed\n1,1500\n20,15\n", ["15 m/s at 20 m", "correct"]),
    ("cast.svp", "all headings\n", ["no rows of depth and sound speed"]),
    ("cast.svp", CARIS + CARIS, ["holds 2 casts; keep one of its sections"]),
    ("cast.cnv", "depth,speed\n1,1500\n", ["lacks the column names"]),
    ("cast.cnv", "# name 0 = depSM: Depth\n# name 1 = svCM: Velocity\n*END*\n  1 x\n", ["no numbers in line 4"]),
    ("cast.cnv", "# name 0 = depSM: Depth\n# name 1 = svCM: Velocity\n*END*\n  1 2 3\n", ["3 columns in line 4"]),
    ("a.vp2", "[HEADER]\nno columns\n", ["has no line that names the columns of depth or pressure, and of sound sp"]),
    ("a.000", "Date / Time\tSOUND VELOCITY;DBAR\tPRESSURE;\nx\ty\tz\n", ["has no row of numbers under the names"]),
    ("a.rsk", "SQLite", ["is in the format RBR Ruskin, which is not read here; export it as CSV from Ruskin"]),
    ("a.m1", "MVP", ["is in the format Moving Vessel Profiler, which is not read here; convert it to .asvp or .csv"]),
    ("a.vpd", "", ["is in the format Valeport DataLog"]),
    ("a.vel", "FTP NEW 3\n", ["holds no rows of depth and sound speed"]),
    (
        "a.vel",
        "FTP NEW 3\n3 4921\n9 4920\n",
        ["has sound speeds about 4920, which are in ft/s, beside depths of an unkno"],
    ),
    (
        "a.csv",
        "depth,speed\n3,4921\n9,4920\n",
        ["2 with an impossible sound speed (4921 m/s at 3 m)", "name the units"],
    ),
    ("a.csv", "Depth (m),Speed (kn)\n3,1500\n9,1500\n", ["has sound_speed in kn; give it in m/s"]),
    ("a.csv", "Depth (m),SV (m/s)\n1,5,1500,2\n2,5,1500,1\n", ["has 4 numbers a row below 2 names", "semicolons"]),
]


@pytest.mark.parametrize(("name", "content", "words"), WRONG)
def test_what_is_no_cast_is_refused_in_one_sentence(tmp_path, name, content, words):
    path = str(tmp_path / name) if content is None else text(tmp_path / name, content)
    with pytest.raises(SceneError) as caught:
        make_sound_speed_field(CastWater(path=path))
    sentence = str(caught.value)
    assert "\n" not in sentence
    for word in ["water.path", path, *words]:
        assert word in sentence


DEPTH = np.arange(1.0, 21.0)
SPEED = 1510.0 - 0.5 * DEPTH
TEMPERATURE = 18.0 - 0.2 * DEPTH


def clock(k, date="2019/03/12 "):
    return f"{date}15:59:{20.0 + 2.0 * k:06.3f}" if k < 20 else f"{date}16:00:{2.0 * (k - 20):06.3f}"


# Lines before the rows, a row from number, depth, pressure, sound speed and temperature, and lines behind the rows.
LAYOUTS = {
    # Valeport SWIFT: names and units in two lines after ``[DATA]``, tabs between columns.
    "a.vp2": (
        ["[HEADER]", "Instrument=SWIFT SVP", "Latitude=38.3", "", "[COLUMNS]", "Depth=Float;m;Calculated", "", "[DATA]",
         "Date/Time\tDepth\tPressure\tSound Velocity\tTemperature\tSalinity\tDensity\tConductivity\t",
         "\tm\tdBar\tMs-1\tDegC\tPSU\tkg/M3\tmS/M"],
        lambda k, d, p, c, t: f"{clock(k)}\t{d:.3f}\t{d * 1.01:.3f}\t{c:.3f}\t{t:.3f}\t31.0\t1006.9\t9.5",
        [],
    ),
    # Valeport MIDAS: the unit of a column stands before the name of the next; pressure alone.
    "a.000": (
        ["Previous File Location :\t786432", "Model Name :\tMIDAS SVP 6000", "Density :\t1025.973",
         "Date / Time\tSOUND VELOCITY;DBAR\tPRESSURE;C\tTEMPERATURE;\t",
         "10/05/2012 15:59:10.000\t0.000\t-0.064\t10.671\t"],
        lambda k, d, p, c, t: f"{clock(k, '10/05/2012 ')}\t{c:.3f}\t{p:.3f}\t{t:.3f}\t",
        [],
    ),
    # AML: sections, of which one names its columns and another holds the rows; date and time apart.
    "a.aml": (
        ["[Header]", "Date=2020-06-23", "Latitude=48.56", "[SensorMetaData]",
         "Columns=Port,Model,SerialNumber,Firmware,Parameter,Units", "[SensorData]",
         "3,P.X2,306674,1.00.1,Pressure,dbar", "[MeasurementMetadata]", "Columns=Date,Time,Cond,TempCT,SV,Pressure",
         "Units=yyyy-mm-dd,hh:mm:ss.ss,mS/cm,C,m/s,dbar", "", "[MeasurementData]"],
        lambda k, d, p, c, t: f"2020-06-23,{clock(k, '')},37.2,{t:.3f},{c:.3f},{p:.3f}",
        ["2020-06-23,16:00:30.00,0.0,16.4,0.000,-0.11"],
    ),
    # CastAway: marks of comments, and names with units in brackets.
    "a.csv": (
        ["% Device,11E101663", "% Start latitude,43.0", "% ",
         "Pressure (Decibar),Depth (Meter),Temperature (Celsius),Conductivity (MicroSiemens per Centimeter),"
         "Specific conductance (MicroSiemens per Centimeter),Salinity (Practical Salinity Scale),"
         "Sound velocity (Meters per Second),Density (Kilograms per Cubic Meter)"],
        lambda k, d, p, c, t: f"{d * 1.01},{d},{t},41824.9,48221.9,31.2,{c},1022.3",
        [],
    ),
    "a.vel": (  # HYPACK
        ["FTP NEW 3 37.998879852 -122.416305140 15:47 08/19/2019"],
        lambda k, d, p, c, t: f"{d:.1f} {c:.2f}",
        [],
    ),
    # AML CALC of a Moving Vessel Profiler: closed by a row of zeros, navigation behind it.
    "a.calc": (
        ["CALC,0004,08-30-2017,1,meters", "AML SOUND VELOCITY PROFILER S/N:00000", "DATE:17242 TIME:2334",
         "DEPTH OFFSET (M):00000.0", "DEPTH (M) VELOCITY (M/S) TEMP (C)"],
        lambda k, d, p, c, t: f"   {d:.1f}  {c:.2f}  {t:.3f} ",
        [" 0  0  0 ", "*** NAV ****", "Bottom Depth (m): 12.8", "LAT ( ddmm.mmmmmmm,N):  3024.6128000,N"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", LAYOUTS)
def test_depth_and_sound_speed_are_those_of_the_file(tmp_path, name):
    head, row, tail = LAYOUTS[name]
    columns = zip(DEPTH, gsw.p_from_z(-DEPTH, 45.0), SPEED, TEMPERATURE)
    rows = [row(k, *values) for k, values in enumerate(columns)]
    (tmp_path / name).write_text("\n".join([*head, *rows, *tail]))
    cast = read_cast(str(tmp_path / name))
    np.testing.assert_allclose(cast.depth, DEPTH, atol=2e-3)
    np.testing.assert_allclose(cast.sound_speed, SPEED, atol=6e-3)
    if name in ("a.vp2", "a.csv"):  # with salinity; alone it says nothing beside the speed
        np.testing.assert_allclose(cast.temperature, TEMPERATURE, atol=2e-3)
    scene = tmp_path / "scene.toml"
    scene.write_text(f'[seabed]\ndepth = 15.0\n[track]\naltitude = 5.0\n[water]\nkind = "cast"\npath = "{name}"\n')
    assert make_sound_speed_field(load_scene(scene).water).depth.size > 1
