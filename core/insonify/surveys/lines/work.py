"""Work of a survey: each job simulates the record of one line of the one scene, by the plan of the whole."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from insonify.io.atomic import replacing
from insonify.io.record_block import RecordBlock
from insonify.io.records import write_record
from insonify.planning import Plan, plan
from insonify.record.variables import make_block, record_attributes
from insonify.scene import Scene, edit
from insonify.simulation import prepare
from insonify.surveys.engine import FLAGS, digest_of, job_number, name_job
from insonify.surveys.lines.specification import SurveySpecification
from insonify.surveys.lines.track import SurveyLine, SurveyTrack, join_lines, lay_lines
from insonify.surveys.specification import contents_of

TRACK = "track.csv"
RECORDS = "records"
WARMING = 4  # pings that compile the kernels
TOLERANCE = 0.03


@dataclass(frozen=True)
class SurveyWork:
    """The jobs of a survey."""

    specification: SurveySpecification
    base: Scene  # scene; its track is replaced
    folder: Path  # folder of the survey
    plan: Plan | None = None  # plan of the whole survey, which is sent to the workers

    @cached_property
    def lines(self) -> list[SurveyLine]:
        """The lines, in order."""
        return lay_lines(self.specification)

    @cached_property
    def track(self) -> SurveyTrack:
        """The track that joins the lines."""
        surveyed = edit(self.base, self.specification.set)
        return join_lines(self.lines, surveyed.track.speed, surveyed.sonar.ping_rate)

    @cached_property
    def digest(self) -> str:
        """Hash of all that every job depends on."""
        return digest_of(*contents_of(self.specification, self.base))

    @cached_property
    def scene(self) -> Scene:
        """The scene with the track of the whole survey; the fixes are in a file of the survey's folder."""
        return self._towed_along(str(self.folder / FLAGS / TRACK))

    def _towed_along(self, path: str) -> Scene:
        """Return the scene with the fixes in a file."""
        surveyed = edit(self.base, self.specification.set)
        recorded = {"kind": "recorded", "path": path}
        others = [motion.model_dump(mode="json") for motion in surveyed.track.motions if motion.moves]
        motion = {"kind": "sum", "of": [recorded, *others]} if others else recorded
        first = self.lines[0]
        changes = {
            "track.start": list(first.start),
            "track.heading": math.degrees(first.heading),
            "track.pings": self.track.pings[-1].stop,
            "track.motion": motion,
        }
        return edit(surveyed, changes)

    def names(self) -> list[str]:
        """Names of all jobs."""
        return [name_job(number, self.digest) for number in range(len(self.lines))]

    def begun(self) -> SurveyWork:
        """Write the track, and plan the survey."""
        path = self.folder / FLAGS / TRACK
        path.parent.mkdir(parents=True, exist_ok=True)
        rows = np.column_stack(self.track[:4])
        with replacing(path) as beside:
            np.savetxt(beside, rows, fmt="%.9g", delimiter=",", header="time,x,y,heading", comments="")
        return replace(self, plan=plan(self.scene, TOLERANCE))

    def make(self, name: str, beside: Path) -> dict[str, Any]:
        """Simulate the record of a line below a folder, and describe it."""
        number = job_number(name)
        file = f"{RECORDS}/line-{number + 1:04d}{self.specification.suffix}"
        (beside / file).parent.mkdir()
        pings = self.track.pings[number]
        write_record(beside / file, self._blocks(pings))
        line = self.lines[number]
        return {
            "made": 1,
            "line": number,
            "file": file,
            "start": list(line.start),
            "end": list(line.end),
            "heading": round(math.degrees(line.heading), 6),
            "length": round(line.length, 6),
            "turn": round(line.turn, 6),
            "first_ping": pings.start,
            "pings": len(pings),
        }

    def warm_up(self) -> None:
        """Simulate a few pings."""
        prepare(self.scene, plan=self.plan).intensity(np.arange(WARMING))

    def _blocks(self, pings: range) -> Iterator[RecordBlock]:
        """Record of some pings, block by block."""
        simulation = prepare(self.scene, plan=self.plan)
        # In the file, the track's path begins at the folder of records: the folder of the survey can be moved.
        scene = self._towed_along(f"../{FLAGS}/{TRACK}")
        attributes = record_attributes(scene, simulation.plan, "auto", TOLERANCE, None)
        for block in simulation.record_blocks(pings=pings):
            yield make_block(self.scene, simulation.ground, *block, None, attributes)
