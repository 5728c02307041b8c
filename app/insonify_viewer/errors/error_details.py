"""Details of an error, to be copied into a report."""

from __future__ import annotations

from collections.abc import Sequence

from insonify_viewer.errors.failure import Failure
from insonify_viewer.errors.versions import list_versions


def write_details(failure: Failure, scene: str, said: Sequence[str]) -> str:
    """Write what helps to find the cause of an error, as text."""
    parts = (
        ("", [failure.sentence]),
        ("Traceback", failure.trace.splitlines()),
        ("Said before", said),
        ("Versions", list_versions()),
        ("Scene", scene.splitlines()),
    )
    return "\n\n".join("\n".join([title] * bool(title) + list(lines)) for title, lines in parts if lines) + "\n"
