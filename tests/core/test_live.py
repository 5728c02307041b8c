"""A tow in real time: its clock, its pings, what readers of each protocol get, and how it is steered."""

import base64
import json
import math
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pynmea2
import pytest
import pyxtf

from commands import refused, wait_until
from insonify.cli import main
from insonify.live.control import ControlServer, follow_ship, obey, read_lines
from insonify.live.formats import encode_jsf, write_growing_xtf, write_mcap
from insonify.live.helm import KEPT, Helm, ShipTow
from insonify.live.nmea import FixReader, describe_ping, encode_nmea, write_sentence
from insonify.live.outputs import ROOM, LivePing, Output, TcpServer, parse_address, send_datagrams
from insonify.live.pacer import SECOND, Pacer
from insonify.live.tow import OWN_NOISE, Tow
from insonify.scene import Scene, SceneError, edit, load_scene
from insonify.simulation import simulate
from insonify.tow.poses import make_poses

START = datetime(2031, 5, 6, 23, 59, 58, 250_000)
HERE = ("127.0.0.1", 0)
FAST = 25.0  # seconds of a tow in a second


def small(**changes: Any) -> Scene:
    return edit(load_scene("pipe-span"), {
        "sonar.bins": 80, "track.pings": 40, "world.crs": "EPSG:32631", "world.origin": [500e3, 5_600e3],
        "track.heading": 30.0, "receiver.speckle": "rayleigh", **changes,
    })  # fmt: skip


@pytest.fixture(scope="module")
def tow() -> Tow:
    return Tow(small(), start=START, times=FAST)


@contextmanager
def towed(outputs: list[Output], pings: int, **how: Any) -> Iterator[Tow]:
    """A tow that sends pings while the block reads."""
    tow = Tow(small(), start=START, **({"times": FAST} | how))
    thread = threading.Thread(target=tow.run, args=(outputs, pings))
    thread.start()
    yield tow
    thread.join()
    for output in outputs:
        output.close()


def read_all(port: int) -> bytes:
    with closing(socket.create_connection(("127.0.0.1", port), 10.0)) as connection:
        return b"".join(iter(lambda: connection.recv(2**16), b""))


def served(encode: Callable[[LivePing], bytes], pings: int) -> bytes:
    """Bytes that a reader got who connects before the first ping."""
    server, got = TcpServer("it", HERE, 0, encode), []
    reader = threading.Thread(target=lambda: got.append(read_all(server.port)))
    reader.start()
    wait_until(lambda: server.counts["readers"] == 1)
    with towed([server], pings):
        pass
    reader.join()
    return got[0]


class SlowClock:
    """A clock of nanoseconds that every reading and every sleep moves on."""

    def __init__(self, oversleep: float = 0.0) -> None:
        self.now, self.oversleep = 123, oversleep

    def read(self) -> int:
        self.now += 700
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += round((seconds + self.oversleep) * SECOND)


def test_an_hour_of_late_sleeps_does_not_drift() -> None:
    clock = SlowClock(oversleep=3e-3)
    pacer = Pacer(20.0, clock=clock.read, sleep=clock.sleep)
    begun = pacer.due(0)
    for ping in range(72_000):
        assert pacer.wait(ping) == ping
    assert pacer.due(72_000) - begun == 3600 * SECOND
    assert clock.now - begun < (3600 - 0.05 + 0.004) * SECOND
    assert 2.9 < pacer.lateness(0.5) <= pacer.lateness(0.99) < 3.2
    assert (pacer.waited, pacer.missed) == (72_000, 0)
    thirds = Pacer(3.0, clock=clock.read)
    assert abs(thirds.due(10**9) - thirds.due(0) - 10**9 * SECOND / 3) <= 1


@pytest.mark.parametrize(("skips", "next_ping", "missed"), [(True, 45, 35), (False, 10, 0)])
def test_a_tow_that_falls_behind(skips: bool, next_ping: int, missed: int) -> None:
    clock = SlowClock()
    pacer = Pacer(10.0, skips=skips, clock=clock.read, sleep=clock.sleep)
    clock.now += round(4.5 * SECOND)
    assert (pacer.wait(10), pacer.missed) == (next_ping, missed)
    assert pacer.wait(next_ping + 1) == next_ping + 1
    assert clock.now == pytest.approx(pacer.due(next_ping + 1), abs=10_000)


