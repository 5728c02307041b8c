"""Window of the jobs, their rows, and the question about a data set."""

from __future__ import annotations

from insonify_viewer.panels.jobs.view.dataset_question import WantedDataset
from insonify_viewer.panels.jobs.view.jobs_window import JobsView, WantedChart

__all__ = ["JobsView", "WantedChart", "WantedDataset"]
