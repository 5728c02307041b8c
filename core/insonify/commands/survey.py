"""``insonify survey``: a scene along many lines, by its specification."""

import argparse
from pathlib import Path
from typing import Any

from insonify.commands.options import add_specification, say


def register(subparsers: Any) -> None:
    """Add ``survey``."""
    parser = subparsers.add_parser(
        "survey",
        description="Tow over one scene along parallel lines that cover an area, or along given lines, and write a "
        "record for each line, their mosaic (.tif), the coverage (.tif) and a page that sums it up. Finished "
        "lines are not repeated: the same command continues after an interruption.",
        epilog="examples: insonify survey harbour -o harbour; insonify survey my-survey.toml -o survey --scheduler "
        "local:4",
    )
    add_specification(parser, "surveys", "survey")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Simulate the missing lines, then write the files about the whole survey."""
    # lazy: the other commands need none of it
    from insonify.errors import SceneError
    from insonify.io.object_store import folder_at, in_store
    from insonify.scene import load_scene
    from insonify.surveys.engine import work_on
    from insonify.surveys.lines.specification import SurveySpecification
    from insonify.surveys.lines.summary import PAGE, summarise
    from insonify.surveys.lines.work import SurveyWork
    from insonify.surveys.specification import read_specification

    specification = read_specification(arguments.specification, SurveySpecification, "surveys")
    folder = folder_at(arguments.output)
    if in_store(folder):
        raise SceneError(
            f"-o {arguments.output}: the summary reads the records again, which needs a disk; give a folder"
        )
    work = SurveyWork(specification, load_scene(specification.base), folder)
    ended = work_on(work, "survey", arguments.scheduler, "line")
    if ended.done:
        coverage = summarise(work, ended.done)
        share = f"{100.0 * coverage.once:.1f} % of {coverage.area:.4g} m² shown"
        say(f"{arguments.output}: {len(ended.done)} lines, {share}; see {Path(arguments.output) / PAGE}")
    ended.refuse_failures()
