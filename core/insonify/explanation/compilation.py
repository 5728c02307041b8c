"""Compilation of the kernels that explain pixels and label points, before the first of them is needed."""

import numpy as np

from insonify.explanation.cross_section import cut_cross_section
from insonify.explanation.listeners import find_listeners
from insonify.explanation.pixel import explain_pixel
from insonify.simulation import Simulation

MOST_PINGS = 8  # pings that are explained
SIDES = (0, 1)


def compile_explanations(simulation: Simulation) -> None:
    """Explain and label a few pixels of a simulation, so that all kernels for it are compiled."""
    # Kernels of targets are compiled at the first ping that crosses one: the pixels lie on pings abeam of targets too.
    scene = simulation.scene
    pings = _pings_abeam(simulation)
    for ping in pings:
        for side in SIDES:
            explained = explain_pixel(simulation, ping, side, scene.sonar.bins // 2)
    cut_cross_section(simulation, pings[0], SIDES[0])
    beneath = np.array([*explained.sonar.place[:2], explained.sonar.below])
    find_listeners(simulation, beneath, np.array(pings, dtype=np.int64))
    simulation.truth(np.array(pings[:1], dtype=np.int64))


def _pings_abeam(simulation: Simulation) -> list[int]:
    """Find the first ping, and the one nearest to each of the first targets."""
    solids, mesh = simulation.arrays.solids, simulation.arrays.mesh
    line = simulation.line(np.arange(simulation.scene.track.pings, dtype=np.int64))
    centres = solids.start + 0.5 * solids.length[:, None] * solids.axis
    middles = np.concatenate([centres, mesh.corners.mean(axis=1)])
    owners = np.concatenate([solids.target, mesh.target])
    places = [middles[owners == target].mean(axis=0) for target in np.unique(owners)[: MOST_PINGS - 1]]
    return [0, *dict.fromkeys(int(np.hypot(line.x - x, line.y - y).argmin()) for x, y, _ in places)]
