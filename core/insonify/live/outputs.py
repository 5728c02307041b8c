"""Outputs of a live tow: each reader has a queue and a thread of its own, so that a late one never stalls the tow."""

import os
import socket
import threading
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, Full, Queue
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Singles
from insonify.errors import SceneError
from insonify.io.records.survey_log import LoggedPing

ROOM = 64  # pings that wait for a reader
PATIENCE = 2.0  # s for what waits, when a tow ends
LOOPBACK = "127.0.0.1"
Address = tuple[str, int]


class LivePing(NamedTuple):
    """A ping of one towfish, as it is sent."""

    fish: int  # number of the towfish, from 0
    header: LoggedPing  # number, time, place on Earth and attitude
    intensity: Singles  # (2, bins) as a record has it, port first
    course: float  # over ground, in degrees clockwise from north
    pose: dict[str, float]  # place and attitude in the scene, in metres and degrees, by their names in a record

    @property
    def amplitudes(self) -> Singles:
        """Amplitudes near to far, (2, bins)."""
        return np.sqrt(self.intensity)


class Reader:
    """One reader of pings: when it is late the oldest that wait are dropped; a patient tow waits for it instead."""

    def __init__(
        self, send: Callable[[LivePing], Any], end: Callable[[], Any], *, room: int = ROOM, patient: bool = False
    ) -> None:
        self.sent = self.dropped = 0
        self.error: OSError | None = None  # why it takes no more
        self._send, self._end, self._patient = send, end, patient
        self._waiting: Queue[LivePing | None] = Queue(room)
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def offer(self, live: LivePing | None) -> None:
        """Put a ping into the queue; None ends the reader."""
        while self.error is None:
            try:
                self._waiting.put(live, self._patient)
                return
            except Full:
                with suppress(Empty):
                    self._waiting.get_nowait()
                    self.dropped += 1

    def close(self, patience: float = PATIENCE) -> None:
        """Send what waits, for some seconds at most, and end."""
        self.offer(None)
        self._thread.join(patience)

    def _work(self) -> None:
        try:
            while (live := self._waiting.get()) is not None:
                self._send(live)
                self.sent += 1
        except OSError as error:
            self.error = error
            with suppress(Empty):  # a tow may wait for room
                self._waiting.get_nowait()
        finally:
            with suppress(OSError):
                self._end()


class Output:
    """An output to some readers, of which each gets the pings of one towfish, or of all."""

    def __init__(self, name: str, fish: int | None, *readers: Reader) -> None:
        self.name, self._fish, self.readers = name, fish, [*readers]
        self._lock, self._gone = threading.Lock(), Counter({"readers": 0, "sent": 0, "dropped": 0})

    def offer(self, live: LivePing) -> None:
        """Put a ping into the queue of every reader."""
        if self._fish in (None, live.fish):
            for reader in self.readers:
                reader.offer(live)

    def add(self, reader: Reader) -> None:
        """Send pings to one more reader; those that have left are counted and forgotten."""
        with self._lock:
            self._gone = self._count([each for each in self.readers if each.error])
            self.readers = [*(each for each in self.readers if not each.error), reader]

    @property
    def counts(self) -> dict[str, int]:
        """Readers that came so far, and pings that they got, and lost."""
        with self._lock:
            return dict(self._count(self.readers))

    def close(self) -> None:
        """Send what waits, and end."""
        for reader in self.readers:
            reader.close()

    def _count(self, readers: list[Reader]) -> Counter[str]:
        counts = Counter(self._gone)
        for each in readers:
            counts.update(readers=1, sent=each.sent, dropped=each.dropped)
        return counts


class TcpServer(Output):
    """An output to everyone who connects, again and again."""

    def __init__(self, name: str, address: Address, fish: int | None, encode: Callable[[LivePing], bytes]) -> None:
        super().__init__(f"{name} on tcp {':'.join(map(str, address))}", fish)
        self._encode = encode
        try:
            self._socket = socket.create_server(address)
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno else str(error)
            raise SceneError(f"{self.name}: {reason.lower()}; choose another port, or end who uses it") from None
        self.port = int(self._socket.getsockname()[1])
        threading.Thread(target=self._accept, daemon=True).start()

    def connected(self, connection: socket.socket) -> None:
        """Begin to send to someone who has connected."""
        self.add(Reader(lambda live: connection.sendall(self._encode(live)), connection.close))

    def close(self) -> None:
        """Send what waits, and end."""
        with suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)  # wakes the thread that waits for connections
        self._socket.close()
        super().close()

    def _accept(self) -> None:
        with suppress(OSError):  # closed
            while True:
                connection, _ = self._socket.accept()
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self.connected(connection)


def send_datagrams(name: str, address: Address, fish: int, encode: Callable[[LivePing], list[str]]) -> Output:
    """Make an output that sends every sentence about a ping as one datagram."""
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)

    def send(live: LivePing) -> None:
        for sentence in encode(live):
            with suppress(ConnectionRefusedError):  # nobody listens at the moment
                sender.sendto(sentence.encode("ascii"), address)

    return Output(f"{name} to udp {':'.join(map(str, address))}", fish, Reader(send, sender.close))


def parse_address(text: str, given: str = "") -> Address:
    """Read ``PORT``, which is one of this machine alone, or ``HOST:PORT``."""
    host, _, port = text.rpartition(":")
    if not (port.isascii() and port.isdigit() and int(port) < 2**16):
        raise SceneError(f"{given or text}: is not an address; give a port such as 4000, or HOST:PORT")
    return host or LOOPBACK, int(port)