def test_pings_are_those_of_the_record(tow: Tow) -> None:
    record = simulate(tow.scene)
    for ping in (0, 7, 39):
        (live,) = tow.trace(ping)
        np.testing.assert_array_equal(live.intensity, record.intensity.values[:, ping])
        for name, value in live.pose.items():
            assert value == record[name].values[ping]
        assert live.header.x == record.platform_longitude.values[ping]
        assert live.header.number == ping


def test_targets_far_from_the_track_are_there_for_a_fish_that_is_steered_to_them() -> None:
    ball = {"kind": "sphere", "radius": 0.6, "position": [900.0, 700.0]}
    there, without = (Tow(small(targets=targets), start=START) for targets in ([ball], []))
    pose = {"x": 900.0, "y": 688.0, "altitude": 8.0, "heading": 0.0}
    bins = slice(*np.searchsorted(0.625 * np.arange(80), (13.0, 15.5)))  # the ball is 14 m away, to port
    assert there.ping(pose).intensity[0, bins].max() > 4.0 * without.ping(pose).intensity[0, bins].max()
    np.testing.assert_array_equal(there.trace(0)[0].intensity, without.trace(0)[0].intensity)


def test_every_fish_has_its_lane_and_its_noise() -> None:
    fleet = Tow(small(), fish=3, apart=12.0, start=START)
    found = fleet.trace(5)
    assert [live.fish for live in found] == [0, 1, 2]
    single = Tow(small(), start=START)
    assert found[0].pose == pytest.approx(single.trace(5)[0].pose, abs=1e-9)
    places = np.array([[live.pose["platform_x"], live.pose["platform_y"]] for live in found])
    across = np.array([math.sin(math.radians(30.0)), -math.cos(math.radians(30.0))])
    np.testing.assert_allclose(places - places[0], np.outer([0.0, 12.0, 24.0], across), atol=1e-9)
    poses = fleet.poses(5)
    alone = fleet.simulation.record(np.array([5 + 2 * OWN_NOISE]), type(poses)(*(column[2:] for column in poses)))
    np.testing.assert_array_equal(found[2].intensity, alone[0])
    with pytest.raises(SceneError, match="fish: 17 is out of bounds; give 1 to 16"):
        Tow(small(), fish=17)


def test_sentences_of_nmea_read_by_others(tow: Tow) -> None:
    lines = served(encode_nmea, 12).decode().splitlines(keepends=True)
    assert len(lines) == 6 * 12
    assert all(line.endswith("\r\n") and len(line) <= 82 for line in lines)
    for number in (0, 11):
        live = tow.trace(number)[0]
        zda, gga, vtg, hdt, dpt, dbt = (pynmea2.parse(line, check=True) for line in lines[6 * number :][:6])
        assert gga.latitude == pytest.approx(live.header.y, abs=1e-8)
        assert gga.longitude == pytest.approx(live.header.x, abs=1e-8)
        assert zda.datetime.replace(tzinfo=None) == live.header.time.replace(
            microsecond=live.header.time.microsecond // 10_000 * 10_000
        )
        assert float(vtg.spd_over_grnd_kts) == pytest.approx(tow.scene.track.speed / 0.514444, abs=0.01)
        assert float(vtg.true_track) == pytest.approx(60.0, abs=0.05)
        assert float(hdt.heading) == pytest.approx(live.header.heading, abs=0.006)
        assert float(dpt.depth) == float(dbt.depth_meters) == round(live.header.altitude, 1)
        assert float(dbt.depth_feet) == pytest.approx(live.header.altitude / 0.3048, abs=0.06)


def test_datagrams_of_nmea() -> None:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as receiver:
        receiver.bind(HERE)
        receiver.settimeout(10.0)
        port = receiver.getsockname()[1]
        with towed([send_datagrams("NMEA", ("127.0.0.1", port), 0, describe_ping)], 4):
            got = [receiver.recv(1000).decode() for _ in range(24)]
    assert [pynmea2.parse(line, check=True).sentence_type for line in got[:6]] == [
        "ZDA",
        "GGA",
        "VTG",
        "HDT",
        "DPT",
        "DBT",
    ]


