"""Summary of a survey: mosaic and coverage as files and pictures, and one page that contains all of it."""

import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.display.picture import load_palette
from insonify.io.atomic import write_text
from insonify.io.geotiff import write_geotiff
from insonify.io.pages import fill_page, picture_url
from insonify.surveys.engine import read_flag
from insonify.surveys.lines.work import SurveyWork
from insonify.surveys.mosaic import KMZ, PALETTE, PICTURED, Mosaic, make_mosaic, write_mosaic
from insonify.surveys.swath import StoredSwaths

PAGE = "index.html"
FIGURE_WIDTH, HIGHEST = 11.0, 9.0  # inches
DPI = 110
COUNTS = ("#ffffff", "#8fc1c9", "#1f7a8c", "#0d3b46")  # none, one, two, more lines


class Coverage(NamedTuple):
    """Area that a survey covers."""

    area: float  # m², as specified; the covered area where none is specified
    once: float  # shares of it that at least one line, and at least two lines, cover
    twice: float


def measure_coverage(mosaic: Mosaic, corners: Floats | None) -> Coverage:
    """Measure the share of an area that the lines of a survey cover."""
    square = mosaic.cell**2
    if corners is None:
        area = float((mosaic.count > 0).sum()) * square
        count = mosaic.count
    else:
        # lazy: slow to import
        from skimage.draw import polygon2mask

        (x, y), (left, top) = corners.T, mosaic.corner
        area = 0.5 * abs(float(x @ np.roll(y, 1) - y @ np.roll(x, 1)))
        # The cells with their centres within the area, by rows and columns.
        outline = np.stack([(top - y) / mosaic.cell - 0.5, (x - left) / mosaic.cell - 0.5], axis=1)
        count = mosaic.count[polygon2mask(mosaic.count.shape, outline)]  # type: ignore[no-untyped-call]
    shares = [min(float((count >= lines).sum()) * square / area, 1.0) for lines in (1, 2)]
    return Coverage(area, *shares)


def summarise(work: SurveyWork, names: Iterable[str]) -> Coverage:
    """Write the mosaic, the coverage and the page of a survey."""
    lines = [read_flag(work.folder, name) for name in names]
    swaths = StoredSwaths([str(work.folder / line["file"]) for line in lines])
    wanted, area = work.specification.mosaic, work.specification.area
    mosaic = make_mosaic(swaths, wanted.cell, wanted.overlap)
    corners = None if area is None else swaths.on_map(area.corners)
    coverage = measure_coverage(mosaic, corners)
    for name in ("mosaic.tif", f"mosaic{KMZ}") if swaths.crs else ("mosaic.tif",):
        write_mosaic(work.folder / name, mosaic, swaths.crs)
    count, band = mosaic.count.astype(np.float32), "lines that show the cell"
    write_geotiff(work.folder / "coverage.tif", count, mosaic.corner, mosaic.cell, swaths.crs, band=band, unit="1")
    tracks = [swaths.on_map([line["start"], line["end"]]) for line in lines]
    pictures = [_draw(mosaic, tracks, corners, paint) for paint in (_paint_mosaic, _paint_coverage)]
    write_text(work.folder / PAGE, _page(work, lines, coverage, mosaic, pictures))
    return coverage


def _draw(
    mosaic: Mosaic,
    tracks: Sequence[Floats],
    corners: Floats | None,
    paint: Callable[[Any, Mosaic, tuple[float, ...]], None],
) -> bytes:
    """Draw the mosaic or the coverage, with the lines and the area, as PNG."""
    # lazy: slow to import
    from insonify.display.style import make_figure

    rows, columns = mosaic.level.shape
    left, top = mosaic.corner
    figure = make_figure(FIGURE_WIDTH, min(max(FIGURE_WIDTH * rows / columns, 3.0), HIGHEST), layout="constrained")
    axes = figure.subplots()
    paint(axes, mosaic, (left, left + columns * mosaic.cell, top - rows * mosaic.cell, top))
    for track in tracks:
        axes.annotate("", track[1], track[0], arrowprops={"arrowstyle": "-|>", "color": "#d1495b", "lw": 0.8})
    if corners is not None:
        axes.plot(*np.concatenate([corners, corners[:1]]).T, color="#1f7a8c", lw=1.2, ls="--")
    axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DPI)
    return buffer.getvalue()


def _paint_mosaic(axes: Any, mosaic: Mosaic, extent: tuple[float, ...]) -> None:
    """Paint the levels."""
    from matplotlib.colors import ListedColormap

    palette = ListedColormap(load_palette(PALETTE) / 255.0).with_extremes(bad="white")
    low, high = np.nanpercentile(mosaic.level, PICTURED)
    shown = axes.imshow(mosaic.level, cmap=palette, vmin=low, vmax=high, extent=extent, interpolation="antialiased")
    axes.figure.colorbar(shown, label="dB about the median at that range", shrink=0.8)


def _paint_coverage(axes: Any, mosaic: Mosaic, extent: tuple[float, ...]) -> None:
    """Paint the numbers of lines."""
    from matplotlib.colors import ListedColormap

    counts = np.minimum(mosaic.count, len(COUNTS) - 1)
    shown = axes.imshow(
        counts, cmap=ListedColormap(COUNTS), vmin=-0.5, vmax=3.5, extent=extent, interpolation="nearest"
    )
    bar = axes.figure.colorbar(shown, ticks=range(len(COUNTS)), label="lines that show the cell", shrink=0.8)
    bar.ax.set_yticklabels(["0", "1", "2", "3 or more"])


def _page(
    work: SurveyWork, lines: Sequence[Mapping[str, Any]], coverage: Coverage, mosaic: Mosaic, pictures: Sequence[bytes]
) -> str:
    """Return a page that needs no other file."""
    import tomli_w

    declared = tomli_w.dumps(work.specification.model_dump(mode="json", exclude_unset=True))
    rate, speed = work.scene.sonar.ping_rate, work.scene.track.speed
    pings = sum(line["pings"] for line in lines)
    track = sum(line["length"] + math.pi * abs(line["turn"]) for line in lines)
    facts = (
        f"{len(lines)} of {len(work.lines)} lines, {track / 1000.0:.3g} km, {pings} pings, {pings / rate / 60.0:.3g} "
        f"minutes at {speed:g} m/s. {100.0 * coverage.once:.1f} % of {coverage.area:.6g} m² are shown at least once, "
        f"{100.0 * coverage.twice:.1f} % at least twice, in cells of {mosaic.cell:g} m."
    )
    shown = dict(zip(("Mosaic", "Coverage"), map(picture_url, pictures)))
    about = {"specification": work.specification, "declared": declared, "facts": facts}
    return fill_page("survey", **about, pictures=shown, lines=lines)
