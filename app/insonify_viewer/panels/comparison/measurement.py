"""Statistics of a recording and of a simulated record, as ``insonify compare`` measures them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from insonify.scene import SceneError

if TYPE_CHECKING:
    import xarray as xr

    from insonify.simulation import Simulation

Measured = dict[str, str] | str  # statistics in words by their names, or why there are none


def measure_record(record: xr.Dataset) -> Measured:
    """Measure the statistics of a record; a record with too little bed has a sentence instead."""
    # lazy: loads SciPy on a thread of its own; the window opens before
    from insonify.statistics.record_statistics import measure_statistics

    try:
        return measure_statistics(record).described()
    except SceneError as error:
        return str(error)


def measure_simulation(simulation: Simulation) -> Measured:
    """Measure the statistics of the whole record of a simulation."""
    # lazy: loads xarray on a thread of its own; the window opens before
    from insonify.io.record_schema import join_blocks
    from insonify.record.blocks import trace_blocks
    from insonify.record.variables import make_block

    title = {"title": simulation.scene.title}
    blocks = [
        make_block(simulation.scene, simulation.ground, *traced, None, title).to_dataset()
        for traced in trace_blocks(simulation)
    ]
    return measure_record(join_blocks(blocks))