def test_jsf_as_topsides_frame_it(tow: Tow) -> None:
    got = served(encode_jsf, 10)
    place, kinds, pings = 0, [], {}
    while place < len(got):
        marker, _, _, kind, command, _, channel, _, _, size = struct.unpack_from("<HBBHBBBBHI", got, place)
        assert (marker, command) == (0x1601, 2)
        body = got[place + 16 : place + 16 + size]
        kinds.append(kind)
        if kind == 80:
            (ping,), (weight,), (samples,) = (
                struct.unpack_from(form, body, at) for form, at in (("<I", 8), ("<h", 168), ("<H", 114))
            )
            pings[ping, channel] = np.ldexp(np.frombuffer(body[240:], "<i2").astype(float), -weight)
            assert samples == pings[ping, channel].size
        place += 16 + size
    assert kinds == [2020, *[2002] * 6, 80, 80] * 10
    for number in (0, 9):
        live = tow.trace(number)[0]
        for channel in (0, 1):
            np.testing.assert_allclose(
                pings[number, channel], live.amplitudes[channel], atol=live.amplitudes.max() / 2**14
            )


def test_an_xtf_file_that_others_follow(tow: Tow, tmp_path: Path) -> None:
    path = tmp_path / "live.xtf"
    with towed([write_growing_xtf(path, 0, {"title": "Live"}, patient=True)], 30):
        wait_until(lambda: path.exists() and path.stat().st_size > 6000)
        growing = path.read_bytes()  # while it is written: whole packets, and one at the end that may be cut
    assert path.read_bytes().startswith(growing)
    header, packets = pyxtf.xtf_read(str(path))
    pings = packets[pyxtf.XTFHeaderType.sonar]
    assert [ping.PingNumber for ping in pings] == list(range(30))
    unit = header.ChanInfo[0].VoltScale / 2**16
    live = tow.trace(29)[0]
    loud = live.amplitudes < unit * 2**15 * 0.99
    stored = np.array([pings[29].data[0][::-1], pings[29].data[1]]) * unit
    np.testing.assert_allclose(stored[loud], live.amplitudes[loud], atol=unit)
    assert pings[29].SensorXcoordinate == pytest.approx(live.header.x, abs=1e-9)


def test_messages_of_ros_in_mcap(tow: Tow, tmp_path: Path) -> None:
    mcap = pytest.importorskip("mcap_ros2.reader")
    path = tmp_path / "live.mcap"
    with towed([write_mcap(path, 0, patient=True)], 6):
        pass
    messages = list(mcap.read_ros2_messages(str(path)))
    assert [each.sequence_count for each in messages] == list(range(6))
    assert {(each.channel.topic, each.schema.name) for each in messages} == {
        ("/sidescan_0/raw", "marine_acoustic_msgs/msg/RawSonarImage")
    }
    image, live = messages[5].ros_msg, tow.trace(5)[0]
    assert (image.image.beam_count, image.image.dtype, image.samples_per_beam) == (2, 8, 80)
    beams = np.frombuffer(bytes(image.image.data), "<f4").reshape(80, 2).T
    np.testing.assert_array_equal(beams, live.amplitudes)
    assert image.rx_angles == pytest.approx([-math.pi / 2, math.pi / 2])
    assert image.sample_rate == pytest.approx(80 * image.ping_info.sound_speed / (2 * tow.scene.sonar.range), rel=1e-6)
    stamp = (live.header.time - datetime(1970, 1, 1)).total_seconds()
    assert image.header.stamp.sec + 1e-9 * image.header.stamp.nanosec == pytest.approx(stamp, abs=1e-6)


