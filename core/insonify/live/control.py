"""Control of a live tow from outside: requests as lines of JSON, and the fixes of a ship."""

import json
import math
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from insonify.errors import SceneError
from insonify.io.georeference import from_degrees, local_georeference
from insonify.live.formats import as_json, encode_json
from insonify.live.helm import ShipTow
from insonify.live.nmea import FixReader
from insonify.live.outputs import Address, Reader, TcpServer, parse_address
from insonify.live.tow import Tow

LONGEST = 2**16  # bytes of a request
DAY, AGAIN = 86_400.0, 1.0  # s, and s until a connection is tried again


def obey(tow: Tow, request: Any) -> dict[str, Any]:
    """Carry out a request of one key, and return the answer."""
    known: dict[str, Callable[[Any], Any]] = {
        "ping": lambda pose: as_json(tow.ping(pose, number)),
        "set": tow.set,
        "steer": tow.steer,
        "pause": tow.pause,
        "stop": lambda _: tow.stop(),
    }
    kinds: dict[str, Any] = {"ping": dict, "set": dict, "steer": dict}
    pair: Any = next(iter(request.items())) if isinstance(request, dict) and len(request) == 1 else ("", None)
    name, value = pair
    if name not in known or not isinstance(value, kinds.get(name, bool)):
        raise SceneError(f'a request is one of {", ".join(known)} or stream with its value, such as {{"pause": true}}')
    number = value.pop("number", 0) if name == "ping" else 0
    if not isinstance(number, int) or not 0 <= number < 2**53:
        raise SceneError(f"number: {number!r:.40} is not that of a ping; count from 0")
    answer = known[name](value)
    return answer if isinstance(answer, dict) else {"done": name, "ping": tow.number}


class ControlServer(TcpServer):
    """Takes requests by TCP, one line of JSON each, and answers each with one; ``stream`` asks for all pings."""

    def __init__(self, address: Address, tow: Tow) -> None:
        self._tow = tow
        super().__init__("control", address, None, encode_json)

    def connected(self, connection: socket.socket) -> None:
        """Begin to listen to someone who has connected."""
        threading.Thread(target=self._listen, args=(connection,), daemon=True).start()

    def _listen(self, connection: socket.socket) -> None:
        lock = threading.Lock()  # answers do not fall into pings

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
            stream.error = OSError("has left")
        connection.close()


def follow_ship(tow: Tow, lines: Iterator[str], layback: float, lag: float) -> None:
    """Tow behind a ship by lines of its sentences, which are read on a thread of their own."""
    helm = tow.helm = ShipTow(tow.scene, layback, lag)
    threading.Thread(target=_feed, args=(tow, helm, lines), daemon=True).start()


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
        if before is not None or not math.isnan(fix.course):  # one place alone has no course
            helm.take_fix(x, y, course, speed, course if math.isnan(fix.heading) else tow.direction(fix.heading))
        before = x, y, fix.time


def read_lines(source: str, times: float = 1.0) -> Iterator[str]:
    """Lines of sentences from ``udp:PORT``, ``tcp:HOST:PORT``, or a log, which is replayed at its own times."""
    kind, _, rest = source.partition(":")
    if kind == "udp":
        receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            receiver.bind(parse_address(rest, source))
        except OSError as error:
            raise SceneError(f"--ship {source}: {error.strerror}; choose another port") from None
        return (line for _ in iter(int, 1) for line in receiver.recv(LONGEST).decode("latin-1").splitlines())
    if kind == "tcp":
        return _connected(parse_address(rest, source))
    if not Path(source).is_file():
        raise SceneError(f"--ship {source}: does not exist; give udp:PORT, tcp:HOST:PORT or a log of NMEA 0183")
    return _replayed(Path(source), times)


def _connected(address: Address) -> Iterator[str]:
    """Lines from a server, to which the connection is made again whenever it breaks."""
    while True:
        with suppress(OSError), socket.create_connection(address, AGAIN) as connection:
            connection.settimeout(None)
            yield from connection.makefile(encoding="latin-1")
        time.sleep(AGAIN)


def _replayed(path: Path, times: float) -> Iterator[str]:
    """Lines of a log, each fix when it is due by its time of day."""
    reader, begun, first = FixReader(), time.monotonic(), None
    with path.open(encoding="latin-1") as file:
        for line in file:
            if (fix := reader.read(line)) is not None:
                first = fix.time if first is None else first
                time.sleep(max(begun + (fix.time - first) % DAY / times - time.monotonic(), 0.0))
            yield line
