"""Chips of a labelled record: pictures about targets and of the bed beside."""

import io
import math
from collections.abc import Iterator

import numpy as np

from insonify.arrays import Bytes, Dataset, Floats
from insonify.display.sheet import compute_median_curve
from insonify.io.record_schema import CHANNELS
from insonify.surveys.datasets.scenes import DrawnScene, View
from insonify.surveys.datasets.specification import Chips, DatasetSpecification, Picture
from insonify.surveys.datasets.tiles import RecordSide, take_side, targets_within
from insonify.surveys.storages import Tile

SATURATED = 0.4  # slope of grey over amplitude where the red of a bronze palette has saturated, over that below
FLOOR = 1e-3  # of the amplitude of the bed, below which a logarithmic picture is black
INK = 255
SCALE_STEPS = np.array([0.5, 1.0, 2.0, 5.0])  # of scale lines, times a power of ten
LEAST = 0.25  # of a target's length, which windows about its extent span at least
PAST_NADIR = 1.08  # slant range in altitudes, at which pictures without the water column begin
NARROWEST = 16  # pixels of a picture
PAST = 2  # pings and bins past a window; its outermost pixels take parts of them


def cut_chips(drawn: DrawnScene, record: Dataset, specification: DatasetSpecification) -> Iterator[Tile]:
    """Cut a labelled record of a scene into pictures about the views of its targets and, across the tow, of the bed."""
    amplitude = np.sqrt(record["intensity"].values.astype(np.float64))  # (sides, pings, bins)
    curve = np.sqrt(compute_median_curve(record)[:, 0])
    with np.errstate(divide="ignore"):
        levels = (20.0 * np.log10(amplitude / curve)).astype(np.float32)
    sides = [take_side(drawn, record, levels[side], side, specification.classes) for side in range(len(CHANNELS))]
    for number, view in enumerate(drawn.views):
        extent = next((one.box for one in sides[view.channel].targets if one.number == view.target), None)
        for place in (view, view._replace(target=None, channel=1 - view.channel)):
            side = CHANNELS[place.channel]
            for copy in range(specification.chips_each):
                path = f"{number}.{side}.{copy}"
                chip = drawn.draws.table(Chips, f"chips.{path}", specification.chips or {})
                picture = drawn.draws.table(Picture, f"picture.{path}", specification.picture)
                edges = _edges(drawn, place, amplitude.shape[1:], chip, picture, extent)
                across = _distances(drawn, edges[1], picture)
                tile = _cut(sides[place.channel], (amplitude[place.channel], curve), edges, across, chip, picture)
                shown = [found["target"] for found in tile.description["targets"]]
                if place.target in shown or (place.target is None and not shown):
                    shows = None if place.target is None else drawn.classes.get(place.target)
                    name = f"{drawn.number:07d}-{path.replace('.', '-')}"
                    drawing = {"name": name, "split": drawn.split, "class": shows, "scene": drawn.number, "side": side}
                    yield Tile(tile.image, tile.mask, drawing | tile.description)


def _cut(
    side: RecordSide,
    echoes: tuple[Floats, Floats],
    edges: tuple[Floats, Floats],
    across: Floats,
    chip: Chips,
    picture: Picture,
) -> Tile:
    """Cut one chip and describe what it shows."""
    (amplitude, curve), (rows, columns) = echoes, edges
    # Sums up to the ends of the window are those of the whole record, bit by bit.
    reached = tuple(slice(math.ceil(edge[-1]) + PAST) for edge in edges)
    shown = _displayed(amplitude[reached] / curve[reached] ** picture.levelled, edges, picture)
    image = _finish(_grey(shown, picture), picture, float(across[0]), float(across[-1]))
    middles = (0.5 * (edge[1:] + edge[:-1]) for edge in edges)
    place = np.ix_(*(np.clip(middle, 0, size - 1).astype(int) for middle, size in zip(middles, amplitude.shape)))
    turned = [np.rot90(layer[place], chip.turns) for layer in (side.mask, side.echo_id, side.shadow_id)]
    layers = [np.rot90(image, chip.turns), *turned]
    if chip.mirrored:
        layers = [layer[:, ::-1] for layer in layers]
    # Pixels may be coarser or finer than bins; the share of a target within the window is one of bins.
    window = slice(int(rows[0]), math.ceil(rows[-1])), slice(int(columns[0]), math.ceil(columns[-1]))
    description = {
        "first_ping": window[0].start,
        "first_bin": window[1].start,
        "shape": list(layers[0].shape),
        "targets": list(targets_within(side, window, chip, (layers[2], layers[3]))),
    }
    return Tile(np.ascontiguousarray(layers[0]), np.ascontiguousarray(layers[1]), description)


def _distances(drawn: DrawnScene, bins: Floats, picture: Picture) -> Floats:
    """Distances across on the display, in metres, of places in range bins."""
    slants = drawn.scene.sonar.range / drawn.scene.sonar.bins * np.asarray(bins, float)
    return np.sqrt(np.maximum(slants**2 - drawn.scene.altitude**2, 0.0)) if picture.ground_range else slants


