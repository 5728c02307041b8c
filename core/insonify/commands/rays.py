"""``insonify rays``: a ray diagram of the water of a scene."""

import argparse
from typing import Any

from insonify.commands.options import add_output, add_scene, chosen_output, chosen_scene, say


def register(subparsers: Any) -> None:
    """Add ``rays``."""
    parser = subparsers.add_parser(
        "rays",
        description="Draw the sound speed over depth and the rays it refracts, with shadow zones and caustics.",
    )
    add_scene(parser, optional=True)
    add_output(parser, (".png", ".csv"))
    parser.add_argument(
        "--target",
        nargs=2,
        type=float,
        metavar=("RANGE", "DEPTH"),
        help="find the eigenrays from the sonar to this point, in metres",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Trace the rays of a scene and write the diagram."""
    path = chosen_output(arguments)
    scene = chosen_scene(arguments)
    # lazy: Matplotlib and the kernels
    from insonify.display.ray_diagram.diagram import describe_eigenray
    from insonify.display.ray_diagram.figure import write_ray_diagram
    from insonify.display.ray_diagram.tracing import trace_ray_diagram
    from insonify.terrain import build_ground

    diagram = trace_ray_diagram(
        scene, datum=build_ground(scene).datum, target=None if arguments.target is None else tuple(arguments.target)
    )
    write_ray_diagram(path, diagram)
    say(*map(describe_eigenray, diagram.eigenrays))
    if arguments.target is not None and not diagram.eigenrays:
        say("no ray reaches that point: it lies in a shadow zone")
    say(*diagram.limits, str(path))
