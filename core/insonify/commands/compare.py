"""``insonify compare``: two records side by side, recorded or simulated."""

import argparse
from typing import Any

from insonify.arrays import Dataset
from insonify.commands.options import add_frequency, add_output, chosen_output, is_record, say
from insonify.io.records import RECORDS, read_record
from insonify.progress import report_waiting
from insonify.scene import load_scene


def register(subparsers: Any) -> None:
    """Add ``compare``."""
    parser = subparsers.add_parser(
        "compare",
        description="Draw two records to one scale, each relative to its own median. Compare the variation of "
        "amplitudes in even patches, the histograms, the spectra along and across the track, and the depth of shadows.",
    )
    parser.add_argument(
        "records",
        nargs=2,
        metavar="RECORD",
        help=f"a record: {RECORDS.describe(RECORDS.readable())}; or a scene, which is simulated: a name or a TOML file",
    )
    add_frequency(parser)
    add_output(parser, (".png",))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read or simulate two records and write the page that compares them."""
    path = chosen_output(arguments)
    first, second = (_record(name, arguments.frequency) for name in arguments.records)
    # lazy: the other commands need neither Matplotlib nor the kernels
    from insonify.accuracy.comparison_page import write_comparison

    for name, found in zip(arguments.records, write_comparison(path, (first, second))):
        say(f"{name}: {'; '.join(found.lines())}")
    say(str(path))


def _record(name: str, frequency: float | None) -> Dataset:
    """Read a record, of one frequency where it can hold several, or simulate a scene."""
    if is_record(name):
        return read_record(name, frequency if "frequency" in RECORDS.selects(name) else None)
    # lazy: the other commands need neither Matplotlib nor the kernels
    from insonify.simulation import simulate

    with report_waiting(f"simulating {name}"):
        return simulate(load_scene(name))
