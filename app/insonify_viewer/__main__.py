"""``python -m insonify_viewer [SCENE]``."""

from __future__ import annotations

import argparse
import sys

from insonify.scene import SceneError
from insonify_viewer.commands import add_arguments, run
from insonify_viewer.display import APT


def main(words: list[str] | None = None) -> int:
    """Run the viewer alone; a mistake is one sentence and exit code 2."""
    parser = argparse.ArgumentParser(prog="insonify_viewer", description="Open the viewer on a scene.")
    add_arguments(parser)
    try:
        return run(parser.parse_args(words))
    except (SceneError, OSError) as error:
        sys.stderr.write(f"{error}\n")
    except ImportError as error:
        remedy = APT if ".so" in str(error) else "pip install 'insonify[viewer]'"
        sys.stderr.write(f"The viewer cannot start ({error}); mend with: {remedy}\n")
    return 2


if __name__ == "__main__":
    sys.exit(main())
