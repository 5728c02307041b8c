"""Cross-section of the scene in the plane along the axis of the beam of one ping."""

from dataclasses import dataclass

import numpy as np

from insonify.arrays import Floats
from insonify.explanation.pixel_parts import arrays_at, find_athwart_parts
from insonify.explanation.sound_paths import SonarPose, locate_sonar
from insonify.explanation.words import name_part
from insonify.kernels.labels.echo_parts import BEHIND_BED, VISIBLE
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.simulation import Simulation
from insonify.tracers.echo_parts import EchoParts

PROFILE_SAMPLES = 1024  # of the bed's profile


@dataclass(frozen=True, eq=False)
class CrossSection:
    """Section of a scene by one vertical plane: ground ranges and heights above the datum, m."""

    ping: int
    side: int
    azimuth: float  # of the plane, from athwart towards the bow, rad
    sonar: SonarPose
    reach: float  # ground range to which the section is drawn, m
    bed: Floats  # (n, 2) profile of the bed, NaN where there is none
    visible: Floats  # (m, 2, 2) stretches of the bed that are visible from the sonar, and stretches that are hidden
    hidden: Floats
    targets: tuple[tuple[str, Floats], ...]  # names of the targets, and the visible part of each
    horizon: Floats  # (k, 2, 2) lines from each crest that hides bed to the end of its shadow


def cut_cross_section(simulation: Simulation, ping: int, side: int) -> CrossSection:
    """Cut the scene along the axis of the beam of one ping."""
    arrays, pose = arrays_at(simulation, ping)
    sonar, reach = locate_sonar(simulation, pose, side), arrays.bins * arrays.bin_length
    _, folded = make_apparent_tables(arrays, pose)
    azimuth, parts = 0.0, None
    if not folded.any():
        azimuth, parts = find_athwart_parts(arrays, pose, side, simulation.plan.label_settings.get("planes", 1))
    x = np.linspace(0.0, reach, PROFILE_SAMPLES)
    level = sonar.place[:2] + np.multiply.outer(x, sonar.direction(azimuth))
    bed = np.column_stack([x, simulation.ground.height_at(level[:, 0], level[:, 1])])
    nothing = np.empty((0, 2, 2))
    found = (nothing, nothing, (), nothing) if parts is None else _stretches(simulation, parts)
    return CrossSection(ping, side, azimuth, sonar, reach, bed, *found)


def _stretches(
    simulation: Simulation, parts: EchoParts
) -> tuple[Floats, Floats, tuple[tuple[str, Floats], ...], Floats]:
    """Visible and hidden stretches, targets, and horizons behind crests."""
    ends = np.stack([parts.begin, parts.end], axis=1)
    of_bed = parts.target < 0
    seen, targets = parts.state == VISIBLE, simulation.scene.targets
    named = tuple(
        (name_part(targets[k], int(k)), ends[seen & (parts.target == k)]) for k in np.unique(parts.target[~of_bed])
    )
    # Horizons go from crests to the ends of the bed that they hide.
    hidden = parts.take(parts.state == BEHIND_BED)
    crests, which = np.unique(hidden.crest, axis=0, return_inverse=True)
    beyond = [hidden.end[which.ravel() == k] for k in range(len(crests))]
    horizons = [(crest, end[np.argmax(end[:, 0])]) for crest, end in zip(crests, beyond)]
    return ends[of_bed & seen], ends[~seen], named, np.array(horizons).reshape(-1, 2, 2)
