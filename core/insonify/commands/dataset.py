"""``insonify dataset``: a labelled data set by its specification."""

import argparse
from itertools import islice
from typing import Any

from insonify.commands.options import add_specification, say

PREVIEWED = 1  # images of each scene on a preview


def register(subparsers: Any) -> None:
    """Add ``dataset``."""
    parser = subparsers.add_parser(
        "dataset",
        description="Draw scenes, simulate them, and cut their records into images with masks and annotations. "
        "Finished jobs are not repeated: the same command continues after an interruption, or adds scenes.",
        epilog="examples: insonify dataset mines -o mines --scheduler local:4; insonify dataset mines -o few --scenes "
        "8; insonify dataset wrecks --preview 24 -o sheet.png",
    )
    add_specification(parser, "datasets", "data set")
    parser.add_argument("--scenes", metavar="N", help="number of scenes, in place of the number in the specification")
    parser.add_argument(
        "--preview", type=int, metavar="N", help="write only a contact sheet of the first N scenes: OUTPUT is a PNG"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Do the missing jobs, then write the files about the whole data set."""
    # lazy: the other commands need none of it
    from insonify.io.atomic import replacing
    from insonify.io.object_store import folder_at
    from insonify.scene import load_scene
    from insonify.surveys.datasets.assembly import assemble, draw_sheet
    from insonify.surveys.datasets.scenes import check_draws, draw_scene
    from insonify.surveys.datasets.specification import DatasetSpecification
    from insonify.surveys.datasets.work import DatasetWork
    from insonify.surveys.engine import work_on
    from insonify.surveys.specification import read_specification

    changes = {} if arguments.scenes is None else {"scenes": arguments.scenes}
    specification = read_specification(arguments.specification, DatasetSpecification, "datasets", **changes)
    work = DatasetWork(specification, load_scene(specification.base), folder_at(arguments.output))
    check_draws(specification, work.base)
    if arguments.preview is not None:
        drawn = (draw_scene(specification, work.base, number) for number in range(arguments.preview))
        tiles = [tile for scene in drawn for tile in islice(work.cut(scene), PREVIEWED)]
        with replacing(work.folder) as beside:
            draw_sheet(beside, [(tile.image, tile.description) for tile in tiles])
        say(f"{arguments.output}: {len(tiles)} images of {arguments.preview} scenes")
        return
    ended = work_on(work, "data set", arguments.scheduler)
    totals = assemble(specification, work.folder, ended.done)
    counts = ", ".join(f"{totals.tiles[split]} {split}" for split in specification.splits)
    scenes = len(ended.done) * specification.storage.scenes
    images, targets = totals.tiles.total(), totals.targets.total()
    say(f"{arguments.output}: {scenes} scenes, {images} images ({counts}), {targets} targets")
    ended.refuse_failures()
