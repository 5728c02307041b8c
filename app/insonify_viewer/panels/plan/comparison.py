"""Comparison of two modellings of a scene: difference of the records, and ratio of the times."""

from __future__ import annotations

from typing import NamedTuple

from insonify_viewer.record.comparison.record_difference import RecordDifference, RecordSnapshot
from insonify_viewer.state.modelling import Modelling


class ModelledRecord(NamedTuple):
    """Copy of a record under one modelling."""

    record: RecordSnapshot  # the copy
    modelling: Modelling  # the modelling
    seconds: float  # time to trace a ping


def changed_subject(before: Modelling, after: Modelling) -> str:
    """Subject by which two modellings differ; empty if there are several, or none."""
    subjects = {subject for subject, _ in {*before.forced} ^ {*after.forced}}
    return subjects.pop() if len(subjects) == 1 and before.tolerance == after.tolerance else ""


def difference_in_words(difference: RecordDifference | None, times: float) -> str:
    """Write a difference and a ratio of times: "changes the record by 0.4 %, takes 1.8 × the time"."""
    record = "" if difference is None else f"{difference.in_words()}, "
    return f"{record}takes {times:.2g} × the time"
