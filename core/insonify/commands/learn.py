"""``insonify learn``: a scene whose record resembles a recording."""

import argparse
from typing import Any

from insonify.commands.options import add_frequency, add_many, add_output, chosen_output, is_record, say
from insonify.errors import SceneError
from insonify.io.records import RECORDS, read_record
from insonify.progress import report_progress
from insonify.scene import read_setting


def register(subparsers: Any) -> None:
    """Add ``learn``."""
    parser = subparsers.add_parser(
        "learn",
        description="Take sonar and track from a record, learn relief, material, speckle and level of its bed, and "
        "write a scene whose own record resembles it. Print what matches, what differs, and what the record does not "
        "show.",
        epilog="example: insonify learn recording.xtf -o scene.toml --set sonar.beam.width=0.5",
    )
    parser.add_argument("record", metavar="RECORD", help=f"a record: {RECORDS.describe(RECORDS.readable())}")
    add_output(parser, (".toml",))
    lacking = "a field of sonar, water or receiver that the record lacks, e.g. sonar.beam.width=0.5"
    add_many(parser, "--set", "PATH=VALUE", lacking)
    add_frequency(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Learn a scene from a record, write it, and print how its record compares."""
    path, name = chosen_output(arguments), arguments.record
    changes = dict(read_setting(text) for text in arguments.set)
    if not is_record(name):
        raise SceneError(f"{name}: is not a record; give {RECORDS.describe(RECORDS.readable())}")
    record = read_record(name, arguments.frequency)
    # lazy: the other commands need neither SciPy nor the kernels
    from insonify.inversion.learning import learn

    with report_progress("learning", 1.0, delay=1.0) as progress:
        learned = learn(record, changes, progress=progress.reach)
    say(*learned.lines())
    scene_file, *others = learned.write(path)
    say(*map(str, others), f"{scene_file}: its record {learned.summarise()}")
