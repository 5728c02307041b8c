"""The record is laid over the bed of the 3-D view, where a level bed would put its echoes."""

import math

import numpy as np
import pytest

from insonify.display.display_options import DisplayOptions
from insonify.scene import edit
from insonify.tow.poses import make_poses
from insonify_viewer.record.drape import RecordStrip, drape_record
from insonify_viewer.record.tone_map import make_tone_map


@pytest.mark.parametrize("heading", [0.0, 30.0, 180.0])
@pytest.mark.parametrize("side", [0, 1])
def test_an_echo_lies_at_its_ground_range(small, heading, side):
    from stand_in import ground_of

    scene = edit(small, {"track.heading": heading, "track.start": [0.0, 0.0]})
    pings, bins, altitude = np.arange(100), 400, 10.0
    poses = make_poses(scene, ground_of(scene.seabed), pings)
    amplitude = np.zeros((100, 2, bins), np.float32)
    amplitude[40:60, side, 238:242] = 1.0
    rows = np.concatenate([amplitude[:, 0, ::-1], amplitude[:, 1]], axis=1)
    tone_map = make_tone_map(DisplayOptions(palette="grey", levels=(0.0, 1.0)), (0.0, 1.0))
    strip = RecordStrip(poses, rows, np.full(100, altitude), 50.0 / bins, tone_map)
    bed = np.full((360, 360, 3), 99, np.uint8)
    draped = drape_record(bed, (0.0, 0.0), 90.0, strip)
    row, column = np.nonzero(draped[..., 0] > 120)
    x, y = (column + 0.5) * 0.5 - 90.0, 90.0 - (row + 0.5) * 0.5
    ground = math.sqrt((240 * 50.0 / bins) ** 2 - altitude**2) * (1.0 if side == 0 else -1.0)
    angle = math.radians(heading)
    middle = 49.5 * 0.2
    assert x.mean() == pytest.approx(middle * math.cos(angle) - ground * math.sin(angle), abs=0.5)
    assert y.mean() == pytest.approx(middle * math.sin(angle) + ground * math.cos(angle), abs=0.5)
    assert (draped[0, 0] == 99).all(), "the bed stays where nothing is heard"
    assert (bed == 99).all()


def test_a_record_narrower_than_a_pixel_of_the_bed_leaves_it_as_it_is(small):
    from stand_in import ground_of

    pings = np.arange(3)
    poses = make_poses(small, ground_of(small.seabed), pings)
    tone_map = make_tone_map(DisplayOptions(palette="grey", levels=(0.0, 1.0)), (0.0, 1.0))
    strip = RecordStrip(poses, np.ones((3, 80), np.float32), np.full(3, 10.0), 0.2501, tone_map)  # 0.4 m of ground
    bed = np.full((8, 8, 3), 99, np.uint8)
    np.testing.assert_array_equal(drape_record(bed, (0.0, 0.0), 90.0, strip), bed)


def test_the_option_lays_the_record_over_the_bed_and_takes_it_off(viewer, qtbot):
    shown = []
    show = viewer.seabed.view.show_texture
    viewer.seabed.view.show_texture = lambda image: (shown.append(image.copy()), show(image))
    viewer.session.show(draped=True)
    qtbot.waitUntil(lambda: len(shown) == 1)
    assert (shown[0] != viewer.seabed._patch.image).mean() > 0.05
    viewer.session.show(draped=False)
    qtbot.waitUntil(lambda: len(shown) == 2)
    assert (shown[1] == viewer.seabed._patch.image).all()


def test_the_record_stays_over_the_bed_when_the_window_of_the_bed_moves(viewer, qtbot):
    seabed, bare = viewer.seabed, []
    viewer.session.show(draped=True)
    qtbot.waitUntil(lambda: seabed.complete)
    show, patch = seabed.view.show_texture, seabed._patch
    seabed.view.show_texture = lambda image: (bare.append((image == seabed._patch.image).all()), show(image))
    viewer.go_to(viewer.tow.newest + 60)
    qtbot.waitUntil(lambda: viewer.complete and seabed._patch is not patch)
    assert bare, "the bed was drawn at its new place"
    assert not any(bare), "never without the record"
