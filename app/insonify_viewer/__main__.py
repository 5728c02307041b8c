"""``python -m insonify_viewer [SCENE]``: the same as ``insonify view``."""

import sys

from insonify.__main__ import end
from insonify.cli import main

if __name__ == "__main__":
    end(main(["view", *sys.argv[1:]]))
