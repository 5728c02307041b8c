"""Keys and gestures of the mouse that are no commands of menus, as the list of shortcuts shows them.

A view that takes keys is listed here; the commands of menus list themselves.
"""

from __future__ import annotations

OTHER_KEYS: tuple[tuple[str, tuple[tuple[str, str], ...]], ...] = (
    (
        "Record, while it has the keyboard",
        (
            ("move the cursor along the row", "← →"),
            ("look back and forward by a ping (newest on top)", "↓ ↑"),
            ("move ten bins or pings", "Shift+← → ↓ ↑"),
            ("look back and forward by a page, outside lessons", "PgDown PgUp"),
            ("go to the upper and the lower end of the tow", "Ctrl+Home Ctrl+End"),
            ("explain the pixel at the cursor, or let it go", "Return"),
            ("begin and end a measured line, after M", "Return"),
            ("move the line between A and B (wiped)", "Alt+← →"),
        ),
    ),
    ("Record, wherever no text is typed", (("show record A while held", "X"),)),
    (
        "Record, with the mouse",
        (
            ("explain a pixel, or let it go", "click"),
            ("look back along a paused record", "wheel"),
            ("zoom about the mouse", "Ctrl+wheel"),
            ("move a zoomed record across", "Shift+wheel"),
            ("move a zoomed record, and look back", "drag"),
            ("go to any ping", "drag of the handle at its edge"),
        ),
    ),
    (
        "3-D view, while it has the keyboard",
        (("turn", "← → ↓ ↑"), ("zoom", "+ -")),
    ),
    (
        "3-D view, with the mouse",
        (
            ("turn", "drag"),
            ("move", "Shift+drag"),
            ("zoom", "wheel"),
            ("light up the pixels that hear a place", "click"),
        ),
    ),
    (
        "Parameters",
        (
            ("find a parameter", "Ctrl+F"),
            ("show all parameters again", "Esc"),
            ("reset a parameter", "double-click on its name"),
        ),
    ),
    (
        "Water",
        (
            ("choose a point, or the cross in the water", "Tab"),
            ("move what is chosen, ten times as far with Shift", "← → ↓ ↑"),
            ("find the rays to the cross", "Return"),
        ),
    ),
    ("Chart", (("choose the point before or after", "← →"),)),
    ("Contrast", (("move the upper end", "← →"), ("move the lower end", "Shift+← →"))),
    ("Lessons", (("go to the step before", "PgUp"), ("go to the next step", "PgDown"))),
    ("Jobs", (("go from job to job", "↓ ↑"), ("stop the job that has the keyboard", "Delete"))),
    ("Tour", (("leave it", "Esc"),)),
)
