"""Bar on the terminal while kernels are compiled."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from insonify.kernels.common.compilation import Compilation

if TYPE_CHECKING:
    from tqdm import tqdm

DELAY = 2.0  # s, of compilation before the bar appears
LAYOUT = "{desc} {percentage:3.0f} % |{bar}|"


class CompilationBar:
    """Watcher of compilation that draws a bar on standard error, if that is a terminal."""

    def __init__(self) -> None:
        self._bar: tqdm[None] | None = None

    def __call__(self, compilation: Compilation | None) -> None:
        """Draw the bar, or remove it when a kernel is finished."""
        if compilation is None:
            self._close()
        elif sys.stderr is not None and sys.stderr.isatty():
            self._draw(compilation)

    def _draw(self, compilation: Compilation) -> None:
        if self._bar is None:
            # lazy: most commands find their kernels compiled
            from tqdm import tqdm

            self._bar = tqdm(total=1.0, delay=DELAY, mininterval=0.0, miniters=0, leave=False, bar_format=LAYOUT)
        self._bar.set_description_str(compilation.sentence, refresh=False)
        self._bar.update(compilation.done - self._bar.n)

    def _close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None