def test_a_reader_that_stalls_loses_pings_and_no_other_does() -> None:
    server = TcpServer("it", HERE, 0, lambda live: live.header.number.to_bytes(4, "little") * 2**16)
    with closing(socket.create_connection(("127.0.0.1", server.port))) as stalled:
        wait_until(lambda: server.counts["readers"] == 1)
        got: list[bytes] = []
        reader = threading.Thread(target=lambda: got.append(read_all(server.port)))
        reader.start()
        wait_until(lambda: server.counts["readers"] == 2)
        with towed([server], ROOM + 90) as tow:
            pass
        assert tow.pacer is not None
        assert tow.pacer.missed == 0
        counts = server.counts
        assert 0 < counts["dropped"] <= 90
        stalled.settimeout(0.0)
    reader.join()
    numbers = np.frombuffer(got[0], "<u4").reshape(-1, 2**16)[:, 0]
    np.testing.assert_array_equal(numbers, np.arange(ROOM + 90))


def test_readers_come_again() -> None:
    server = TcpServer("it", HERE, 0, encode_nmea)
    with towed([server], 120):
        for _ in range(3):
            with closing(socket.create_connection(("127.0.0.1", server.port), 10.0)) as connection:
                lines = connection.makefile(encoding="ascii")
                assert pynmea2.parse(next(lines), check=True).sentence_type == "ZDA"
    assert server.counts["readers"] == 3
    with pytest.raises(SceneError, match="choose another port"), closing(socket.create_server(HERE)) as taken:
        TcpServer("it", taken.getsockname(), 0, encode_nmea)


def ask(lines: Any, **request: Any) -> dict[str, Any]:
    lines.write(json.dumps(request) + "\n")
    lines.flush()
    return json.loads(lines.readline())  # type: ignore[no-any-return]


def test_requests_from_outside() -> None:
    tow = Tow(small(), start=START, times=FAST)
    server = ControlServer(HERE, tow)
    with (
        closing(socket.create_connection(("127.0.0.1", server.port), 10.0)) as connection,
        connection.makefile("rw") as lines,
    ):
        pose = {"x": 3.0, "y": -4.0, "altitude": 8.0, "heading": 20.0, "roll": 2.0}
        answer = ask(lines, ping=pose | {"number": 3})
        live = tow.ping(pose, 3)
        assert (answer["ping"], answer["altitude"], answer["roll"]) == (
            3,
            pytest.approx(8.0, abs=1e-6),
            pytest.approx(2.0),
        )
        np.testing.assert_array_equal(np.frombuffer(base64.b64decode(answer["starboard"]), "<f4"), live.intensity[1])
        bins = ask(lines, set={"sonar.bins": 60})
        assert bins == {"done": "set", "ping": 0}
        assert tow.trace(0)[0].intensity.shape == (2, 60)
        for request, sentence in (
            ({"set": {"sonar.ping_rate": 3}}, "sonar.ping_rate: places the pings and stays"),
            ({"set": {"sonar.range": -1}}, "sonar.range: -1 is out of bounds"),
            ({"set": 5}, "a request is one of ping, set, steer"),
            ({"steer": {"speed": "fast"}}, "speed: 'fast' is not a number"),
            ({"steer": {"turn": 400}}, "turn: 400 is out of bounds; give -90 to 90"),
            ({"steer": {"depth": 4}}, "depth: is no way to steer"),
            ({"ping": {"z": 4}}, "z: is not part of a pose"),
            ({"ping": {"depth": 4, "altitude": 4}}, "altitude: has no effect beside depth"),
            ({"ping": 3}, "a request is one of ping"),
            ({"ping": {"altitude": -4}}, "below the bed"),
            ({"sing": 1}, "a request is one of ping"),
        ):
            assert sentence in ask(lines, **request)["error"]
        lines.write("[" * 5000 + "\n")
        lines.flush()
        assert "not a line of JSON" in json.loads(lines.readline())["error"]
        assert ask(lines, stream=True) == {"done": "stream"}
        thread = threading.Thread(target=tow.run, args=([server],))
        thread.start()
        first = [json.loads(lines.readline()) for _ in range(3)]
        assert [each["ping"] for each in first] == [0, 1, 2]
        tow.pause()
        time.sleep(0.1)
        paused = tow.number
        time.sleep(0.3)
        assert tow.number == paused
        tow.steer({"turn": 10.0, "speed": 3.0})
        tow.pause(False)
        wait_until(lambda: tow.number > paused + 30)
        obey(tow, {"stop": True})
        thread.join()
    server.close()
    assert tow.helm is not None
    line = tow.helm.line(np.array([tow.number - 11, tow.number - 1]))
    turned = 10 * 10.0 / tow.scene.sonar.ping_rate
    assert math.degrees(line.heading[1] - line.heading[0]) == pytest.approx(turned)


