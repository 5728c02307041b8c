"""``record.plot()``: a plot of whole records, beside those of xarray."""

import warnings
from importlib import import_module
from typing import Any

import xarray as xr
from xarray.plot.accessor import DatasetPlotAccessor

from insonify.io.record_schema import ACROSS


class RecordPlot(DatasetPlotAccessor):
    """Draws records; its methods are the plots of xarray."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """Draw a record with its scales.

        Parameters
        ----------
        *arguments
            Passed to xarray, which plots no other Dataset as a whole.
        **options
            How it is drawn: ``palette``, ``gain``, ``side``, ``ground_range`` and the other display options.

        Returns
        -------
        PIL.Image.Image
            The picture, one pixel per amplitude; notebooks show it.
        """
        if arguments or "intensity" not in self._ds or self._ds["intensity"].dims != ACROSS:
            return super().__call__(*arguments, **options)
        # By name: drawing stands above files.
        return import_module("insonify.display.page").draw_record(self._ds, **options)


with warnings.catch_warnings():
    warnings.simplefilter("ignore", xr.core.extensions.AccessorRegistrationWarning)  # its methods are kept
    xr.register_dataset_accessor("plot")(RecordPlot)  # type: ignore[no-untyped-call]
