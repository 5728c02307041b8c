"""What the readout tells of the pixel under the pointer."""

import numpy as np
from PySide6.QtTest import QTest

from insonify.scene import edit
from insonify.simulation import prepare
from insonify_viewer.state.inspection import Mark


def test_hover_tells_the_point_and_names_what_it_is(viewer, qtbot):
    waterfall = viewer.window.waterfall
    mark = Mark(ping=100, side=1, bin=60)
    assert waterfall.mark_at(waterfall.place_of(mark)) == mark
    QTest.mouseMove(waterfall, waterfall.place_of(mark))
    waterfall.hovered.emit(mark)
    readout = viewer.panels["readout"].widget
    assert "slant 30.25 m" in readout.text(), "at once, and the rest a moment later"
    qtbot.waitUntil(lambda: "incidence" in readout.text())
    # Bin 60 of 100 over 50 m, sonar 10 m over the bed.
    for part in ("ping 100", "starboard", "slant 30.25 m", "ground 28.5", "bed, medium sand", "incidence 40°", "dB)"):
        assert part in readout.text()
    waterfall.hovered.emit(None)
    assert readout.text() == ""
    # It names what a pixel is.
    for range_bin, told, untold in (
        (4, ["water column"], ["bed", "  ·  0", "dB"]),
        (70, ["pipe 1, steel", "incidence 40°"], ["bed"]),
        (71, ["shadow of pipe 1"], ["bed", "incidence"]),
        (72, ["bed, medium sand", "30 % in the shadow of pipe 1"], []),
        (80, ["ghost by surface and bottom (bed, medium sand)"], ["bed +", "bed -"]),
        (90, ["hidden by the bed"], ["incidence"]),
    ):
        viewer.window.waterfall.hovered.emit(Mark(ping=100, side=0, bin=range_bin))
        qtbot.waitUntil(lambda told=told: told[0] in readout.text())
        assert all(part in readout.text() for part in told)
        assert not any(part in readout.text() for part in untold)
    viewer.session.settle({"volumes": [{"kind": "school", "position": [0.0, 10.0, -20.0]}]})
    qtbot.waitUntil(lambda: viewer.complete)
    waterfall.hovered.emit(Mark(ping=100, side=0, bin=5))
    qtbot.waitUntil(lambda: "school 1" in readout.text())


def test_the_readout_tells_the_truth_of_the_core(open_viewer, small, qtbot):
    viewer = open_viewer(edit(small, {"sonar.beam": "knife", "sonar.bins": 500}), prepare=prepare)
    labels = viewer._answer.simulation.truth(np.array([100]))
    readout = viewer.panels["readout"].widget
    for words, found in (("pipe 1", labels.target_id == 0), ("shadow of pipe 1", labels.shadow > 0.9)):
        _, side, range_bin = np.argwhere(found)[0]
        viewer.window.waterfall.hovered.emit(Mark(100, int(side), int(range_bin)))
        qtbot.waitUntil(lambda words=words: words in readout.text())
