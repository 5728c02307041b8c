"""Chips of a labelled record: square pictures about targets and of the bed beside."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from insonify.display.sheet import compute_median_curve
from insonify.io.record_schema import CHANNELS
from insonify.surveys.datasets.scenes import DrawnScene, View
from insonify.surveys.datasets.specification import Chips, DatasetSpecification, Picture, Tiles
from insonify.surveys.datasets.tiles import RecordSide, take_side, targets_within
from insonify.surveys.storages import Tile

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
FLOOR = 1e-3  # of the amplitude of the bed, below which a logarithmic picture is black
INK = 255


def cut_chips(drawn: DrawnScene, record: xr.Dataset, specification: DatasetSpecification) -> Iterator[Tile]:
    """Cut a labelled record of a scene into pictures about the views of its targets and, across the tow, of the bed."""
    amplitude = np.sqrt(record["intensity"].values.astype(np.float64))  # (sides, pings, bins)
    curve = np.sqrt(compute_median_curve(record)[:, 0])
    sides: dict[int, RecordSide] = {}
    nothing = np.zeros((amplitude.shape[1:]), np.uint8)
    for number, view in enumerate(drawn.views):
        for place in (view, view._replace(target=None, port=not view.port)):
            channel = CHANNELS.index("port" if place.port else "starboard")
            if channel not in sides:
                sides[channel] = take_side(drawn, record, nothing, channel, specification.classes)
            for copy in range(specification.chips_each):
                path = f"{number}.{CHANNELS[channel]}.{copy}"
                chip = drawn.draws.table(Chips, f"chips.{path}", specification.chips or {})
                picture = drawn.draws.table(Picture, f"picture.{path}", specification.picture)
                tile = _cut(drawn, place, sides[channel], (amplitude[channel], curve), chip, picture)
                shown = [found["target"] for found in tile.told["targets"]]
                if place.target in shown or (place.target is None and not shown):
                    shows = None if place.target is None else drawn.classes.get(place.target)
                    name = f"{drawn.number:07d}-{path.replace('.', '-')}"
                    told = {"name": name, "split": drawn.split, "class": shows, **tile.told}
                    yield Tile(tile.image, tile.mask, told)


def _cut(
    drawn: DrawnScene, view: View, side: RecordSide, echoes: tuple[Floats, Floats], chip: Chips, picture: Picture
) -> Tile:
    """Cut one chip and describe it."""
    amplitude, curve = echoes
    rows, columns = _edges(drawn, view, amplitude.shape, chip, picture)
    shown = _displayed(amplitude / curve**picture.levelled, (rows, columns), chip.pixels, picture)
    image = _finish(_grey(shown, picture), picture)
    middles = (0.5 * (edges[1:] + edges[:-1]) for edges in (rows, columns))
    place = np.ix_(*(np.clip(middle, 0, size - 1).astype(int) for middle, size in zip(middles, amplitude.shape)))
    turned = [np.rot90(layer[place], chip.turns) for layer in (side.mask, side.echo_id, side.shadow_id)]
    layers = [np.rot90(image, chip.turns), *turned]
    if chip.mirrored:
        layers = [layer[:, ::-1] for layer in layers]
    # Of each target the bins that the window covers stand for what is shown.
    pixel = (rows[-1] - rows[0]) * (columns[-1] - columns[0]) / chip.pixels**2
    box = 0, chip.pixels, 0, chip.pixels
    whole = [found._replace(box=box, area=max(round(found.area / pixel), 1)) for found in side.targets]
    cut = RecordSide(layers[0], layers[1], layers[2], layers[3], whole)
    size = Tiles(pings=chip.pixels, bins=chip.pixels, least=chip.least)
    told = {
        "scene": drawn.number,
        "side": "port" if view.port else "starboard",
        "first_ping": int(rows[0]),
        "first_bin": int(columns[0]),
        "shape": [chip.pixels, chip.pixels],
        "targets": list(targets_within(cut, 0, 0, size)),
    }
    return Tile(np.ascontiguousarray(cut.image), np.ascontiguousarray(cut.mask), told)


def _edges(
    drawn: DrawnScene, view: View, shape: tuple[int, ...], chip: Chips, picture: Picture
) -> tuple[Floats, Floats]:
    """Edges of the pixels along and across, in pings and bins of the record, with the window moved inside it."""
    scene, (pings, bins) = drawn.scene, shape
    step, bin_length = scene.track.speed / scene.sonar.ping_rate, scene.sonar.range / bins
    height, extent = scene.altitude, chip.margin * view.length
    first = 0.0 if picture.water_column and not picture.ground_range else height / bin_length
    high, wide = min(extent * chip.aspect / step, float(pings)), min(extent / bin_length, bins - first)
    middle = view.along * (pings - 1) + chip.along * high
    rows = np.clip(middle - 0.5 * high, 0.0, pings - high) + np.linspace(0.0, high, chip.pixels + 1)
    if not picture.ground_range:
        near = math.hypot(view.ground_range, height) / bin_length + (chip.across - 0.5) * wide
        return rows, np.clip(near, first, bins - wide) + np.linspace(0.0, wide, chip.pixels + 1)
    farthest = math.sqrt(max(scene.sonar.range**2 - height**2, 0.0))
    wide = min(extent, farthest)
    near = float(np.clip(view.ground_range + (chip.across - 0.5) * wide, 0.0, farthest - wide))
    return rows, np.hypot(near + np.linspace(0.0, wide, chip.pixels + 1), height) / bin_length


def _displayed(values: Floats, edges: tuple[Floats, Floats], pixels: int, picture: Picture) -> Floats:
    """Mean amplitude of every pixel, of coarser ones first where the picture was averaged along or across."""
    from scipy.ndimage import zoom

    for axis, (edge, coarse) in enumerate(zip(edges, (picture.along, picture.across))):
        count = max(round(pixels / coarse), 8)
        mean = _means(values, np.interp(np.linspace(0.0, pixels, count + 1), np.arange(pixels + 1.0), edge), axis)
        factors = [1.0, 1.0]
        factors[axis] = pixels / count
        values = mean if count == pixels else np.asarray(zoom(mean, factors, order=1, grid_mode=True, mode="nearest"))
    return values


def _means(values: Floats, edges: Floats, axis: int) -> Floats:
    """Means between edges along an axis; narrower than an element they are interpolated linearly."""
    values = np.moveaxis(values, axis, 0)
    total = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
    width = np.maximum(np.diff(edges), 1.0)
    middle = np.clip(0.5 * (edges[1:] + edges[:-1]), 0.5 * width, len(values) - 0.5 * width)

    def below(at: Floats) -> Floats:
        whole = np.clip(np.floor(at).astype(int), 0, len(values) - 1)
        return np.asarray(total[whole] + (at - whole)[:, None] * values[whole])

    return np.moveaxis((below(middle + 0.5 * width) - below(middle - 0.5 * width)) / width[:, None], 0, axis)


def _grey(amplitude: Floats, picture: Picture) -> NDArray[np.uint8]:
    """Grey levels: scaled, stretched between two percentiles, with a median grey, inverted."""
    relative = amplitude / max(float(np.median(amplitude)), 1e-30)
    power = {"linear": 1.0, "root": 0.5, "log": 0.0}[picture.scale]
    values = relative**power if power else np.log(np.maximum(relative, FLOOR))
    black, white = np.percentile(values, [picture.black, picture.white])
    share = np.clip((values - black) / max(white - black, 1e-12), 0.0, 1.0)
    if picture.grey is not None:
        share **= math.log(picture.grey) / math.log(float(np.clip(np.median(share), 0.02, 0.98)))
    return np.rint(255.0 * (1.0 - share if picture.inverted else share)).astype(np.uint8)


def _finish(image: NDArray[np.uint8], picture: Picture) -> NDArray[np.uint8]:
    """Write scale lines and a caption over the picture, and what JPEG leaves of it."""
    from PIL import Image, ImageDraw

    made = Image.fromarray(image)
    if picture.lines:
        draw, (width, height) = ImageDraw.Draw(made), made.size
        for number in range(picture.lines):
            x = (number + 0.5) * width / picture.lines
            draw.line([(x, 0), (x, height)], fill=INK)
        draw.text((3, 3), f"{25 * picture.lines} m", fill=INK)
    if picture.jpeg is not None:
        buffer = io.BytesIO()
        made.save(buffer, "jpeg", quality=picture.jpeg)
        made = Image.open(buffer)
    return np.asarray(made)
