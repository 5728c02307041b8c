"""Control of a live tow from outside: requests as lines of JSON, and the fixes of a ship."""

import json
import math
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from insonify.errors import SceneError
from insonify.io.georeference import from_degrees, local_georeference
from insonify.live.formats import as_json, encode_json
from insonify.live.helm import ShipTow
from insonify.live.nmea import FixReader
from insonify.live.outputs import Reader, TcpServer, parse_address
from insonify.live.tow import Tow

LONGEST = 2**16  # bytes of a request
DAY, AGAIN = 86_400.0, 1.0  # s, and s until a connection is tried again


def obey(tow: Tow, request: Mapping[str, Any]) -> dict[str, Any]:
    """Carry out a request of one key, and return the answer."""
    done: dict[str, Callable[[Any], Any]] = {
        "ping": lambda pose: as_json(tow.ping(*_pose(pose))),
        "set": tow.set,
        "steer": tow.steer,
        "pause": lambda paused: tow.pause(bool(paused)),
        "stop": lambda _: tow.stop(),
    }
    if not isinstance(request, Mapping) or len(request) != 1 or (name := next(iter(request))) not in done:
        raise SceneError(f'a request has one key of {", ".join(done)} or stream; write for example {{"pause": true}}')
    if name in ("set", "steer") and not isinstance(request[name], dict):
        raise SceneError(f'{name}: write what changes, such as {{"{name}": {{"speed": 2.5}}}}')
    answer: Any = done[name](request[name])
    return answer if isinstance(answer, dict) else {"done": name, "ping": tow.number}


class ControlServer(TcpServer):
    """Takes requests by TCP, one line of JSON each, and answers each with one; ``stream`` asks for all pings."""

    def __init__(self, address: tuple[str, int], tow: Tow) -> None:
        self._tow = tow
        super().__init__("control", address, None, encode_json)

    def connected(self, connection: socket.socket) -> None:
        """Begin to listen to someone who has connected."""
        threading.Thread(target=self._listen, args=(connection,), daemon=True).start()

    def _listen(self, connection: socket.socket) -> None:
        lock = threading.Lock()

        def send(answer: bytes) -> None:
            with lock:
                connection.sendall(answer)

        stream = None
        with suppress(OSError), connection.makefile("rb") as lines:
            while line := lines.readline(LONGEST):
                try:
                    request = json.loads(line)
                    if request == {"stream": True} and stream is None:
                        stream = Reader(lambda live: send(encode_json(live)), lambda: None)
                        self.add(stream)
                    answer = {"done": "stream"} if request == {"stream": True} else obey(self._tow, request)
                except SceneError as error:
                    answer = {"error": str(error)}
                except (ValueError, RecursionError):
                    answer = {"error": 'this is not a line of JSON; write for example {"pause": true}'}
                send(json.dumps(answer).encode("ascii") + b"\n")
        if stream is not None:
            stream.close(0.0)
        connection.close()


def _pose(pose: Any) -> tuple[dict[str, float], int]:
    number = pose.get("number", 0) if isinstance(pose, dict) else None
    if not isinstance(number, int) or number < 0:
        raise SceneError('ping: write a pose, such as {"x": 0, "y": 0, "altitude": 10, "heading": 0, "number": 0}')
    return {name: value for name, value in pose.items() if name != "number"}, number


def follow_ship(tow: Tow, lines: Iterator[str], layback: float, lag: float) -> ShipTow:
    """Tow behind a ship by lines of its sentences, which are read on a thread of their own."""
    helm = tow.helm = ShipTow(tow.scene, layback, lag)
    threading.Thread(target=_feed, args=(tow, helm, lines), daemon=True).start()
    return helm


def _feed(tow: Tow, helm: ShipTow, lines: Iterator[str]) -> None:
    """Pass the fixes among lines of sentences on to a towfish; what a ship does not tell follows from its places."""
    reader, before, course, speed = FixReader(), None, 0.0, 0.0
    for line in lines:
        if (fix := reader.read(line)) is None:
            continue
        if before is None and not tow.on_earth:
            tow.put_on_earth(local_georeference(fix.longitude, fix.latitude))
        places = from_degrees(tow.place, np.array([fix.longitude]), np.array([fix.latitude]))
        x, y = (float(place[0]) for place in places)
        if not math.isnan(fix.course):
            course, speed = tow.direction(fix.course), fix.speed
        elif before is not None and (passed := (fix.time - before[2]) % DAY) > 0.0:
            course, speed = math.atan2(y - before[1], x - before[0]), math.dist((x, y), before[:2]) / passed
        known = before is not None or not math.isnan(fix.course)  # one place alone has no course
        before = x, y, fix.time
        if known:
            helm.take_fix(x, y, course, speed, course if math.isnan(fix.heading) else tow.direction(fix.heading))


def read_lines(source: str, times: float = 1.0) -> Iterator[str]:
    """Lines of sentences from ``udp:PORT``, ``tcp:HOST:PORT``, or a log, which is replayed at its own times."""
    kind, _, rest = source.partition(":")
    if kind == "udp":
        return _received(parse_address(rest, source))
    if kind == "tcp":
        return _connected(parse_address(rest, source))
    if not Path(source).is_file():
        raise SceneError(f"--ship {source}: does not exist; give udp:PORT, tcp:HOST:PORT or a log of NMEA 0183")
    return _replayed(Path(source), times)


def _received(address: tuple[str, int]) -> Iterator[str]:
    """Lines of datagrams."""
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        receiver.bind(address)
    except OSError as error:
        raise SceneError(f"--ship udp:{address[1]}: {error.strerror}; choose another port") from None

    def lines() -> Iterator[str]:
        while True:
            yield from receiver.recv(LONGEST).decode("ascii", errors="replace").splitlines()

    return lines()


def _connected(address: tuple[str, int]) -> Iterator[str]:
    """Lines from a server, to which the connection is made again whenever it breaks."""
    while True:
        with suppress(OSError), socket.create_connection(address, AGAIN) as connection:
            connection.settimeout(None)
            yield from connection.makefile(encoding="ascii", errors="replace")
        time.sleep(AGAIN)


def _replayed(path: Path, times: float) -> Iterator[str]:
    """Lines of a log, each fix when it is due by its time of day."""
    reader, begun, first = FixReader(), time.monotonic(), None
    with path.open(encoding="ascii", errors="replace") as file:
        for line in file:
            if (fix := reader.read(line)) is not None:
                first = fix.time if first is None else first
                time.sleep(max(begun + (fix.time - first) % DAY / times - time.monotonic(), 0.0))
            yield line
