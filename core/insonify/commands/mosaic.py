"""``insonify mosaic``: records on a map, as GeoTIFF or KMZ."""

import argparse
from typing import Any

from insonify.commands.options import add_frequency, add_output, chosen_output, metres, say
from insonify.io.records import RECORDS
from insonify.surveys import ALTITUDES, OVERLAPS


def register(subparsers: Any) -> None:
    """Add ``mosaic``."""
    parser = subparsers.add_parser(
        "mosaic",
        description="Correct records from slant range to ground range, lay them on the map by position and heading, "
        "and write one GeoTIFF or, for Google Earth, its picture as KMZ. Values are decibels relative to the median of "
        "each record at its range, and NaN where nothing was insonified.",
        epilog="example: insonify mosaic line1.xtf line2.xtf -o mosaic.tif --cell 0.25 --overlap nearest",
    )
    parser.add_argument(
        "records", nargs="+", metavar="RECORD", help=f"a record: {RECORDS.describe(RECORDS.readable())}"
    )
    add_output(parser, (".tif", ".tiff", ".kmz"))
    parser.add_argument(
        "--cell", type=metres, metavar="M", help="side of a cell in metres (default: about the distance between pings)"
    )
    parser.add_argument(
        "--overlap",
        choices=OVERLAPS,
        default=OVERLAPS[0],
        help="what counts where records overlap: their mean energy, the last one named, the strongest, the one "
        "nearest in ground range, or the nearest beyond 1.4 altitudes of slant range (default: %(default)s)",
    )
    parser.add_argument(
        "--altitude",
        choices=ALTITUDES,
        default=ALTITUDES[0],
        help="altitude for the slant-range correction; without it a record is bottom-tracked (default: %(default)s)",
    )
    parser.add_argument(
        "--crs", metavar="CRS", help="map of the mosaic, e.g. EPSG:32631 (default: UTM zone of the first record)"
    )
    add_frequency(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read the records and write their mosaic."""
    path = chosen_output(arguments)
    # lazy: the other commands need neither the display nor PROJ
    from insonify.surveys.mosaic import make_mosaic, write_mosaic
    from insonify.surveys.swath import StoredSwaths

    swaths = StoredSwaths(arguments.records, arguments.crs, arguments.altitude, arguments.frequency)
    mosaic = make_mosaic(swaths, arguments.cell, arguments.overlap)
    write_mosaic(path, mosaic, swaths.crs)
    rows, columns = mosaic.level.shape
    say(f"{path}: {columns} x {rows} cells of {mosaic.cell:g} m on {swaths.crs or 'no map'}")
