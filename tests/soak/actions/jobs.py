"""Jobs beside the window."""

import os
from pathlib import Path
from typing import Any

from insonify_viewer.viewer import Viewer
from soak.actions import Random, Steps, action

SCENES = 4  # of a data set


@action(0.5)
def work_beside(viewer: Viewer, random: Random) -> Steps:
    """Begin a job of any kind, look at it, and mostly stop it before its end."""
    panel: Any = viewer.panels["jobs"]
    viewer.window.open_panel("jobs")
    folder = Path(os.environ["XDG_STATE_HOME"]) / f"job-{len(viewer.jobs.jobs)}-{random.integers(1_000_000)}"
    folder.mkdir()
    match random.integers(4):
        case 0:
            panel.write_record(folder / str(random.choice(["record.nc", "record.xtf", "record.png"])))
        case 1:
            panel.measure_chart("accuracy", folder / "chart.png")
        case 2:
            panel.make_dataset("mines", SCENES, folder / "set")
        case 3:
            panel.write_stability_page(folder / "stability.html")
    yield float(random.choice([20.0, 3000.0, 15_000.0]))
    for job in viewer.jobs.running:
        if random.random() < 0.8:
            job.stop()
    yield 500.0
    panel.view.close()
    if random.random() < 0.5:
        panel.view.forget.click()
