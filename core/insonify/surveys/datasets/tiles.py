"""Tiles of a labelled record: images, masks, and what each shows of every target."""

import math
from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Booleans, Bytes, Dataset, Singles
from insonify.display.normalisation import normalise
from insonify.display.sheet import compute_median_curve
from insonify.io.record_schema import CHANNELS
from insonify.kernels.sweep.bed_stretches import NO_TARGET
from insonify.record.target_truth import DARK
from insonify.scene import SceneError
from insonify.surveys.annotations import EXTENTS
from insonify.surveys.datasets.scenes import DrawnScene
from insonify.surveys.datasets.specification import Evidence, Images, Tiles
from insonify.surveys.storages import Tile
from insonify.tracers.labels import PATHS

SILENT, BED, SHADOW, OTHER, FIRST_CLASS = range(5)  # classes of a mask; the classes of targets follow in order
WHOLE = 0.95  # share of a target's bins in the connected parts of it that make its extent
FAINTEST, BRIGHTEST = -25.0, 20.0  # dB about the bed, beyond which a level counts no further
LEAST_SCATTER = 1.0  # dB, of a bed without speckle: smaller steps of grey are not seen
BESIDE, MARGIN_BINS = 0.25, 6  # of the longer side of a target, and bins at least, in which the bed about it counts


class TargetShown(NamedTuple):
    """A target of a class as one side of a record shows it."""

    number: int  # index in the scene
    box: tuple[int, int, int, int]  # pings and bins of its echo and shadow, ends exclusive
    area: int  # bins of both
    description: dict[str, Any]  # what every tile notes of it


class RecordSide(NamedTuple):
    """One side of a record, (pings, bins) each."""

    level: Singles  # dB about the bed at that range
    mask: Bytes
    echo_id: NDArray[np.int16]
    shadow_id: NDArray[np.int16]
    targets: list[TargetShown]


def relative_levels(record: Dataset) -> Singles:
    """Levels of a record, simulated or recorded, about the median at each range, (sides, pings, bins) in dB."""
    amplitude = normalise(record["intensity"].values.swapaxes(0, 1), compute_median_curve(record))
    with np.errstate(divide="ignore"):
        return np.asarray(20.0 * np.log10(amplitude), np.float32).swapaxes(0, 1)


def grey_levels(levels: Singles, images: Images) -> NDArray[np.unsignedinteger]:
    """Grey levels of an image."""
    white = 2**images.bits - 1
    shares = (levels - images.low) * (white / (images.high - images.low))
    return np.rint(np.clip(shares, 0.0, white)).astype(np.uint8 if images.bits == 8 else np.uint16)


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
    levels = relative_levels(record)
    for channel, side in enumerate(CHANNELS):
        whole, image = take_side(drawn, record, levels[channel], channel, classes), grey_levels(levels[channel], images)
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
                "targets": list(targets_within(whole, window, tiles)),
            }
            yield Tile(image[window], whole.mask[window], description)


def take_side(drawn: DrawnScene, record: Dataset, levels: Singles, channel: int, classes: Sequence[str]) -> RecordSide:
    """Levels, mask and labels of one side; a bin with the direct echo of a target is of no shadow."""
    columns = {name: record[name].values[channel] for name in ("target_id", "path", "shadow", "shadow_id")}
    target_id = columns["target_id"]
    echo_id = np.where((columns["path"] == PATHS.index("direct")) & (target_id >= 0), target_id, NO_TARGET)
    echoes = echo_id >= 0
    shadow_id = np.where((columns["shadow"] >= DARK) & ~echoes, columns["shadow_id"], NO_TARGET)
    mask = np.where(target_id == NO_TARGET, SILENT, BED).astype(np.uint8)
    mask[columns["shadow"] >= DARK] = SHADOW
    numbers = [drawn.classes.get(index) for index in range(len(drawn.scene.targets))]
    rows = [OTHER if name is None else FIRST_CLASS + classes.index(name) for name in numbers]
    mask[echoes] = np.array([*rows, 0], dtype=np.uint8)[echo_id[echoes]]
    side = RecordSide(levels, mask, echo_id.astype(np.int16), shadow_id.astype(np.int16), [])
    side.targets.extend(_find_targets(drawn, record, channel, side))
    return side


