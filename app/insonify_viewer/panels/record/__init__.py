"""Record panel: how records are shown, what is measured on them, and contacts."""

from insonify_viewer.panels.record.controller import RecordPanel

PANEL = RecordPanel
