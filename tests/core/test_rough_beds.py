"""Echoes of rough beds: narrow lobes, twisted cells and steep slopes against exact rays."""

import math
from typing import Any

import numpy as np
import pytest

from insonify.packing.packed_scene import pack
from insonify.scene import Scene, edit, load_scene
from insonify.statistics.record_errors import RecordErrors, compare_records
from insonify.tracers import ray_sheets, sweep

PINGS = np.array([10, 77, 150])
LAMBERT = {"name": "fine_sand", "specular": 0.0}
FLANK = {"kind": "gaussian", "width": 20.0, "tilt": 20.0}
SHINY = {"name": "fine_sand", "specular": 0.3, "shininess": 400.0}


def bare_knife(relief: dict[str, Any], **changes: Any) -> Scene:
    """A knife over a bed of fine sand, one node every 0.1 m, 10 m below the sonar."""
    plain = {
        "seabed.relief": {"period": 102.4} | relief,
        "seabed.material": "fine_sand",
        "seabed.spacing": 0.1,
        "seabed.depth": 30.0,
        "sonar": {"beam": "knife", "range": 50.0, "bins": 1000, "pulse": "ideal"},
        "track.altitude": 10.0,
        "track.pings": 200,
        "receiver.speckle": "none",
        "targets": [],
    }
    return edit(load_scene("figure-6"), plain | {"seed": 7} | changes)


def fractal(rms: float, beta: float = 1.2) -> dict[str, Any]:
    return {"kind": "fractal", "beta": beta, "peaks": [[0.0, 0.0]], "rms": rms}


def errors(scene: Scene, *misplaced: float, rays: int = 1 << 15) -> list[float]:
    """Errors of the sweep with segments divided for several shares of misplaced echo."""
    packed = pack(scene)
    arrays, poses = packed.arrays, packed.poses(PINGS)
    right = ray_sheets.trace(arrays, poses, rays=rays)
    divided = (arrays._replace(limits=arrays.limits._replace(misplaced=share)) for share in misplaced)
    records = (sweep.trace(each, poses, planes=1) for each in divided)
    return [compare_records(arrays, poses, record, right).beyond for record in records]


@pytest.mark.parametrize(
    ("relief", "changes"),
    [
        (fractal(0.16), {}),
        (fractal(0.16), {"seabed.material": LAMBERT}),
        (fractal(0.16), {"sonar.law": "light"}),
        (fractal(0.16), {"seabed.material": SHINY}),
        (fractal(0.3), {}),
        (fractal(0.1, 0.1), {}),
        (fractal(0.1, 0.1), {"seabed.material": LAMBERT}),
        ({"kind": "ripples", "wavelength": 2.0, "height": 0.57}, {}),
        ({"kind": "ripples", "wavelength": 5.0, "height": 2.83}, {}),
        (fractal(0.16), {"track.heading": 37.0}),
        (fractal(0.3), {"track.heading": 37.0}),
        (fractal(0.3), {"track.heading": 8.0}),
        (fractal(0.5, 1.8), {"seabed.spacing": 0.8, "sonar.vertical": FLANK}),
    ],
)  # fmt: skip
def test_a_rough_bed_is_within_one_percent_of_exact_rays(relief, changes):
    assert errors(bare_knife(relief, **changes), 0.01)[0] < 1e-2


def test_the_error_falls_with_the_share_that_may_be_misplaced_and_smooth_beds_are_hardly_divided():
    for heading in (0.0, 37.0):
        whole, coarse, fine = errors(bare_knife(fractal(0.16), **{"track.heading": heading}), math.inf, 0.03, 0.003)
        assert fine < 0.4 * coarse
        assert coarse < 0.2 * whole
    # A level of 1 % is kept by the cells as they are.
    whole, divided = errors(bare_knife(fractal(0.05, 1.8)), math.inf, 0.01)
    assert whole < 2e-3
    assert divided < 2e-3


@pytest.mark.parametrize("heading", [5.0, 10.0, 37.0, 45.0, 80.0])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"seabed.material": LAMBERT},
        {"sonar.law": "light"},
        {"sonar.bins": 200},
        {"sonar.bins": 5000},
        {"seabed.material": {"kind": "patches", "of": ["fine_sand", "sandy_gravel"]}},
    ],
    ids=["sonar", "lambert", "light", "long bins", "short bins", "materials"],
)
def test_whole_segments_of_a_smooth_bed_have_linear_densities_at_any_heading(heading, changes):
    assert errors(bare_knife(fractal(0.05, 1.8), **{"track.heading": heading}, **changes), math.inf)[0] < 1e-3


REFRACTING = {
    # The fish above a thermocline, and at the axis of a channel.
    "thermocline": {"water": load_scene("thermocline").water, "seabed.depth": 40.0, "track.altitude": 26.0},
    "channel": {
        "water": {"kind": "profile", "depth": [0, 20, 30, 45], "sound_speed": [1510, 1500, 1490, 1505]},
        "seabed.depth": 40.0,
    },
}


def errors_in_water(scene: Scene, *, planes: int = 1, sheets: int = 1, rays: int = 1 << 16) -> RecordErrors:
    """Errors of the sweep of a scene whose water refracts."""
    packed = pack(scene)
    arrays, poses = packed.arrays, packed.poses(PINGS if planes == 1 else PINGS[:1])
    assert arrays.water.bent
    right = ray_sheets.trace(arrays, poses, sheets=sheets, rays=rays)
    return compare_records(arrays, poses, sweep.trace(arrays, poses, planes=planes), right)


@pytest.mark.parametrize("water", REFRACTING)
@pytest.mark.parametrize("material", [LAMBERT, "fine_sand", SHINY], ids=["lambert", "40", "400"])
@pytest.mark.parametrize("seed", [31, pytest.param(47, marks=pytest.mark.slow)])
def test_a_rough_bed_in_water_that_refracts_is_near_exact_rays(water, material, seed):
    scene = bare_knife(fractal(0.16), **REFRACTING[water], **{"seabed.material": material, "seed": seed})
    found = errors_in_water(scene)
    assert found.beyond < 5e-3
    assert found.all_bins < 1e-2


@pytest.mark.parametrize(
    ("water", "material"),
    [
        pytest.param("thermocline", SHINY, id="thermocline-400"),
        pytest.param("channel", "fine_sand", id="channel-40", marks=pytest.mark.slow),
        pytest.param("thermocline", "fine_sand", id="thermocline-40", marks=pytest.mark.slow),
        pytest.param("channel", SHINY, id="channel-400", marks=pytest.mark.slow),
    ],
)
def test_a_narrow_fan_in_water_that_refracts_is_near_exact_rays(water, material):
    fan = {"sonar.beam": {"kind": "fan", "width": 0.2}, "seabed.material": material, "seed": 31}
    found = errors_in_water(bare_knife(fractal(0.16), **REFRACTING[water], **fan), planes=64, sheets=32, rays=1 << 15)
    assert found.beyond < 5e-3
    assert found.all_bins < 1e-2
