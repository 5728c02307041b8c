"""``python -m insonify``."""

import sys

from insonify.cli import main

sys.exit(main())
