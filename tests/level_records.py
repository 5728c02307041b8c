"""Records of given echoes over a level bed, along a straight line."""

import numpy as np
import xarray as xr


def level_record(
    intensity: np.ndarray, bin_length: float, altitude: float, step: float, **attributes: str
) -> xr.Dataset:
    """Record of energies (2, pings, bins), a step of the platform to a ping."""
    pings, bins = intensity.shape[1:]
    return xr.Dataset(
        {
            "intensity": (("channel", "ping_time", "range_sample"), intensity.astype(np.float32)),
            "platform_x": ("ping_time", step * np.arange(pings)),
            "platform_y": ("ping_time", np.zeros(pings)),
            "platform_altitude": ("ping_time", np.full(pings, altitude)),
        },
        coords={"slant_range": ("range_sample", (np.arange(bins) + 0.5) * bin_length)},
        attrs=attributes,
    )
