"""Jobs panel: records, charts, data sets and pages that are made beside the window."""

from insonify_viewer.panels.jobs.controller import JobsPanel

PANEL = JobsPanel
