"""``insonify info``: what is read of measured casts and recorded navigation, and what is left out."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from insonify.commands.options import say
from insonify.io.formats import FormatRegistry
from insonify.io.navigation import NAVIGATION, RecordedNavigation, read_navigation
from insonify.io.sound_speed_casts import CASTS, Cast, read_cast
from insonify.scene import SceneError


def register(subparsers: Any) -> None:
    """Add ``info``."""
    parser = subparsers.add_parser(
        "info",
        description="Describe measured casts and recorded navigation: what is read of each file, which rows are left "
        "out and why, and what is doubtful.",
        epilog="example: insonify info cast.cnv track.gpx",
    )
    parser.add_argument(
        "files",
        nargs="+",
        metavar="FILE",
        help=f"a cast ({', '.join(CASTS.readable())}) or navigation ({', '.join(NAVIGATION.readable())})",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Describe each file."""
    for path in arguments.files:
        found = read_cast_or_navigation(path)
        described = describe_cast(found) if isinstance(found, Cast) else describe_navigation(found)
        say(f"{path}: {described}", *(f"  {remark}" for remark in found.remarks))


def read_cast_or_navigation(path: str) -> Cast | RecordedNavigation:
    """Read a cast, or else navigation; both may be tables."""
    suffix, refusals = Path(path).suffix.lower(), list[SceneError]()
    readers: tuple[tuple[FormatRegistry[Any], Callable[[str], Any]], ...]
    readers = (CASTS, read_cast), (NAVIGATION, read_navigation)
    for registry, read in readers:
        if suffix in (*registry.readable(), *registry.suffixes("converter")):
            try:
                return read(path)
            except SceneError as error:
                refusals.append(error)
    if not refusals:
        known = ", ".join(dict.fromkeys([*CASTS.readable(), *NAVIGATION.readable()]))
        raise SceneError(f"{path}: is no cast or navigation by its suffix; give a file that ends in one of {known}")
    *others, last = map(str, refusals)
    raise SceneError("".join(f"{other.rpartition('; ')[0]}, and " for other in others) + last)


def describe_cast(cast: Cast) -> str:
    """Depths and values of a cast, in words."""
    values = {
        "sound speed": (cast.sound_speed, " m/s"),
        "temperature": (cast.temperature, " °C"),
        "salinity": (cast.salinity, ""),
    }
    spans = [
        f"{name} {column.min():.6g} to {column.max():.6g}{unit}"
        for name, (column, unit) in values.items()
        if column is not None
    ]
    depths = f"{cast.depth.size} depths from {cast.depth[0]:.4g} to {cast.depth[-1]:.6g} m"
    return f"measured cast, {depths}, {', '.join(spans)}"


def describe_navigation(tow: RecordedNavigation) -> str:
    """Rows, duration and columns of navigation, in words."""
    what = f"recorded navigation, {tow.time.size} rows in {tow.time[-1]:.6g} s with {', '.join(tow.columns)}"
    if "x" not in tow.columns:
        return what
    length = float(np.hypot(np.diff(tow.columns["x"]), np.diff(tow.columns["y"])).sum())
    return f"{what}; {length:.4g} m at {length / tow.time[-1]:.3g} m/s on average"
