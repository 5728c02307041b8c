"""One plane's picture, blurred as the beam would: what is seen while a slider moves."""

import numpy as np
import pytest
from stand_in import StandIn

from insonify.display.normalisation import LevelBed, normalise
from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify_viewer.record.record_image import blur_along_track
from insonify_viewer.state.history import Modelling
from insonify_viewer.work.ping_request import PingRequest
from insonify_viewer.work.simulator import Simulator


def box(energy: np.ndarray, ping: int, pings: float) -> float:
    """Mean over so many pings about one, by small steps; the ends go on."""
    places = ping + 0.5 + pings * ((np.arange(20000) + 0.5) / 20000 - 0.5)
    return float(energy[np.clip(np.floor(places).astype(int), 0, len(energy) - 1)].mean())


def test_energies_are_averaged_over_what_the_beam_takes_in():
    columns = np.random.default_rng(1).uniform(0.0, 3.0, (9, 12)).astype(np.float32)
    reach = np.array([0.2, 0.9, 1.0, 1.7, 2.0, 31.4])
    found = blur_along_track(columns, np.concatenate([reach[::-1], reach]))
    for ping in range(9):
        for column in range(12):
            pings = max(reach[5 - column if column < 6 else column - 6], 1.0)
            expected = np.sqrt(box(columns[:, column].astype(float) ** 2, ping, pings))
            assert found[ping, column] == pytest.approx(expected, rel=1e-3), (ping, column)


def test_silence_stays_silent_and_loudness_what_it_is():
    columns = np.zeros((200, 4), np.float32)
    columns[:100] = 7.0
    found = blur_along_track(columns, np.full(4, 10.3))
    assert (found[110:] < 1e-2).all()
    assert found[:90] == pytest.approx(7.0, rel=1e-5)
    assert (blur_along_track(columns[:1], np.full(4, 10.3)) == columns[:1]).all()


@pytest.mark.parametrize("width", [1.0, 2.5])
def test_a_drag_looks_like_what_it_leads_to(width):
    scene = edit(load_scene("default"), {"sonar.beam.width": width, "sonar.bins": 250, "track.pings": 160})
    pings = np.arange(159, -1, -1)
    simulator = Simulator()
    simulator._cost = 0.0  # as if pings cost nothing, none to be thinned out
    (coarse,) = simulator._trace(PingRequest(0, scene, Modelling(), pings, fine=False))
    simulator.close()
    simulation = prepare(scene)
    fine = normalise(simulation.intensity(pings), LevelBed(simulation).curves(pings))
    wanted, plane = (np.concatenate([one[:, 0, ::-1], one[:, 1]], axis=1) for one in (fine, coarse.amplitude))
    assert coarse.reach is not None
    assert apart(blur_along_track(plane, np.concatenate([coarse.reach[::-1], coarse.reach])), wanted) < 0.5 * apart(
        plane, wanted
    )


def apart(record: np.ndarray, wanted: np.ndarray) -> float:
    """Difference of energies beyond 1.4 altitudes, of pings whose beams lie within the record."""
    energy, right = (one[25:-25, np.r_[0:180, 320:500]] ** 2 for one in (record, wanted))
    return float(np.linalg.norm(energy - right) / np.linalg.norm(right))


@pytest.mark.parametrize(
    "changes",
    [
        {"sonar.beam": "knife"},
        {"receiver.speckle": "rayleigh"},
        {"receiver.noise": "ambient"},
        {"receiver.recorder.dropped_pings": 0.1},
    ],
)
def test_what_is_random_or_has_no_width_is_not_smeared(small, changes):
    simulator = Simulator(StandIn)
    (answer,) = simulator._trace(PingRequest(0, edit(small, changes), Modelling(), np.arange(3), fine=False))
    simulator.close()
    assert answer.reach is None
