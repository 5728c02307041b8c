"""Every field of a scene changes its record, or a line here says why it does not."""

import re
from collections.abc import Iterator
from functools import lru_cache
from operator import attrgetter

import numpy as np
import pytest
import xarray as xr
from PIL import Image
from pydantic import BaseModel

from bathymetry_files import write_tiff
from field_changes import CHANGES, ELSEWHERE, WHY_NOT, WHY_NOT_OF_MATERIALS
from insonify.scene import Scene, build, edit
from insonify.scene.base import kind_name, models_of
from insonify.simulation import simulate

RELIEF = {"kind": "fractal", "beta": 1.6, "peaks": [[6.0, 3.0]], "period": 16.0, "rms": 0.1}
PIPE, BALL = {"kind": "pipe", "position": [2.0, 12.0], "length": 6.0}, {"kind": "sphere", "position": [1.0, -12.0]}
BASE = build(
    {
        "title": "Every field",
        "seabed": {"spacing": 0.5, "material": "coarse_sand", "relief": RELIEF},
        "targets": [PIPE, BALL],
        "sonar": {"beam": {"kind": "fan", "width": 4.0}, "range": 30.0, "bins": 120},
        "track": {"altitude": 7.0, "pings": 12},
    }
)


def fields(model: type[BaseModel], path: str = "") -> Iterator[str]:
    """Dotted paths of all fields of all kinds, the kind in brackets where there is a choice."""
    for name in model.model_fields:
        if name == "kind":
            continue
        here = f"{path}.{name}" if path else name
        yield here
        for child in models_of(model, name):
            kind = kind_name(child)
            yield from fields(child, f"{here}[{kind}]" if kind is not None else here)


EVERY = set(fields(Scene))
WHY_NOT |= {
    path: "adds multipath, which refracting water does not support"
    for path in EVERY
    if ".surface" in path and path.startswith("water[") and not path.startswith("water[uniform]")
}
LOCKED = "is for the viewer, which leaves a locked target as it is"
WHY_NOT |= {path: LOCKED for path in EVERY if path.endswith(".locked")}
WHY_NOT |= {
    path: WHY_NOT_OF_MATERIALS[path.rpartition(".")[2]]
    for path in EVERY - CHANGES.keys()
    if path.rpartition(".")[2] in WHY_NOT_OF_MATERIALS and path.rpartition(".")[0].endswith("[uniform]")
}


@pytest.fixture(scope="module")
def bed_files(tmp_path_factory):
    """Beds, maps, a tetrahedron, tows, casts, correlations and pictures, by their names as changes give them."""
    folder = tmp_path_factory.mktemp("beds")
    y, x = np.mgrid[0:80, 0:80] * 0.5
    bed = -30.0 + 0.2 * np.sin(x) * np.cos(0.7 * y)
    for grid, chart, heights in (("bed", "map", bed), ("other", "other_map", bed.T)):
        np.save(folder / f"{grid}.npy", heights)
        write_tiff(folder / f"{chart}.tif", heights, pixel=(0.5, 0.5), corner=(980.0, 2020.0), crs="EPSG:32631")
    rows = [f"{d},{18 - 0.05 * d - 6 * (d > 23)},{34 + 0.02 * d}" for d in range(31)]
    head = "depth,temperature,salinity"
    for name, text in {
        "shape.obj": "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
        "tow.csv": "time,y,x\n0,0,0\n2,1,2\n",
        "other_tow.csv": "time,depth\n0,20\n1,22\n",
        "cast.csv": "\n".join([head, *rows]),
        "other_cast.csv": "\n".join([head, *(f"{d},{19 - 0.1 * d},35" for d in range(30, -1, -1))]),
        "correlation.csv": "lag,autocorrelation\n0,1\n1,0.4\n3,0\n",
        "other_correlation.csv": "0,1\n1.5,0.3\n4,0\n",
    }.items():
        (folder / name).write_text(text)
    grey = np.where(np.add.outer(np.arange(12), np.arange(12)) % 5 < 2, 0, 255).astype(np.uint8)
    Image.fromarray(grey).save(folder / "picture.png")
    Image.fromarray(255 - grey).save(folder / "negative.png")
    return {path.stem.upper(): path for path in folder.iterdir()}