def _find_targets(drawn: DrawnScene, record: Dataset, channel: int, side: RecordSide) -> Iterator[TargetShown]:
    """Targets of a class on one side of a record; stray bins become bins of no target."""
    for target, name in drawn.classes.items():
        box = record["target_box"].values[target, channel]
        if box[0] < 0:
            continue
        first, last, near, far = (int(edge) for edge in box)
        window = np.s_[first : last + 1, near : far + 1]
        layers = side.echo_id[window], side.shadow_id[window]  # views
        for layer in layers:
            drop_strays(layer, target)
        both = (layers[0] == target) | (layers[1] == target)
        rows, columns = (np.flatnonzero(both.any(axis=axis)).tolist() for axis in (1, 0))
        extent = first + rows[0], first + rows[-1] + 1, near + columns[0], near + columns[-1] + 1
        length = float(record["shadow_length"].values[target, channel])
        strength = float(record["target_strength"].values[target])
        description = {
            "class": name,
            "target": target,
            "shape": getattr(drawn.scene.targets[target], "path", drawn.scene.targets[target].kind),
            "shadow_length": round(length, 4),
            "target_strength": round(strength, 3) if np.isfinite(strength) else None,
        }
        yield TargetShown(target, extent, int(both.sum()), description)


def drop_strays(layer: NDArray[np.int16], target: int) -> None:
    """Leave to a target, of the bins of a layer, those within the box about its greatest connected parts, in place.

    A bin in which a target is by chance the greatest of faint contributors would else make its box several times as
    large.
    """
    # lazy: only labels need it
    from scipy.ndimage import find_objects, label

    region = layer == target
    parts, count = label(region, np.ones((3, 3)))
    if count < 2:
        return
    sizes = np.bincount(parts.ravel())[1:]
    greatest = np.argsort(-sizes, kind="stable")
    made = np.searchsorted(np.cumsum(sizes[greatest]), WHOLE * sizes.sum()) + 1
    boxes = [find_objects(parts)[part] for part in greatest[:made]]
    window = tuple(
        slice(min(box[axis].start for box in boxes), max(box[axis].stop for box in boxes)) for axis in (0, 1)
    )
    region[window] = False
    layer[region] = NO_TARGET


def targets_within(
    side: RecordSide,
    window: tuple[slice, slice],
    least: Evidence,
    layers: tuple[NDArray[np.int16], NDArray[np.int16]] | None = None,
) -> Iterator[dict[str, Any]]:
    """Annotate the targets that a window shows well enough, by its own bins or by layers of echoes and shadows."""
    rows, columns = window
    for number, (top, bottom, left, right), area, description in side.targets:
        if bottom <= rows.start or top >= rows.stop or right <= columns.start or left >= columns.stop:
            continue
        echo, shadow = side.echo_id[window] == number, side.shadow_id[window] == number
        shown = int((echo | shadow).sum())
        if (
            not shown
            or shown < least.least * area
            or (contrast := _contrast(side, window, echo, shadow)) < least.contrast
        ):
            continue
        if layers is not None:
            echo, shadow = (layer == number for layer in layers)
        regions = dict(zip(EXTENTS, map(describe_region, (echo, shadow, echo | shadow))))
        if regions["both"] is not None:
            yield {**description, "shown": round(shown / area, 4), "contrast": round(contrast, 2), **regions}


def _contrast(side: RecordSide, window: tuple[slice, slice], echo: Booleans, shadow: Booleans) -> float:
    """Mean rise of levels in the echo and fall in the shadow, over the scatter of the bed's levels about both."""
    both = echo | shadow
    rows, columns = np.flatnonzero(both.any(axis=1)), np.flatnonzero(both.any(axis=0))
    border = max(int(BESIDE * max(np.ptp(rows), np.ptp(columns))), MARGIN_BINS)
    about = tuple(
        slice(max(part.start + int(places[0]) - border, 0), part.start + int(places[-1]) + border + 1)
        for part, places in zip(window, (rows, columns))
    )
    beds = [np.clip(side.level[part][side.mask[part] == BED], FAINTEST, BRIGHTEST) for part in (about, np.s_[:, :])]
    bed = next((each for each in beds if each.size), np.zeros(1))
    level = np.clip(side.level[window], FAINTEST, BRIGHTEST) - bed.mean()
    difference = float(level[echo].sum() - level[shadow].sum()) / both.sum()
    return difference / max(float(bed.std()), LEAST_SCATTER)


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
