"""Placement of a new target: abeam of the pings on screen, so that it shows at once."""

import itertools
import math
from typing import Any

import numpy as np

from insonify.scene import Scene, SceneError
from insonify.scene.targets import TARGETS, Target
from insonify_viewer.core_types import Simulation

BEHIND = (0.15, 0.3, 0.45, 0.6)  # shares of the pings on screen, from the newest
ABEAM = (-0.45, 0.45, -0.7, 0.7, -0.25, 0.25)  # of the farthest ground range, port positive
APART = 0.15  # from other targets, in slant ranges
ASKEW = 30.0  # degrees between the track and the target, so that its shape shows


def target_menu() -> dict[str, str]:
    """Names of the kinds of targets, by kind; one that asks for a file first ends in an ellipsis."""
    return {kind: kind.replace("_", " ").capitalize() + "…" * needs_file(kind) for kind in TARGETS.models(Target)}


def needs_file(kind: str) -> bool:
    """Whether a target of a kind is read from a file."""
    return "path" in TARGETS.models(Target)[kind].model_fields


def new_target(simulation: Simulation, scene: Scene, kind: str, top: int, path: str = "") -> dict[str, Any]:
    """Declare a new target at a free place."""
    x, y, heading = _free_place(simulation, scene, top)
    target: dict[str, Any] = {"kind": kind, "position": [round(x, 2), round(y, 2)]}
    model = TARGETS.models(Target)[kind]
    if "heading" in model.model_fields:
        target["heading"] = round((heading + ASKEW + 180.0) % 360.0 - 180.0, 1)
    return target | model.suited_to(scene.sonar.range, path)


def _free_place(simulation: Simulation, scene: Scene, top: int) -> tuple[float, float, float]:
    """Find a place on the bed, clear of other targets if possible; return x, y and the heading of the track."""
    # Pings along one slant range of track, which both views show.
    seen = min(scene.track.pings, round(scene.sonar.range * scene.sonar.ping_rate / scene.track.speed))
    pings = np.array([top - round(share * seen) for share in BEHIND], dtype=np.int64)
    poses = simulation.poses(pings)
    reach = math.sqrt(max(scene.sonar.range**2 - float(poses.z[0]) ** 2, 0.0))
    places = [
        (
            float(poses.x[i]) - share * reach * math.sin(poses.heading[i]),
            float(poses.y[i]) + share * reach * math.cos(poses.heading[i]),
            math.degrees(poses.heading[i]),
        )
        for i, share in itertools.product(range(len(pings)), ABEAM)
    ]
    x, y = (np.array(column) for column in list(zip(*places))[:2])
    there = np.flatnonzero(np.isfinite(simulation.ground.height_at_once(x, y)))
    if not there.size:
        raise SceneError("there is no bed beside this part of the tow; move on along it, then add the target")
    others, apart = [target.position[:2] for target in scene.targets], APART * scene.sonar.range
    clear = [k for k in there if all(math.dist((x[k], y[k]), other) > apart for other in others)]
    return places[int(clear[0] if clear else there[0])]