def test_a_helm_keeps_what_was_sent_and_turns_in_circles() -> None:
    helm = Helm(small(), current=(0.0, 0.0))
    rate = small().sonar.ping_rate
    helm.advance(10)
    sent = helm.line(np.arange(11))
    helm.turn, helm.speed = 6.0, 2.0
    around = round(60.0 * rate)
    helm.advance(10 + around)
    line = helm.line(np.arange(11 + around))
    np.testing.assert_array_equal(line.x[:11], sent.x)
    np.testing.assert_allclose((line.x[-1], line.y[-1]), (sent.x[-1], sent.y[-1]), atol=1e-9)
    assert np.ptp(line.x[10:]) == pytest.approx(2.0 * 2.0 / math.radians(6.0), rel=1e-3)
    helm.turn, helm.current = 0.0, (0.5, -0.25)
    helm.advance(helm.newest + round(8.0 * rate))
    away = helm.line(np.array([helm.newest]))
    ahead = 16.0 * np.array([math.cos(away.heading[0]), math.sin(away.heading[0])])
    np.testing.assert_allclose(
        (away.x[0] - line.x[-1], away.y[0] - line.y[-1]), ahead + np.array([4.0, -2.0]), atol=1e-9
    )
    helm.advance(3 * KEPT)
    assert helm.newest == 3 * KEPT
    assert len(helm._columns[0]) < 1.2 * KEPT
    assert helm.line(np.array([3 * KEPT])).x[0] == helm._columns[0][-1]


def test_a_line_is_looked_at_while_it_grows() -> None:
    helm, done = Helm(small()), threading.Event()

    def look() -> int:
        looks = 0
        while not done.is_set():
            line = helm.line(np.arange(0, 20_000, 500))
            assert np.isfinite(line.x).all()
            looks += 1
        return looks

    with ThreadPoolExecutor() as threads:
        looking = threads.submit(look)
        for ping in range(0, 20_000, 10):
            helm.advance(ping)
        done.set()
        assert looking.result() > 0


def test_a_steered_fish_follows_the_bed() -> None:
    tow = Tow(small(**{"track.terrain_following": True, "track.altitude": 8.0}), start=START)
    tow.steer({"turn": 0.0})
    level = make_poses(tow.scene, tow.simulation.ground, np.arange(30))
    steered = np.concatenate([tow.poses(ping).z for ping in range(30)])
    np.testing.assert_allclose(steered, level.z, atol=1e-6)  # straight ahead it is what a track foresees


@pytest.mark.parametrize(("lag", "behind"), [(0.0, 40.0), (3.0, 46.0)])
def test_a_fish_trails_its_ship(lag: float, behind: float) -> None:
    scene = small()
    fish, rate = ShipTow(scene, 40.0, lag), scene.sonar.ping_rate
    for ping in range(round(120 * rate)):
        fish.take_fix(2.0 * ping / rate, 5.0, 0.0, 2.0, 0.0)
        fish.advance(ping)
    at = fish.line(np.array([fish.newest]))
    assert 2.0 * fish.newest / rate - at.x[0] == pytest.approx(behind, abs=0.3)
    assert (at.y[0], at.heading[0]) == (pytest.approx(5.0), pytest.approx(0.0))
    # A ship on a circle of radius R tows the fish, without lag, on one of radius sqrt(R² - L²) (a tractrix).
    circling, turn = ShipTow(scene, 40.0, 0.0), 2.0 / 60.0
    for ping in range(round(700 * rate)):
        angle = turn * ping / rate
        circling.take_fix(60.0 * math.cos(angle), 60.0 * math.sin(angle), angle + math.pi / 2, 2.0, angle + math.pi / 2)
        circling.advance(ping)
    at = circling.line(np.array([circling.newest]))
    assert math.hypot(at.x[0], at.y[0]) == pytest.approx(math.sqrt(60.0**2 - 40.0**2), rel=0.01)