def with_files(changes, files):
    """Put the files' paths in place of their names."""
    if isinstance(changes, dict):
        return {key: with_files(value, files) for key, value in changes.items()}
    if isinstance(changes, list):
        return [with_files(value, files) for value in changes]
    return str(files[changes]) if isinstance(changes, str) and changes in files else changes


def derived(path: str) -> tuple[dict, dict] | None:
    """Set up and move a field of a kind that no line speaks of: one that all targets share, or a number."""
    found = re.fullmatch(r"([a-z_.]+)\[(\w+)\]\.(.+)", path)
    if found is None:
        return None
    choice, kind, name = found.groups()
    place = "targets.0" if choice == "targets" else choice
    if f"{choice}[pipe].{name}" in CHANGES:
        needs, change = CHANGES[f"{choice}[pipe].{name}"]
        return {f"{place}.kind": kind} | needs, change
    *parents, last = choice.split(".")
    holder: type[BaseModel] = type(attrgetter(".".join(parents))(Scene())) if parents else Scene
    model = next(child for child in models_of(holder, last) if kind_name(child) == kind)
    default = model.model_fields[name].get_default() if name in model.model_fields else None
    if isinstance(default, bool) or not isinstance(default, (int, float)):
        return None
    return {f"{place}.kind": kind}, {f"{place}.{name}": 1.5 * default or 20.0}


DERIVED = {path: change for path in sorted(EVERY - CHANGES.keys() - WHY_NOT.keys()) if (change := derived(path))}


def test_every_field_is_accounted_for():
    forgotten = sorted(EVERY - CHANGES.keys() - WHY_NOT.keys() - DERIVED.keys())
    assert not forgotten, f"fields without a test that they change the record: {', '.join(forgotten)}"
    gone = sorted((CHANGES.keys() | WHY_NOT.keys()) - EVERY)
    assert not gone, f"fields that the scene no longer has: {', '.join(gone)}"
    assert not CHANGES.keys() & WHY_NOT.keys()


def with_some_slow(paths):
    """Paths as cases: of a kind within a sum, which has the same fields alone, all but the first run slow."""
    seen = set()
    for path in paths:
        kind, summed = re.subn(r"(\[sum\]\.of\[\w+\]).*", r"\1", path)
        yield pytest.param(path, marks=[pytest.mark.slow] * (summed and kind in seen))
        seen.add(kind)


@pytest.mark.usefixtures("fixed_model")  # which makes no difference, as another plan might
@pytest.mark.parametrize("path", [*with_some_slow([*CHANGES, *DERIVED])])
def test_it_changes_the_record(path, bed_files):
    needs, change = (with_files(part, bed_files) for part in (CHANGES | DERIVED)[path])
    before = edit(BASE, needs)
    one, other = record_of(before), simulate(edit(before, change))
    if path in ELSEWHERE:
        assert not one[ELSEWHERE[path]].equals(other[ELSEWHERE[path]])
    else:
        a, b = one.intensity.values, other.intensity.values  # which differ by more than rounding
        assert a.shape != b.shape or not np.allclose(a, b, rtol=1e-4, atol=1e-6 * a.max())


@lru_cache(maxsize=16)
def record_of(scene: Scene) -> xr.Dataset:
    """Record of a scene that many changes begin with, made once."""
    return simulate(scene)


def test_what_is_for_people_and_maps_stands_in_the_attributes_alone():
    scene = edit(BASE, {"track.pings": 2})
    one = simulate(scene)
    for path, value in {"title": "Another", "description": "Another", "world.crs": "EPSG:32631"}.items():
        other = simulate(edit(scene, {path: value}))
        xr.testing.assert_equal(one, other)
        assert value in other.attrs["scene"]
        assert value not in one.attrs["scene"]
