"""Progress of compilation, for the person at a terminal or the program that started the command."""

from insonify.compiler.progress import Compilation
from insonify.progress import Progress, open_progress

DELAY = 2.0  # s, of compilation before the bar appears


class CompilationBar:
    """Watcher of compilation that reports how far it is."""

    def __init__(self) -> None:
        self._progress: Progress | None = None

    def __call__(self, compilation: Compilation | None) -> None:
        """Report a compilation, or that a kernel is finished."""
        if compilation is not None:
            self._report(compilation)
        elif self._progress is not None:
            self._progress.close()
            self._progress = None

    def _report(self, compilation: Compilation) -> None:
        if self._progress is None:
            self._progress = open_progress(compilation.sentence, 1.0, delay=DELAY)
        self._progress.say(compilation.sentence)
        self._progress.reach(compilation.done)
