"""Variables, coordinates and attributes of a simulated record."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from insonify.acoustics.water import recording_speed
from insonify.arrays import Integers
from insonify.compiler.build import own_build
from insonify.io.georeference import find_georeference
from insonify.io.record_block import RecordBlock, make_record_block
from insonify.io.record_schema import (
    RECORD_ERROR,
    coordinates,
    echo_variable,
    error_variables,
    platform,
    target_variables,
)
from insonify.kernels.common.types import Poses
from insonify.planning import Plan
from insonify.record.labels import Columns, LabelledBlock, label_variables, name_parts
from insonify.record.target_truth import TargetTruth
from insonify.scene import Scene, scene_to_toml
from insonify.terrain import AnyGround
from insonify.tow.poses import platform_columns


def make_block(
    scene: Scene,
    ground: AnyGround,
    pings: Integers,
    poses: Poses,
    columns: Columns,
    truth: TargetTruth | None,
    attributes: Mapping[str, Any],
) -> RecordBlock:
    """Make the block of a record that holds some pings."""
    sonar = scene.sonar
    slant_range = (np.arange(sonar.bins) + 0.5) * (sonar.range / sonar.bins)
    variables = echo_variable(columns["intensity"]) | error_variables(columns)
    variables |= platform(platform_columns(poses, ground), find_georeference(attributes))
    if truth is not None:
        variables |= label_variables(LabelledBlock(scene, ground, poses, columns))
        targets = list(name_parts(scene.targets).values())
        variables |= target_variables(truth._asdict(), targets) if targets else {}
    coords = coordinates(pings / sonar.ping_rate, slant_range, recording_speed(scene, ground.datum))
    if RECORD_ERROR in columns:
        attributes = {**attributes, RECORD_ERROR: float(columns[RECORD_ERROR])}
    return make_record_block(variables, coords, attributes)


def record_attributes(
    scene: Scene, plan: Plan, method: str, tolerance: float, forced: Mapping[str, str] | None
) -> dict[str, Any]:
    """Attributes of a record: the scene, how it was simulated, and by which version on which machine."""
    build = own_build()
    attributes: dict[str, Any] = {
        "title": scene.title,
        "scene": scene_to_toml(scene),
        "plan": "\n".join(plan.lines()),
        "method": method,
        "tolerance": tolerance,
        "version": build.insonify,
        "build": build.text(),
        "frequency": scene.sonar.frequency,
    }
    sonar = scene.sonar
    widths = {  # one-way widths and depression of the beams in degrees, where they have one
        "beam_width": getattr(sonar.beam, "width", None),
        "vertical_beam_width": getattr(sonar.vertical, "width", None),
        "vertical_beam_tilt": getattr(sonar.vertical, "tilt", None),
    }
    attributes |= {name: value for name, value in widths.items() if value is not None}
    if scene.georeference is not None:
        attributes |= scene.georeference.attributes()
    if forced:
        attributes["model"] = " ".join(f"{subject}={choice}" for subject, choice in forced.items())
    return attributes