def _edges(
    drawn: DrawnScene,
    view: View,
    shape: tuple[int, ...],
    chip: Chips,
    picture: Picture,
    extent: tuple[int, int, int, int] | None,
) -> tuple[Floats, Floats]:
    """Edges of the pixels along and across, in pings and bins of the record, with the window moved inside it."""
    scene, (pings, bins) = drawn.scene, shape
    step, bin_length, height = scene.track.speed / scene.sonar.ping_rate, scene.sonar.range / bins, scene.altitude

    along = view.along * (pings - 1) * step
    across = float(_distances(drawn, np.hypot(view.ground_range, height) / bin_length, picture))
    high, wide = chip.margin * chip.aspect * view.length, chip.margin * view.length
    if chip.about == "extent" and extent is not None:
        first, last = step * extent[0], step * extent[1]
        near, far = _distances(drawn, np.array(extent[2:]), picture)
        along, across = 0.5 * (first + last), 0.5 * float(near + far)
        border = (chip.margin - 1.0) * max(last - first, float(far - near))  # of one breadth all around
        high, wide = (max(size + border, LEAST * view.length) for size in (last - first, float(far - near)))
    # Without its water column a picture begins where the first returns of all pings have arrived.
    begin = (
        0.0 if picture.water_column else float(_distances(drawn, np.array(PAST_NADIR * height / bin_length), picture))
    )
    end = float(_distances(drawn, np.array(bins), picture))
    high, wide = min(high, pings * step), min(wide, end - begin)
    sizes = np.array([high / chip.aspect, wide]) if chip.about == "extent" else np.ones(2)
    counts = np.maximum(np.rint(chip.pixels * sizes / sizes.max()), NARROWEST).astype(int)
    low = float(np.clip(along + (chip.along - 0.5) * high, 0.0, pings * step - high))
    near = float(np.clip(across + (chip.across - 0.5) * wide, begin, end - wide))
    columns = np.linspace(near, near + wide, counts[1] + 1)
    slants = np.hypot(columns, height) if picture.ground_range else columns
    return np.linspace(low, low + high, counts[0] + 1) / step, slants / bin_length


def _displayed(values: Floats, edges: tuple[Floats, Floats], picture: Picture) -> Floats:
    """Mean amplitude of every pixel, of coarser ones first where the picture was averaged along or across."""
    from scipy.ndimage import zoom

    for axis, (edge, coarse) in enumerate(zip(edges, (picture.along, picture.across))):
        pixels = len(edge) - 1
        count = max(round(pixels / coarse), 8)
        edge = np.interp(np.linspace(0.0, pixels, count + 1), np.arange(pixels + 1.0), edge)
        if picture.samples == "nearest":
            middles = 0.5 * (edge[1:] + edge[:-1])[((np.arange(pixels) + 0.5) * count / pixels).astype(int)]
            values = values.take(np.clip(middles, 0, values.shape[axis] - 1).astype(int), axis)
            continue
        values = _means(values, edge, axis)
        if count < pixels:
            factors = [1.0, 1.0]
            factors[axis] = pixels / count
            values = np.asarray(zoom(values, factors, order=1, grid_mode=True, mode="nearest"))
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


def _grey(amplitude: Floats, picture: Picture) -> Bytes:
    """Grey levels: scaled, stretched between two percentiles, with a median grey, inverted."""
    relative = amplitude / max(float(np.median(amplitude)), 1e-30)
    power = {"linear": 1.0, "root": 0.5, "log": 0.0}[picture.scale]
    values = relative**power if power else np.log(np.maximum(relative, FLOOR))
    black, white = np.percentile(values, [picture.black, picture.white])
    share = np.maximum((values - black) / max(white - black, 1e-12), 0.0)
    if picture.grey is not None and picture.tone == "gain":
        share *= picture.grey / max(float(np.median(share)), 0.02)
    elif picture.grey is not None:
        share = np.minimum(share, 1.0)
        share **= math.log(picture.grey) / math.log(float(np.clip(np.median(share), 0.02, 0.98)))
    share = np.minimum(np.where(share > picture.knee, picture.knee + SATURATED * (share - picture.knee), share), 1.0)
    share = picture.darkest + (picture.brightest - picture.darkest) * share
    return np.rint(255.0 * (1.0 - share if picture.inverted else share)).astype(np.uint8)


def _finish(image: Bytes, picture: Picture, near: float, far: float) -> Bytes:
    """Draw scale lines and their spacing over a picture that spans two distances in metres, and compress by JPEG."""
    from PIL import Image, ImageDraw

    made = Image.fromarray(image)
    if picture.lines:
        draw, (width, height) = ImageDraw.Draw(made), made.size
        widest = (far - near) / picture.lines
        spacing = max(step for step in SCALE_STEPS * 10.0 ** math.floor(math.log10(widest)) if step <= widest)
        for number in range(math.ceil(near / spacing), math.floor(far / spacing) + 1):
            x = (number * spacing - near) / (far - near) * width
            draw.line([(x, 0), (x, height)], fill=INK)
        draw.text((3, 3), f"{spacing:g} m", fill=INK)
    if picture.jpeg is not None:
        buffer = io.BytesIO()
        made.save(buffer, "jpeg", quality=picture.jpeg)
        made = Image.open(buffer)
    return np.asarray(made)
