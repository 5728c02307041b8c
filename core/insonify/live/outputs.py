"""Outputs of a live tow: each reader has a queue and a thread of its own, so that a late one never stalls the tow."""

import socket
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from insonify.errors import SceneError
from insonify.live.ping import LivePing

ROOM = 64  # pings that wait for a reader
LOOPBACK = "127.0.0.1"
PATIENCE = 2.0  # s for what waits, when a tow ends
Encode = Callable[[LivePing], bytes]


class Reader:
    """One reader of pings. When it is late the oldest that wait are dropped; a patient tow waits for it instead.

    Attributes
    ----------
    sent, dropped : int
        Pings that the reader got, and that it did not get.
    error : OSError or None
        Why it ended.
    """

    def __init__(
        self, send: Callable[[LivePing], Any], end: Callable[[], Any], *, room: int = ROOM, patient: bool = False
    ) -> None:
        self.sent = self.dropped = 0
        self.error: OSError | None = None
        self._send, self._end, self._room, self._patient = send, end, room, patient
        self._waiting: deque[LivePing] = deque()
        self._changed = threading.Condition()
        self._closing = False
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def offer(self, live: LivePing) -> None:
        """Put a ping into the queue."""
        with self._changed:
            if self._patient:
                self._changed.wait_for(lambda: len(self._waiting) < self._room or self._closing)
            if self._closing:
                return
            if len(self._waiting) >= self._room:
                self.dropped += 1
                self._waiting.popleft()
            self._waiting.append(live)
            self._changed.notify_all()

    def close(self, patience: float = PATIENCE) -> None:
        """Send what waits, for some seconds at most, and end."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(patience)

    @property
    def ended(self) -> bool:
        """Whether the reader takes no more pings."""
        return not self._thread.is_alive()

    def _work(self) -> None:
        try:
            while True:
                with self._changed:
                    self._changed.wait_for(lambda: self._waiting or self._closing)
                    if not self._waiting:
                        return
                    live = self._waiting.popleft()
                    self._changed.notify_all()
                self._send(live)
                self.sent += 1
        except OSError as error:
            self.error = error
            with self._changed:
                self._closing = True
                self._waiting.clear()
                self._changed.notify_all()
        finally:
            with suppress(OSError):
                self._end()


class Output:
    """An output of a tow to a list of readers, of which each gets the pings of one towfish or of all.

    Attributes
    ----------
    name : str
        Of its protocol and place, for people.
    """

    def __init__(self, name: str, fish: int | None = None, *readers: Reader) -> None:
        self.name, self._fish = name, fish
        self._readers, self._lock = [*readers], threading.Lock()
        self._sent = self._dropped = self._came = 0  # of readers that have ended

    def offer(self, live: LivePing) -> None:
        """Put a ping into the queue of every reader."""
        if self._fish is None or live.fish == self._fish:
            for reader in self._readers:
                reader.offer(live)

    def add(self, reader: Reader) -> None:
        """Send pings to one more reader."""
        with self._lock:
            gone = [each for each in self._readers if each.ended]
            self._came += len(gone)
            self._sent += sum(each.sent for each in gone)
            self._dropped += sum(each.dropped for each in gone)
            self._readers = [*(each for each in self._readers if each not in gone), reader]

    @property
    def counts(self) -> dict[str, int]:
        """Readers that came so far, and pings that they got and did not get."""
        with self._lock:
            sent = self._sent + sum(each.sent for each in self._readers)
            dropped = self._dropped + sum(each.dropped for each in self._readers)
            return {"readers": self._came + len(self._readers), "sent": sent, "dropped": dropped}

    @property
    def error(self) -> OSError | None:
        """Why a file or an address takes no more pings."""
        return next((each.error for each in self._readers if each.error), None)

    def close(self) -> None:
        """Send what waits, and end."""
        for reader in self._readers:
            reader.close()


class TcpServer(Output):
    """An output to everyone who connects, again and again."""

    def __init__(self, name: str, address: tuple[str, int], fish: int | None, encode: Encode) -> None:
        super().__init__(f"{name} on tcp {':'.join(map(str, address))}", fish)
        self._encode = encode
        try:
            self._socket = socket.create_server(address)
        except OSError as error:
            raise SceneError(f"{self.name}: {error.strerror}; choose another port, or end who uses it") from None
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
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:  # closed
                return
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.connected(connection)


def parse_address(text: str, given: str = "") -> tuple[str, int]:
    """Read ``PORT``, which is one of this machine alone, or ``HOST:PORT``."""
    host, _, port = text.rpartition(":")
    if not (port.isascii() and port.isdigit() and int(port) < 2**16):
        raise SceneError(f"{given or text}: is not an address; give a port such as 4000, or HOST:PORT")
    return host.strip("[]") or LOOPBACK, int(port)


def send_datagrams(name: str, address: tuple[str, int], fish: int, encode: Callable[[LivePing], list[str]]) -> Output:
    """Make an output that sends every sentence about a ping as one datagram."""
    try:
        family, kind, _, _, place = socket.getaddrinfo(*address, type=socket.SOCK_DGRAM)[0]
    except OSError as error:
        raise SceneError(f"{name}: {address[0]}: {error.strerror}; give HOST:PORT") from None
    sender = socket.socket(family, kind)
    sender.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)

    def send(live: LivePing) -> None:
        for sentence in encode(live):
            with suppress(ConnectionRefusedError):  # nobody listens at the moment
                sender.sendto(sentence.encode("ascii"), place)

    return Output(f"{name} to udp {':'.join(map(str, address))}", fish, Reader(send, sender.close))
