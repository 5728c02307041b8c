"""Small valid files of every format that is read, with the command that reads them.

`python -m fuzz.samples FOLDER NAME...` writes each to a folder of its name. Libraries are imported where they write:
who only damages files does not hold them.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

from fuzz.mutations import (
    Mutation,
    mutate_bytes,
    mutate_glb,
    mutate_json,
    mutate_npy,
    mutate_png,
    mutate_scene,
    mutate_text,
    mutate_zip,
)


class Sample(NamedTuple):
    """A format under test."""

    file: str  # name of the file that is mutated, in the folder that is given where it has one
    write: Callable[[Path], object]  # writes a valid file
    mutate: Mutation
    scene: str = ""  # TOML of the scene that names the file; empty: the file itself is given
    commands: tuple[tuple[str, ...], ...] = (("render", "{input}", "-o", "{out}.npz"),)  # first: nearly always
    share: float = 1.0  # of the usual number of cases, for slow commands


SMALL = """
[sonar]
bins = 40
range = 30.0
[track]
pings = 3
altitude = 5.0
"""
BED = '[seabed]\ndepth = 30.0\nspacing = 1.0\nrelief = {{ kind = "dem", path = "{file}" }}\n' + SMALL
TARGET = SMALL + '[[targets]]\nkind = "mesh"\nposition = [1.0, 5.0]\npath = "{file}"\n'
CAST = SMALL + '[water]\nkind = "cast"\npath = "{file}"\n'
TOW = SMALL + 'motion = {{ kind = "recorded", path = "{file}" }}\n'
PICTURE = (
    '[seabed]\nmaterial = {{ kind = "image", path = "{file}", of = ["medium_sand", "rock", "silt"], width = 20.0 }}\n'
    + SMALL
)
BACKSCATTER = (
    "[world]\norigin = [100.0, 200.0]\n[seabed]\nspacing = 1.0\n"
    'material = {{ kind = "backscatter", path = "{file}", of = ["medium_sand", "rock"] }}\n' + SMALL
)
CORRELATION = (
    '[seabed]\nrelief = {{ kind = "autocorrelation", rms = 0.02, period = 25.6, '
    'function = {{ kind = "file", path = "{file}" }} }}\n' + SMALL
)
RECORD = (
    ("render", "{input}", "-o", "{out}.npz"),
    ("render", "{input}", "-o", "{out}.png"),
)
COMPARED = (("compare", "{input}", "{valid}", "-o", "{out}.png"),)
MAPPED = (("mosaic", "{input}", "-o", "{out}.tif"),)
SHORT = ("--set", "track.pings=3", "--set", "sonar.bins=40")
SCENES = (("render", "{input}", *SHORT, "-o", "{out}.npz"), ("plan", "{input}", *SHORT))
HEIGHTS = np.round(-30.0 + np.sin(np.arange(48.0)).reshape(6, 8), 3)


def _record(path: Path, pings: int = 6, bins: int = 60) -> None:
    from insonify.io.records import write_record
    from insonify.scene import edit, load_scene
    from insonify.simulation import simulate

    scene = edit(load_scene("pipe-span"), {"track.pings": pings, "sonar.bins": bins})
    write_record(path, [simulate(scene)])


def _zarr(path: Path) -> None:
    _record(next(parent for parent in path.parents if parent.suffix == ".zarr"))


def _classic_record(path: Path) -> None:
    """A record in netCDF-3, which other programs write."""
    import netCDF4

    _record(path)
    with (
        netCDF4.Dataset(path) as made,
        netCDF4.Dataset(path.with_suffix(".3"), "w", format="NETCDF3_64BIT_DATA") as file,
    ):
        for name, dimension in made.dimensions.items():
            file.createDimension(name, dimension.size)
        for name, variable in made.variables.items():
            if variable.dtype is not str:
                file.createVariable(name, variable.dtype, variable.dimensions)[...] = variable[...]
    path.with_suffix(".3").replace(path)


def _tiff(path: Path, **options: object) -> None:
    from bathymetry_files import UTM, write_tiff

    write_tiff(path, HEIGHTS, **{"pixel": (1.0, 1.0), "corner": (5e5, 6e6), **UTM, **options})


def _mesh(path: Path) -> None:
    import trimesh

    body = trimesh.creation.icosphere(subdivisions=1)
    if path.suffix == ".gltf":
        for name, content in trimesh.Scene(body).export(file_type="gltf", merge_buffers=True).items():
            path.with_name(path.name if name.endswith(".gltf") else name).write_bytes(content)
    else:
        body.export(path)


def _scene_gltf(path: Path) -> None:
    """Several nodes with transforms, which may come to refer to one another."""
    import trimesh

    scene = trimesh.Scene()
    for k in range(3):
        move = np.eye(4)
        move[0, 3] = 3.0 * k
        scene.add_geometry(trimesh.creation.box(), transform=move)
    scene.export(path)


def _picture(path: Path) -> None:
    levels = (np.arange(256) % 256).astype(np.uint8).reshape(16, 16)
    Image.fromarray(levels).save(path)


def _palette(path: Path) -> None:
    picture = Image.fromarray((np.arange(256) % 3).astype(np.uint8).reshape(16, 16), mode="P")
    picture.putpalette([0, 0, 0, 128, 128, 128, 255, 255, 255])
    picture.save(path)


def _bytes(content: str | bytes) -> Callable[[Path], object]:
    return lambda path: path.write_bytes(content.encode() if isinstance(content, str) else content)


def _jsf(path: Path) -> None:
    from jsf_files import write_jsf

    echoes = np.random.default_rng(1).integers(1, 4000, (6, 50))
    write_jsf(path, [{"samples": [row, row], "altitude": 5000, "y": 6 * k} for k, row in enumerate(echoes)])


def _xtf(path: Path, pings: int = 6, bins: int = 50) -> None:
    from xtf_files import write_xtf

    echoes = np.random.default_rng(1).integers(1, 4000, (pings, bins))
    told = {"SensorPrimaryAltitude": 5.0}
    write_xtf(path, [{"samples": [row, row], "SensorYcoordinate": 1e-5 * k} | told for k, row in enumerate(echoes)])


ROWS = [(0.5 * k, 1480.0 + 10.0 * np.exp(-k / 9.0), 12.0 - 0.1 * k) for k in range(1, 70)]
SEABIRD = (
    "* Sea-Bird SBE19plus  Data File:\n# nquan = 3\n# name 0 = depSM: Depth\n# name 1 = t090C: T\n"
    "# name 2 = sal00: S\n# bad_flag = -9.990e-29\n*END*\n"
    + "".join(f"{depth:11.4f}{12 - 0.05 * depth:11.4f}{35.0:11.4f}\n" for depth, *_ in ROWS)
)
TABLE = "depth,sound_speed\n" + "".join(f"{depth},{speed:.2f}\n" for depth, speed, _ in ROWS)
PROFILE = "( SoundVelocity  1.0 0 201203212242 )\n" + "".join(f"{depth} {speed:.2f}\n" for depth, speed, _ in ROWS)
NAVIGATION = "time,x,y,depth,heading,pitch,roll\n" + "".join(
    f"{k},{2 * k},{0.1 * k},25,{k % 3},{0.2 * k},0\n" for k in range(8)
)
GPX = '<?xml version="1.0"?>\n<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>\n' + "".join(
    f'<trkpt lat="{48.0 + 1e-5 * k}" lon="-68.0"><time>2024-05-01T12:00:{k:02d}Z</time></trkpt>\n' for k in range(8)
)
GPX += "</trkseg></trk></gpx>\n"
VALEPORT = (
    "[HEADER]\nInstrument=SWIFT\n[DATA]\nDate/Time\tDepth\tPressure\tSound Velocity\n\tm\tdBar\tMs-1\n"
    + "".join(
        f"2019/03/12 15:58:{k:02d}.000\t{depth}\t{depth}\t{speed:.2f}\n" for k, (depth, speed, _) in enumerate(ROWS)
    )
)
AML = "[MeasurementMetadata]\nColumns=Date,Time,SV,Pressure\n[MeasurementData]\n" + "".join(
    f"2020-06-23,00:07:{k:02d}.09,{speed:.2f},{depth}\n" for k, (depth, speed, _) in enumerate(ROWS)
)
ASCII = "ncols 8\nnrows 6\nxllcorner 100\nyllcorner 200\ncellsize 2\nNODATA_value -9999\n" + "".join(
    " ".join(map(str, row)) + "\n" for row in HEIGHTS
)
LAGS = "lag,autocorrelation\n" + "".join(f"{0.2 * k:.1f},{np.exp(-0.5 * k):.4f}\n" for k in range(20))
SCENE = """
title = "Fuzzed"
seed = 3
[seabed]
depth = 30.0
spacing = 0.2
material = { kind = "patches", of = [{ name = "medium_sand", diffuse = 0.3 }, "rock"], size = 4.0 }
relief = { kind = "sum", of = [
  { kind = "fractal", beta = 1.4, rms = 0.03, period = 25.6, peaks = [[8.0, 4.0]] },
  { kind = "ripples", period = 25.6, wavelength = 1.5, height = 0.1, heading = 20.0 } ] }
