"""Distances and heights that are measured on a record are those of its scene."""

import math
from typing import Any

import numpy as np
import pytest

from insonify.scene import edit, load_scene
from insonify.simulation import Simulation, prepare
from insonify_viewer.record.measuring import Location, locate_simulated, measure, round_shadow_height, shadow_height
from insonify_viewer.state.inspection import Mark

ALTITUDE, RANGE, BINS = 10.0, 50.0, 2000
PING = 100


def scene_with(target: dict[str, Any], **changes):
    flat = {
        "seabed.relief": "flat", "sonar.range": RANGE, "sonar.bins": BINS, "sonar.beam": "knife",
        "sonar.pulse": "ideal", "track.altitude": ALTITUDE, "track.pings": 200,
    }  # fmt: skip
    empty = edit(load_scene("default"), {"targets": []} | flat)
    return edit(empty, {"targets": [target]} | changes)


def shadow_of(simulation: Simulation, across: float) -> tuple[Mark, Mark]:
    """Last bin of the target's echo before its shadow, and first bin of the bed behind it, on the port side."""
    heard = simulation.intensity(np.array([PING]))[0, 0] > 0.0
    behind = int(math.hypot(across, ALTITUDE) * BINS / RANGE)
    first = behind - 60 + int(np.argmax(~heard[behind - 60 :]))
    last = first + int(np.argmax(heard[first:]))
    return Mark(PING, 0, first - 1), Mark(PING, 0, last)


@pytest.mark.parametrize("across", [15.0, 20.0, 28.0])
@pytest.mark.parametrize("radius", [0.25, 0.5, 1.0])
@pytest.mark.parametrize("kind", ["pipe", "sphere"])
def test_heights_from_shadows_are_those_of_the_targets(kind, radius, across):
    """h = A L / (R + L) is within two bins of what a circle on a line gives, and 4 to 16 % below the top.

    The last ray touches the body below its top, and the bed heard in front of the body begins the shadow later.
    """
    size = {"length": 30.0, "gap": 0.0} if kind == "pipe" else {}
    place = {"kind": kind, "radius": radius, "position": [PING * 0.2, across], "heading": 0.0} | size
    simulation = prepare(scene_with(place), method="sweep")
    ends = [locate_simulated(simulation, mark) for mark in shadow_of(simulation, across)]
    measured = measure(*ends)
    found, of_round = measured.height, measured.round_height
    assert found is not None
    assert of_round is not None
    away = math.hypot(across, ALTITUDE - radius)
    down, half = math.atan2(ALTITUDE - radius, across), math.asin(radius / away)
    begins = max(math.sqrt(away**2 - radius**2), ALTITUDE / math.sin(down + half))
    ends_at = ALTITUDE / math.sin(down - half)
    width = 2.0 * ALTITUDE * (RANGE / BINS) / begins  # height of two bins
    assert found == pytest.approx(ALTITUDE * (ends_at - begins) / ends_at, abs=width)
    error = found / (2.0 * radius) - 1.0
    assert -0.16 < error < 0.0
    ground = math.sqrt(begins**2 - ALTITUDE**2)
    assert of_round == pytest.approx(2.0 * radius, abs=width * begins / ground), "of two bins, d h = A d R / G"
    assert f"{found:.2f} m high, {of_round:.2f} m if round" in measured.words


def test_the_height_of_a_round_body_follows_from_tangents_to_a_circle():
    """A circle of 0.7 m radius on the bed, 18 m away: its two tangents from the sonar meet the bed at both ends."""
    away, radius = 18.0, 0.7
    reach, down = math.hypot(away, ALTITUDE - radius), math.atan2(ALTITUDE - radius, away)
    half = math.asin(radius / reach)
    begins, ends = ALTITUDE / math.sin(down + half), ALTITUDE / math.sin(down - half)
    assert round_shadow_height(ALTITUDE, begins, ends - begins) == pytest.approx(2.0 * radius, rel=1e-12)
    assert round_shadow_height(ALTITUDE, begins, 0.0) == 0.0


def test_a_shadow_without_length_has_no_height_and_a_long_one_nears_the_altitude():
    assert shadow_height(10.0, 20.0, 0.0) == 0.0
    assert shadow_height(10.0, 20.0, 5.0) == pytest.approx(2.0)
    assert shadow_height(10.0, 1.0, 1e9) == pytest.approx(10.0)


@pytest.mark.parametrize("heading", [0.0, 37.0, 180.0])
def test_distances_are_those_on_the_bed(heading):
    sphere = {"kind": "sphere", "radius": 0.5, "position": [5.0, 500.0]}
    simulation = prepare(scene_with(sphere, **{"track.heading": heading}), method="sweep")
    first, last = (locate_simulated(simulation, mark) for mark in (Mark(20, 0, 1200), Mark(80, 1, 900)))
    found = measure(first, last)
    slants = [(bin_ + 0.5) * RANGE / BINS for bin_ in (1200, 900)]
    across = sum(math.sqrt(slant**2 - ALTITUDE**2) for slant in slants)
    assert found.along == pytest.approx(60 * 0.2, abs=1e-6)
    assert found.across == pytest.approx(across, abs=1e-6)
    assert found.straight == pytest.approx(math.hypot(12.0, across), abs=1e-6)
    assert (found.slant, found.pings) == (pytest.approx(slants[0] - slants[1]), 60)
    assert found.height is None, "no shadow reaches over both sides"
    assert found.words.startswith(f"{found.straight:.2f} m on the bed")


def test_in_the_water_column_slant_range_alone_is_known():
    first = Location(Mark(3, 0, 10), 0.5, None, None, 10.0, 0.0)
    last = Location(Mark(5, 0, 100), 5.0, None, None, 10.0, 0.0)
    assert measure(first, last).words == "slant range 4.50 m, 2 pings"
