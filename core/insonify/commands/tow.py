"""``insonify tow``: a scene in real time, to the programs that surveys are made with."""

from __future__ import annotations

import argparse
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from insonify.commands import options
from insonify.io.sealed import SUFFIX
from insonify.scene import SceneError

if TYPE_CHECKING:
    from pathlib import Path

    from insonify.live.outputs import Output
    from insonify.live.tow import Tow

PORT = "[HOST:]PORT"
PORTS = {
    "jsf": "sonar data, attitude and sentences in JSF, by TCP",
    "nmea": "NMEA 0183 (ZDA, GGA, VTG, HDT, DPT, DBT), by TCP",
    "nmea-udp": "the same sentences as datagrams to an address",
    "control": "lines of JSON, by TCP: pings, poses, parameters, pause",
}
FILES = {
    "xtf": "an XTF file that grows with every ping",
    "mcap": "an MCAP file of messages marine_acoustic_msgs/RawSonarImage",
}
MOST_PINGS = 10**8


def register(subparsers: Any) -> None:
    """Add ``tow``."""
    parser = subparsers.add_parser(
        "tow",
        description="Tow over a scene in real time, or so many times faster, and send every ping to survey programs. "
        "Ports are open to this machine alone unless an address is given, such as 0.0.0.0:4000. A reader that is late "
        "loses pings, which are counted, and never stalls the tow. Several fish take successive ports, and files with "
        "numbers. Ctrl-C ends the tow.",
        epilog="examples: insonify tow wreck-site --jsf 4000 --nmea-udp 10110; insonify tow default --xtf live.xtf "
        "--pings 600; insonify tow harbour.toml --ship udp:10111 --layback 40 --lag 3 --jsf 0.0.0.0:4000",
    )
    options.add_scene(parser)
    outputs, steering = parser.add_argument_group("outputs"), parser.add_argument_group("steering")
    for name, explained in (PORTS | FILES).items():
        outputs.add_argument(f"--{name}", metavar=PORT if name in PORTS else "FILE", help=explained)
    ship = "NMEA 0183 of a ship that tows the fish: udp:PORT, tcp:HOST:PORT, or a log to replay"
    seconds, times = options.bounded(0.0, 600.0, "seconds from 0 to 600"), options.bounded(0.01, 1000.0, "0.01 to 1000")
    default = "(default: %(default)g)"
    steering.add_argument("--ship", metavar="SOURCE", help=ship)
    for name, kind, usual, unit, explained in (
        ("layback", options.metres, 30.0, "M", f"horizontal length of the cable {default}"),
        ("lag", seconds, 2.0, "S", f"lag with which the catenary passes on what the ship does {default}"),
        ("fish", int, 1, "N", f"towfish, 1 to 16 {default}"),
        ("apart", options.metres, 20.0, "M", f"distance between neighbouring fish {default}"),
        ("times", times, 1.0, "N", f"seconds of the tow in a second {default}"),
        ("pings", int, None, "N", "end after so many (default: those of the track, or none where it is steered)"),
    ):
        steering.add_argument(f"--{name}", type=kind, default=usual, metavar=unit, help=explained)
    options.add_method(parser)
    options.add_threads(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Tow until the pings are sent or the person ends it, and print what readers got."""
    # lazy: the other commands need none of it
    from insonify.exercises.exercise import read_exercise
    from insonify.live.control import ControlServer, follow_ship, read_lines
    from insonify.live.helm import Helm
    from insonify.live.outputs import parse_address
    from insonify.live.tow import Tow
    from insonify.progress import report_waiting
    from insonify.record.variables import record_attributes

    given = {name: value for name in PORTS | FILES if (value := getattr(arguments, name.replace("-", "_"))) is not None}
    if not given:
        raise SceneError(f"tow: nothing takes the pings; give one of --{', --'.join(PORTS | FILES)}")
    if arguments.pings is not None and not 0 < arguments.pings <= MOST_PINGS:
        raise SceneError(f"--pings {arguments.pings}: give 1 to {MOST_PINGS}")
    ports = {name: parse_address(given[name], f"--{name} {given[name]}") for name in PORTS if name in given}
    paths = {name: options.check_output(given[name], (f".{name}",), f"--{name}") for name in FILES if name in given}
    lines = None if arguments.ship is None else read_lines(arguments.ship, arguments.times)
    method, scene = options.chosen_method(arguments), options.chosen_scene(arguments)
    with report_waiting():
        how = {"times": arguments.times, **method, "threads": arguments.threads}
        tow = Tow(scene, fish=arguments.fish, apart=arguments.apart, **how)
    if arguments.scene.lower().endswith(SUFFIX):
        tow.helm = Helm(scene, 0, read_exercise(arguments.scene).current)
    attributes = record_attributes(scene, tow.simulation.plan, **method) | tow.place.attributes()
    outputs = _open_outputs(tow, ports, paths, attributes)
    if "control" in ports:
        outputs.append(ControlServer(ports["control"], tow))
    if lines is not None:
        follow_ship(tow, lines, arguments.layback, arguments.lag)
    if not tow.on_earth:
        options.say("The scene has no place on Earth: positions are about 40° N, 3° E, or a ship's first fix.")
    options.say(*(f"{output.name}: ready" for output in outputs))
    sys.stdout.flush()
    endless = lines is not None or "control" in ports
    with suppress(KeyboardInterrupt):
        tow.run(outputs, arguments.pings or (None if endless else scene.track.pings))
    for output in outputs:
        output.close()
    _report(tow, outputs)


def _open_outputs(
    tow: Tow, ports: dict[str, tuple[str, int]], paths: dict[str, Path], attributes: dict[str, Any]
) -> list[Output]:
    """Open the outputs of every fish, on successive ports and in numbered files."""
    # lazy: the other commands need none of it
    from insonify.live.formats import encode_jsf, write_growing_xtf, write_mcap
    from insonify.live.nmea import describe_ping, encode_nmea
    from insonify.live.outputs import TcpServer, send_datagrams

    outputs: list[Output] = []
    for fish in range(tow.fish):
        own = {name: (host, port + fish) for name, (host, port) in ports.items()}
        number = f"-{fish + 1}" if tow.fish > 1 else ""
        files = {name: path.with_name(f"{path.stem}{number}{path.suffix}") for name, path in paths.items()}
        if "jsf" in own:
            outputs.append(TcpServer("JSF", own["jsf"], fish, encode_jsf))
        if "nmea" in own:
            outputs.append(TcpServer("NMEA", own["nmea"], fish, encode_nmea))
        if "nmea-udp" in own:
            outputs.append(send_datagrams("NMEA", own["nmea-udp"], fish, describe_ping))
        if "xtf" in files:
            outputs.append(write_growing_xtf(files["xtf"], fish, attributes, patient=tow.times > 1.0))
        if "mcap" in files:
            outputs.append(write_mcap(files["mcap"], fish, patient=tow.times > 1.0))
    return outputs


def _report(tow: Tow, outputs: list[Output]) -> None:
    """Print how late the pings were, and what every output sent."""
    if (pacer := tow.pacer) is not None:
        late = f"half at most {pacer.lateness(0.5):.1f} ms late, 99 % at most {pacer.lateness(0.99):.1f} ms"
        options.say(f"{pacer.waited} pings of {tow.fish} fish: {late}, {pacer.missed} missed")
    for output in outputs:
        readers, sent, dropped = output.counts.values()
        faults = "".join(f"; {each.error.strerror}" for each in output.readers if each.error and each.error.strerror)
        options.say(f"{output.name}: {readers} readers, {sent} pings sent, {dropped} dropped{faults}")
