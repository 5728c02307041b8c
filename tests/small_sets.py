"""Small specifications of data sets and surveys, and comparisons of the folders that they make."""

import hashlib
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from insonify import cli
from insonify.compiler.build import own_build
from insonify.errors import SceneError
from insonify.surveys import engine
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.schedulers import claim_build

SET = """
title = "Drums and rocks"
seed = 3
scenes = 8
base = "default"
negatives = 0.25
[set]
targets = []
"seabed.spacing" = 0.2
"seabed.relief" = "flat"
"seabed.material" = { draw = "choice", of = ["silt", "medium_sand"] }
"sonar.range" = 24.0
"sonar.bins" = 160
"track.pings" = 96
"track.altitude" = { draw = "uniform", low = 5.0, high = 7.0 }
"receiver.speckle" = "rayleigh"
[[targets]]
name = "drum"
of = ["drum"]
count = { draw = "integers", low = 1, high = 2 }
[targets.set]
scale = 2.0
heading = { draw = "uniform", low = -90.0, high = 90.0 }
[[targets]]
name = "rock"
of = ["rock-round", { kind = "sphere", radius = 0.8 }]
count = 1
[tiles]
pings = 64
bins = 80
overlap = 0.2
empty = 0.5
"""

SURVEY = """
title = "A small basin"
base = "default"
[area]
corners = [[0.0, 0.0], [24.0, 0.0], [24.0, 30.0], [0.0, 30.0]]
spacing = 12.0
[set]
"seabed.spacing" = 0.2
"seabed.relief" = "flat"
"sonar.range" = 16.0
"sonar.bins" = 128
"sonar.ping_rate" = 6.0
"track.altitude" = 5.0
"track.speed" = 2.4
"receiver.speckle" = "rayleigh"
targets = [{ kind = "mesh", path = "drum", position = [10.0, 10.0], scale = 2.0 }]
"""


def data_set(text: str = SET, **changes: Any) -> DatasetSpecification:
    """Specification of a data set with some of its values changed."""
    return DatasetSpecification.model_validate({**tomllib.loads(text), **changes})


def write_set(folder: Path, text: str = SET, **changes: str) -> Path:
    """Write a specification with some of its first lines changed; return its path."""
    for name, value in changes.items():
        line = next((line for line in text.splitlines() if line.startswith(f"{name} = ")), None)
        text = text.replace(line, f"{name} = {value}", 1) if line else f"{name} = {value}\n{text}"
    path = folder / "set.toml"
    path.write_text(text)
    return path


def contents(folder: Path) -> dict[str, str]:
    """Hash of every file below a folder by its path, or of a single file."""
    files = (path for path in sorted([folder, *folder.rglob("*")]) if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def run_here(*words: str) -> int:
    """Run a command whose jobs are done in this process, one after another; to start workers takes 10 s of work."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(engine, "run_jobs", _do_jobs)
        return cli.main(words)


def _do_jobs(
    work: engine.Work, names: Sequence[str], _: str, progress: Callable[[engine.Outcome], object]
) -> tuple[engine.Outcome, ...]:
    claim_build(work.folder / engine.FLAGS, own_build())
    begun, failures = work.begun(), []
    for name in names:
        try:
            outcome = engine.finish(begun, name)
        except SceneError as error:
            outcome = engine.Outcome(name, failure=str(error))
            failures.append(outcome)
        progress(outcome)
    return tuple(failures)
