"""The least that any tracer does: a kernel that reads the heights abeam of every ping and writes its bins."""

from collections.abc import Callable

import numpy as np

from insonify.compiler.jit import kernel
from insonify.simulation import Simulation


@kernel
def read_and_write(heights, reach, out):
    rows, columns = heights.shape
    for ping in range(out.shape[0]):
        row = heights[ping % rows]
        for side in range(2):
            total = np.float32(0.0)
            for k in range(columns // 2 * side, columns // 2 * side + reach):
                total += row[k]
            bins = out[ping, side]
            for k in range(bins.size):
                bins[k] = total


def floor_call(simulation: Simulation, pings: int, times: int = 1) -> Callable[[], None]:
    """Call that reads the heights and writes the bins of some pings, a number of times."""
    bed, bins = simulation.reduced.bed, simulation.scene.sonar.bins
    reach = min(int(simulation.scene.sonar.range / bed.spacing), bed.transposed.shape[1] // 2 - 1)

    def call() -> None:
        for _ in range(times):
            read_and_write(bed.transposed, reach, np.empty((pings, 2, bins), np.float32))

    return call
