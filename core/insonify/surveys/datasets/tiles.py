"""Tiles of a labelled record: images, masks, and what each shows of every target."""

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Booleans, Bytes, Dataset
from insonify.display.normalisation import normalise
from insonify.display.sheet import compute_median_curve
from insonify.io.record_schema import CHANNELS
from insonify.record.target_truth import DARK
from insonify.scene import SceneError
from insonify.surveys.annotations import EXTENTS
from insonify.surveys.datasets.scenes import DrawnScene
from insonify.surveys.datasets.specification import Images, Tiles
from insonify.surveys.storages import Tile
from insonify.tracers.labels import NOTHING, PATHS

SILENT, BED, SHADOW, OTHER, FIRST_CLASS = range(5)  # classes of a mask; the classes of targets follow in order


class TargetShown(NamedTuple):
    """A target of a class as one side of a record shows it."""

    number: int  # index in the scene
    box: tuple[int, int, int, int]  # pings and bins of its echo and shadow, ends exclusive
    area: int  # bins of both
    description: dict[str, Any]  # what every tile notes of it


class RecordSide(NamedTuple):
    """One side of a record, (pings, bins) each."""

    image: NDArray[np.unsignedinteger]
    mask: Bytes
    echo_id: NDArray[np.int16]
    shadow_id: NDArray[np.int16]
    targets: list[TargetShown]


def grey_levels(record: Dataset, images: Images) -> NDArray[np.unsignedinteger]:
    """Grey levels of a record, simulated or recorded."""
    amplitude = normalise(record["intensity"].values.swapaxes(0, 1), compute_median_curve(record))
    white = 2**images.bits - 1
    with np.errstate(divide="ignore"):
        level = (20.0 * np.log10(amplitude) - images.low) * (white / (images.high - images.low))
    kind = np.uint8 if images.bits == 8 else np.uint16
    return np.rint(np.clip(level, 0.0, white)).astype(kind).swapaxes(0, 1)


def starts(length: int, size: int, overlap: float) -> list[int]:
    """First places of tiles along one side of a record, evenly spaced; the last tile ends with the record."""
    room = length - size
    steps = math.ceil(room / max(1, int(size * (1.0 - overlap))))
    return [room * step // max(steps, 1) for step in range(steps + 1)]


def cut_tiles(
    drawn: DrawnScene, record: Dataset, classes: Sequence[str], tiles: Tiles, images: Images
) -> Iterator[Tile]:
    """Cut a labelled record of a scene into tiles."""
    pings, bins = record.sizes["ping_time"], record.sizes["range_sample"]
    for name, size, length in (("pings", tiles.pings, pings), ("bins", tiles.bins, bins)):
        if size > length:
            raise SceneError(f"tiles.{name}: {size} is more than the {length} {name} of scene {drawn.number}; lower it")
    grey = grey_levels(record, images)
    for channel, side in enumerate(CHANNELS):
        whole = take_side(drawn, record, grey[channel], channel, classes)
        corners = product(starts(pings, tiles.pings, tiles.overlap), starts(bins, tiles.bins, tiles.overlap))
        for ping, first in corners:
            window = np.s_[ping : ping + tiles.pings, first : first + tiles.bins]
            description = {
                "name": f"{drawn.number:07d}-{side}-{ping}-{first}",
                "split": drawn.split,
                "scene": drawn.number,
                "side": side,
                "first_ping": ping,
                "first_bin": first,
                "shape": [tiles.pings, tiles.bins],
                "targets": list(targets_within(whole, ping, first, tiles)),
            }
            yield Tile(whole.image[window], whole.mask[window], description)


def take_side(
    drawn: DrawnScene, record: Dataset, grey: NDArray[np.unsignedinteger], channel: int, classes: Sequence[str]
) -> RecordSide:
    """Image, mask and labels of one side."""
    columns = {name: record[name].values[channel] for name in ("target_id", "path", "shadow", "shadow_id")}
    target_id = columns["target_id"]
    echo_id = np.where((columns["path"] == PATHS.index("direct")) & (target_id >= 0), target_id, NOTHING)
    shadow_id = np.where(columns["shadow"] >= DARK, columns["shadow_id"], NOTHING)
    mask = np.where(target_id == NOTHING, SILENT, BED).astype(np.uint8)
    mask[columns["shadow"] >= DARK] = SHADOW
    numbers = [drawn.classes.get(index) for index in range(len(drawn.scene.targets))]
    rows = [OTHER if name is None else FIRST_CLASS + classes.index(name) for name in numbers]
    echoes = echo_id >= 0
    mask[echoes] = np.array([*rows, 0], dtype=np.uint8)[echo_id[echoes]]
    side = RecordSide(grey, mask, echo_id.astype(np.int16), shadow_id.astype(np.int16), [])
    side.targets.extend(_find_targets(drawn, record, channel, side))
    return side


def _find_targets(drawn: DrawnScene, record: Dataset, channel: int, side: RecordSide) -> Iterator[TargetShown]:
    """Targets of a class on one side of a record."""
    for target, name in drawn.classes.items():
        box = record["target_box"].values[target, channel]
        if box[0] < 0:
            continue
        first, last, near, far = (int(edge) for edge in box)
        window = np.s_[first : last + 1, near : far + 1]
        area = int(((side.echo_id[window] == target) | (side.shadow_id[window] == target)).sum())
        length = float(record["shadow_length"].values[target, channel])
        strength = float(record["target_strength"].values[target])
        description = {
            "class": name,
            "target": target,
            "shape": getattr(drawn.scene.targets[target], "path", drawn.scene.targets[target].kind),
            "shadow_length": round(length, 4),
            "target_strength": round(strength, 3) if np.isfinite(strength) else None,
        }
        yield TargetShown(target, (first, last + 1, near, far + 1), area, description)


def targets_within(side: RecordSide, ping: int, first: int, tiles: Tiles) -> Iterator[dict[str, Any]]:
    """Annotate the targets that a tile shows well enough."""
    window = np.s_[ping : ping + tiles.pings, first : first + tiles.bins]
    for number, (top, bottom, left, right), area, description in side.targets:
        if bottom <= ping or top >= ping + tiles.pings or right <= first or left >= first + tiles.bins:
            continue
        echo, shadow = side.echo_id[window] == number, side.shadow_id[window] == number
        shown = int((echo | shadow).sum())
        if shown and shown >= tiles.least * area:
            regions = dict(zip(EXTENTS, map(describe_region, (echo, shadow, echo | shadow))))
            yield {**description, "shown": round(shown / area, 4), **regions}


def describe_region(region: Booleans) -> dict[str, Any] | None:
    """Box, area and run lengths of a region of a tile; None of an empty one."""
    rows, columns = np.flatnonzero(region.any(axis=1)), np.flatnonzero(region.any(axis=0))
    if not rows.size:
        return None
    x, y = int(columns[0]), int(rows[0])
    return {
        "box": [x, y, int(columns[-1]) - x + 1, int(rows[-1]) - y + 1],
        "area": int(region.sum()),
        "segmentation": {"size": list(region.shape), "counts": run_lengths(region)},
    }


def run_lengths(region: Booleans) -> list[int]:
    """Lengths of runs down the columns of a region, alternately outside and inside, first outside."""
    down = region.ravel(order="F")
    changes = np.flatnonzero(down[1:] != down[:-1]) + 1
    edges = np.concatenate([[0], changes, [down.size]])
    lengths: list[int] = np.diff(edges).tolist()
    return [0, *lengths] if down[0] else lengths
