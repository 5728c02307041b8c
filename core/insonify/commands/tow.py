"""``insonify tow``: a scene in real time, to the programs that surveys are made with."""

import argparse
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

from insonify.commands import options
from insonify.io.sealed import SUFFIX
from insonify.scene import SceneError

FILES = {"xtf", "mcap"}
OUTPUTS = ("jsf", "nmea", "nmea_udp", "control", *sorted(FILES))
FASTEST = 1000.0
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
    outputs = parser.add_argument_group("outputs")
    where = "[HOST:]PORT"
    outputs.add_argument("--jsf", metavar=where, help="sonar data, attitude and sentences in JSF, by TCP")
    outputs.add_argument("--nmea", metavar=where, help="NMEA 0183 (ZDA, GGA, VTG, HDT, DPT, DBT), by TCP")
    outputs.add_argument("--nmea-udp", metavar=where, help="the same sentences as datagrams to an address")
    outputs.add_argument("--xtf", metavar="FILE", help="an XTF file that grows with every ping")
    outputs.add_argument("--mcap", metavar="FILE", help="an MCAP file of messages marine_acoustic_msgs/RawSonarImage")
    outputs.add_argument("--control", metavar=where, help="lines of JSON, by TCP: pings, poses, parameters, pause")
    steering = parser.add_argument_group("steering")
    steering.add_argument(
        "--ship",
        metavar="SOURCE",
        help="NMEA 0183 of a ship that tows the fish: udp:PORT, tcp:HOST:PORT, or a log to replay",
    )
    steering.add_argument(
        "--layback",
        type=options.metres,
        default=30.0,
        metavar="M",
        help="horizontal length of the cable (default: %(default)g)",
    )
    steering.add_argument(
        "--lag",
        type=options.bounded(0.0, 600.0, "seconds from 0 to 600"),
        default=2.0,
        metavar="S",
        help="lag with which the catenary passes on what the ship does (default: %(default)g)",
    )
    steering.add_argument("--fish", type=int, default=1, metavar="N", help="towfish, 1 to 16 (default: 1)")
    steering.add_argument(
        "--apart",
        type=options.metres,
        default=20.0,
        metavar="M",
        help="distance between neighbouring fish (default: %(default)g)",
    )
    steering.add_argument(
        "--times",
        type=options.bounded(0.01, FASTEST, f"0.01 to {FASTEST:g}"),
        default=1.0,
        metavar="N",
        help="seconds of the tow in a second (default: 1)",
    )
    steering.add_argument(
        "--pings",
        type=int,
        metavar="N",
        help="end after so many (default: the pings of the track, or none where the tow is steered)",
    )
    options.add_method(parser)
    options.add_threads(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Tow until the pings are sent or the person ends it, and print what readers got."""
    # lazy: the other commands need none of it
    from insonify.exercises.exercise import read_exercise
    from insonify.live.control import ControlServer, follow_ship, read_lines
    from insonify.live.formats import encode_jsf, write_growing_xtf, write_mcap
    from insonify.live.helm import Helm
    from insonify.live.nmea import describe_ping, encode_nmea
    from insonify.live.outputs import Output, TcpServer, parse_address, send_datagrams
    from insonify.live.tow import Tow
    from insonify.progress import report_waiting
    from insonify.record.variables import record_attributes

    given = {name: value for name in OUTPUTS if (value := getattr(arguments, name)) is not None}
    if not given:
        raise SceneError("tow: nothing takes the pings; give --jsf, --nmea, --nmea-udp, --xtf, --mcap or --control")
    if arguments.pings is not None and not 0 < arguments.pings <= MOST_PINGS:
        raise SceneError(f"--pings {arguments.pings}: give 1 to {MOST_PINGS}")
    ports = {
        name: parse_address(value, f"--{name.replace('_', '-')} {value}")
        for name, value in given.items()
        if name not in FILES
    }
    for name in FILES & given.keys():
        options.check_output(given[name], (f".{name}",))
    lines = None if arguments.ship is None else read_lines(arguments.ship, arguments.times)
    method, scene = options.chosen_method(arguments), options.chosen_scene(arguments)
    with report_waiting():
        how = method | {"threads": arguments.threads}
        tow = Tow(scene, fish=arguments.fish, apart=arguments.apart, times=arguments.times, **how)
    if Path(arguments.scene).suffix.lower() == SUFFIX:
        tow.helm = Helm(scene, 0, read_exercise(arguments.scene).current)
    attributes = record_attributes(scene, tow.simulation.plan, **method) | tow.place.attributes()
    outputs: list[Output] = []
    for fish in range(tow.fish):
        own = {name: (host, port + fish) for name, (host, port) in ports.items()}
        files = {name: _numbered(given[name], fish, tow.fish) for name in FILES & given.keys()}
        if "jsf" in own:
            outputs.append(TcpServer("JSF", own["jsf"], fish, encode_jsf))
        if "nmea" in own:
            outputs.append(TcpServer("NMEA", own["nmea"], fish, encode_nmea))
        if "nmea_udp" in own:
            outputs.append(send_datagrams("NMEA", own["nmea_udp"], fish, describe_ping))
        if "xtf" in files:
            outputs.append(write_growing_xtf(files["xtf"], fish, attributes, patient=tow.times > 1.0))
        if "mcap" in files:
            outputs.append(write_mcap(files["mcap"], fish, patient=tow.times > 1.0))
    if "control" in ports:
        outputs.append(ControlServer(ports["control"], tow))
    if lines is not None:
        follow_ship(tow, lines, arguments.layback, arguments.lag)
    if not tow.on_earth:
        options.say("The scene has no place on Earth: positions are about 40° N, 3° E, or a ship's first fix.")
    options.say(*(f"{output.name}: ready" for output in outputs))
    sys.stdout.flush()
    endless = arguments.ship is not None or "control" in ports
    with suppress(KeyboardInterrupt):
        tow.run(outputs, arguments.pings or (None if endless else scene.track.pings))
    for output in outputs:
        output.close()
    _report(tow, outputs)


def _report(tow: Any, outputs: Any) -> None:
    """Print how late pings were, and what readers got."""
    if (pacer := tow.pacer) is not None:
        late = f"half at most {pacer.lateness(0.5):.1f} ms late, 99 % at most {pacer.lateness(0.99):.1f} ms"
        options.say(f"{pacer.waited} pings of {tow.fish} fish: {late}, {pacer.missed} missed")
    for output in outputs:
        readers, sent, dropped = output.counts.values()
        fault = "".join(f"; {each.error.strerror}" for each in output.readers if each.error and each.error.strerror)
        options.say(f"{output.name}: {readers} readers, {sent} pings sent, {dropped} dropped{fault}")


def _numbered(path: str, fish: int, of: int) -> Path:
    """File of one fish of several."""
    whole = Path(path)
    return whole if of == 1 else whole.with_name(f"{whole.stem}-{fish + 1}{whole.suffix}")
