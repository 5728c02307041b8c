"""``insonify exercise``: make an exercise of a survey, or mark what was found."""

import argparse
from pathlib import Path
from typing import Any

from insonify.commands import options
from insonify.files import bundled_specifications
from insonify.io.sealed import SUFFIX


def register(subparsers: Any) -> None:
    """Add ``exercise``."""
    parser = subparsers.add_parser(
        "exercise",
        description="Make an exercise: an area with targets, fish, a current and noise that a seed draws, the truth "
        "sealed in its file. It stands in place of a scene for insonify tow, survey and view. Or mark the contacts "
        "that a student hands in.",
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    example = "Example: insonify exercise make harbour-search --seed 7 -o search.exercise"
    about = f"Draw an exercise from a specification and write it with its truth sealed. {example}"
    make = actions.add_parser("make", help="draw an exercise", description=about)
    names = ", ".join(bundled_specifications("exercises"))
    make.add_argument("specification", metavar="SPEC", help=f"a TOML file, or a bundled specification: {names}")
    make.add_argument("--seed", type=int, metavar="N", help="seed of what is drawn (default: the specification's)")
    options.add_output(make, (SUFFIX,))
    make.set_defaults(run=run_make)
    example = "Example: insonify exercise mark search.exercise contacts.geojson --record survey.xtf"
    about = f"Compare contacts with the truth; with records also the coverage and the time are marked. {example}"
    mark = actions.add_parser("mark", help="mark contacts", description=about)
    mark.add_argument("exercise", metavar="EXERCISE", help=f"a file that ends in {SUFFIX}")
    mark.add_argument("contacts", metavar="CONTACTS", help="contacts of any program, with their places: .csv, .geojson")
    options.add_many(mark, "--record", "FILE", "a record of the survey")
    mark.set_defaults(run=run_mark)


def run_make(arguments: argparse.Namespace) -> None:
    """Draw an exercise and write its file."""
    path = options.chosen_output(arguments)
    from insonify.exercises.exercise import make_exercise, write_exercise  # lazy: no other command needs it

    content = make_exercise(arguments.specification, arguments.seed)
    write_exercise(path, content)
    options.say(f"{path}: {content['title']}, {content['minutes']:g} minutes", content["task"].strip())


def run_mark(arguments: argparse.Namespace) -> None:
    """Print marks."""
    # lazy: no other command needs it
    from insonify.exercises.exercise import read_exercise
    from insonify.exercises.marking import describe_marks, mark_contacts, read_found, read_track

    exercise = read_exercise(arguments.exercise)
    contacts = read_found(exercise, Path(arguments.contacts))
    tracks = [read_track(exercise, name) for name in arguments.record]
    options.say(*describe_marks(exercise, mark_contacts(exercise, contacts, tracks)))
