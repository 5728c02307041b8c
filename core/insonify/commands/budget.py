"""``insonify budget``: the sonar equation of a scene, line by line and over range."""

import argparse
import math
from typing import Any

from insonify.commands.options import add_scene, check_output, chosen_scene, decibels, level_line, metres, say
from insonify.scene import SceneError

SUFFIXES = (".png", ".svg", ".csv")


def register(subparsers: Any) -> None:
    """Add ``budget``."""
    parser = subparsers.add_parser(
        "budget",
        description="Print the sonar equation of a level bed of the scene's materials and of a target on it, line by "
        "line in dB, and the range beyond which noise and reverberation are louder. Example: insonify budget "
        "raw-record --range 40 --target -15",
    )
    add_scene(parser)
    parser.add_argument("--range", type=metres, metavar="M", help="slant range, m (default: half that of the record)")
    parser.add_argument(
        "--target", type=decibels, default=-20.0, metavar="TS", help="target strength, dB (default: %(default)g)"
    )
    parser.add_argument("-o", "--output", metavar="OUT", help=f"file for the levels over range: {', '.join(SUFFIXES)}")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the sonar equation, and write it over range if asked for."""
    path = None if arguments.output is None else check_output(arguments.output, SUFFIXES)
    scene = chosen_scene(arguments)
    at = 0.5 * scene.sonar.range if arguments.range is None else arguments.range
    if at > scene.sonar.range:
        raise SceneError(f"--range {at:g}: the record ends at {scene.sonar.range:g} m; give a range within it")
    # lazy: loads Numba, which other commands do without
    from insonify.acoustics.bed_materials import describe_materials
    from insonify.explanation.sonar_equation import solve_sonar_equation, write_sonar_equation

    solved, farther = solve_sonar_equation(scene, arguments.target)
    unit = "re 1 µPa" if scene.receiver.source_level > 0.0 else "re the source at 1 m"
    grazing = math.degrees(float(solved.grazing[solved.bin_at(at)]))
    say(f"levels at {at:.2f} m, grazing {grazing:.1f}°, in dB {unit}")
    for term, is_sum in solved.table(at):
        say(level_line(f"{'= ' if is_sum else '  '}{term.name}", term.decibels, term.detail))
    say(level_line("  energy of the pulse", solved.energy, "source level and duration, times 1 s"))
    for level in (farther.bed, farther.target):
        say(f"{level.name}: {_where(farther.farthest(level), farther.slant_range[-1])}")
    say(*describe_materials(scene), *scene.describe_limits())
    if path is not None:
        write_sonar_equation(path, solved)
        say(str(path))


def _where(farthest: float, end: float) -> str:
    """Range up to which something is detected, in words."""
    if farthest == 0.0:
        return "below noise and reverberation at every range"
    if farthest == math.inf:
        return f"above noise and reverberation up to {end:.0f} m at least"
    return f"above noise and reverberation up to {farthest:.1f} m"
