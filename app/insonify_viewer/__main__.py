"""``python -m insonify_viewer [SCENE]``: the same as ``insonify view``."""

from __future__ import annotations

import sys

from insonify.cli import main

if __name__ == "__main__":
    sys.exit(main(["view", *sys.argv[1:]]))