def test_fixes_of_a_ship() -> None:
    reader = FixReader()
    heading = write_sentence("HEHDT", "271.5", "T")
    assert reader.read(heading) is None
    fix = reader.read(
        str(
            pynmea2.GGA(
                "GP", "GGA", ("120044.50", "5230.500", "S", "01307.5", "W", "1", "8", "1", "0", "M", "", "M", "", "")
            )
        )
    )
    assert fix is not None
    assert (fix.time, fix.latitude, fix.longitude) == (43_244.5, -52.508333333333333, -13.125)
    assert fix.heading == 271.5
    assert math.isnan(fix.course)
    fix = reader.read("$GPRMC,120045,A,5230.5,N,01307.5,E,10.0,084.4,230394,003.1,W")
    assert fix is not None
    assert (fix.course, fix.speed) == (84.4, pytest.approx(5.14444, abs=1e-4))
    assert (reader.read("$GPRMC,120045,V,5230.5,N,01307.5,E,10.0,084.4,230394,003.1,W"), reader.refused) == (None, 0)
    for damaged in (heading.replace("271", "272"), "", "$GPGGA,1,2,3,4,5,1*00", "\x00\xff", "$HEHDT,nan,T"):
        assert reader.read(damaged) is None
    assert reader.refused == 5  # a line of other letters is none of the sentences that are read


def test_a_log_of_a_ship_is_replayed(tmp_path: Path) -> None:
    log = tmp_path / "ship.nmea"
    with log.open("w") as file:
        for second in range(60):  # due north at 3 m/s
            place = f"52{60.0 * 3.0 * second / 111_270.0:09.6f}", "N", "00300.000000", "E"
            rest = "1", "9", "1", "0", "M", "", "M", "", ""
            file.write(write_sentence("GPGGA", f"0000{second:02}.0", *place, *rest))
    tow = Tow(small(**{"world.crs": "", "world.origin": None}), start=START)
    rate, begun = tow.scene.sonar.ping_rate, time.monotonic()

    def towed_on() -> Iterator[str]:
        for second, line in enumerate(read_lines(str(log), 200.0)):
            tow.poses(round(second * rate))
            yield line

    assert not tow.on_earth
    follow_ship(tow, towed_on(), 25.0, 0.0)
    wait_until(lambda: tow.helm.newest == 59 * rate)
    assert time.monotonic() - begun > 59 / 200.0
    live = tow.trace(round(59 * rate))[0]
    assert live.header.x == pytest.approx(3.0, abs=1e-6)
    assert (live.header.y - 52.0) * 111_270.0 == pytest.approx(59 * 3.0 - 25.0, abs=0.5)
    assert live.header.heading == pytest.approx(360.0, abs=0.1)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ("", "nothing takes the pings; give one of --jsf"),
        ("--jsf 99999", "--jsf 99999: is not an address; give a port such as 4000, or HOST:PORT"),
        ("--nmea-udp here", "is not an address"),
        ("--xtf live.nc", "end the name in .xtf"),
        ("--xtf live.xtf --ship gone.nmea", "--ship gone.nmea: does not exist; give udp:PORT"),
        ("--xtf live.xtf --pings 0", "--pings 0: give 1 to"),
        ("--xtf live.xtf --fish 40", "fish: 40 is out of bounds"),
    ],
)
def test_mistakes_of_the_command(
    options: str, sentence: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert sentence in refused(capsys, "tow", "pipe-span", *options.split())
    assert not list(tmp_path.iterdir())


def test_the_command_says_what_readers_got(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "a.xtf"
    command = [
        "tow",
        "pipe-span",
        "--set",
        "sonar.bins=64",
        "--xtf",
        str(path),
        "--pings",
        "9",
        "--fish",
        "2",
        "--times",
        "20",
    ]
    assert main(command) == 0
    said = capsys.readouterr().out
    assert "9 pings of 2 fish: half at most" in said
    assert "a-2.xtf: 1 readers, 9 pings sent, 0 dropped" in said
    assert len(pyxtf.xtf_read(str(tmp_path / "a-1.xtf"))[1][pyxtf.XTFHeaderType.sonar]) == 9
    assert parse_address("4000") == ("127.0.0.1", 4000)
    assert parse_address("0.0.0.0:5") == ("0.0.0.0", 5)
