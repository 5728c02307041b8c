"""A scene that is learned from a recording, as ``insonify learn`` learns it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from insonify_viewer.record.comparison.recording import Recording
    from insonify_viewer.work.background_job import BackgroundJob
    from insonify_viewer.work.job_list import JobList


def begin_learning(jobs: JobList, recording: Recording, file: Path) -> BackgroundJob:
    """Start to learn a scene from a recording, which is read anew at the frequency that is shown."""
    arguments = ["learn", str(recording.path), "-o", str(file)]
    if recording.dataset.attrs.get("frequencies"):
        arguments += ["--frequency", repr(float(recording.dataset.attrs["frequency"]))]
    return jobs.begin(f"scene like {recording.path.name}", arguments, file)