[[targets]]
kind = "pipe"
position = [2.0, 8.0]
length = 6.0
radius = 0.3
gap = [[-3.0, 0.0], [0.0, 0.5], [3.0, 0.0]]
[[targets]]
kind = "box"
position = [1.0, -6.0]
size = [1.0, 2.0, 1.0]
[water]
kind = "profile"
depth = [0.0, 10.0, 30.0]
sound_speed = [1500.0, 1495.0, 1490.0]
absorption = "francois_garrison"
surface = "none"
[sonar]
frequency = 400e3
beam = { kind = "gaussian", width = 1.5 }
pulse = { kind = "chirp", duration = 2e-4, bandwidth = 5e4 }
range = 30.0
bins = 40
ping_rate = 8.0
[track]
altitude = 6.0
speed = 1.5
pings = 3
motion = { kind = "yaw", amplitude = 1.0, period = 6.0 }
[receiver]
speckle = "rayleigh"
"""
SAMPLES = {
    "grid-npy": Sample("bed.npy", lambda path: np.save(path, HEIGHTS.astype(np.float32)), mutate_npy, BED),
    "grid-npz": Sample("bed.npz", lambda path: np.savez(path, z=HEIGHTS, x=np.arange(8.0)), mutate_zip, BED),
    "grid-tif": Sample("bed.tif", _tiff, mutate_bytes, BED),
    "grid-tif-packed": Sample(
        "bed.tif", lambda path: _tiff(path, compress="deflate", tiled=True, blockxsize=16, blockysize=16),
        mutate_bytes, BED,
    ),
    "grid-tif-degrees": Sample(
        "bed.tif", lambda path: _tiff(path, crs="EPSG:4326", pixel=(1e-5, 1e-5), corner=(10.0, 54.0)),
        mutate_bytes, BED,
    ),
    "grid-bag": Sample("bed.bag", lambda path: _tiff(path, driver="BAG", nodata=None), mutate_bytes, BED),
    "grid-asc": Sample("bed.asc", _bytes(ASCII), mutate_text, BED),
    "record-npz": Sample("record.npz", _record, mutate_zip, commands=RECORD),
    "record-nc": Sample("record.nc", _record, mutate_bytes, commands=RECORD),
    "record-nc3": Sample("record.nc", _classic_record, mutate_bytes, commands=RECORD),
    "record-xtf": Sample("record.xtf", _xtf, mutate_bytes, commands=RECORD),
    "record-jsf": Sample("record.jsf", _jsf, mutate_bytes, commands=RECORD),
    "record-zarr": Sample("record.zarr/zarr.json", _zarr, mutate_json, commands=RECORD),
    "record-zarr-shard": Sample("record.zarr/intensity/c/0/0/0", _zarr, mutate_bytes, commands=RECORD),
    "compare-npz": Sample("record.npz", lambda path: _record(path, 140, 200), mutate_zip, commands=COMPARED, share=0.1),
    "compare-xtf": Sample("record.xtf", lambda path: _xtf(path, 140, 200), mutate_bytes, commands=COMPARED, share=0.1),
    "mosaic-xtf": Sample("record.xtf", _xtf, mutate_bytes, commands=MAPPED, share=0.2),
    "tow-csv": Sample("tow.csv", _bytes(NAVIGATION), mutate_text, TOW),
    "tow-gpx": Sample("tow.gpx", _bytes(GPX), mutate_text, TOW),
    "tow-xtf": Sample("tow.xtf", _xtf, mutate_bytes, TOW),
    "tow-jsf": Sample("tow.jsf", _jsf, mutate_bytes, TOW),
    "tow-nc": Sample("tow.nc", _record, mutate_bytes, TOW),
    "cast-asvp": Sample("cast.asvp", _bytes(PROFILE), mutate_text, CAST),
    "cast-csv": Sample("cast.csv", _bytes(TABLE), mutate_text, CAST),
    "cast-vp2": Sample("cast.vp2", _bytes(VALEPORT), mutate_text, CAST),
    "cast-aml": Sample("cast.aml", _bytes(AML), mutate_text, CAST),
    "cast-cnv": Sample("cast.cnv", _bytes(SEABIRD), mutate_text, CAST),
    "mesh-obj": Sample("body.obj", _mesh, mutate_text, TARGET),
    "mesh-stl": Sample("body.stl", _mesh, mutate_bytes, TARGET),
    "mesh-ply": Sample("body.ply", _mesh, mutate_bytes, TARGET),
    "mesh-gltf": Sample("body.gltf", _mesh, mutate_json, TARGET),
    "mesh-glb": Sample("body.glb", _scene_gltf, mutate_glb, TARGET),
    "image-png": Sample("map.png", _picture, mutate_png, PICTURE),
    "image-palette": Sample("map.png", _palette, mutate_png, PICTURE),
    "backscatter-tif": Sample("backscatter.tif", _tiff, mutate_bytes, BACKSCATTER),
    "image-tif": Sample("map.tif", _picture, mutate_bytes, PICTURE),
    "correlation-csv": Sample("lags.csv", _bytes(LAGS), mutate_text, CORRELATION),
    "scene": Sample("scene.toml", _bytes(SCENE), mutate_scene, commands=SCENES),
}  # fmt: skip


if __name__ == "__main__":
    for name in sys.argv[2:]:
        place = Path(sys.argv[1], name, SAMPLES[name].file)
        place.parent.mkdir(parents=True)
        SAMPLES[name].write(place)
