"""What kernels see of a scene: arrays and numbers in metres and radians, never declarations.

Heights are metres above the *datum*, the mean bed, so that float32 is fine enough at any depth. x and y are the
scene's own local coordinates.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

LIGHT, SONAR = 0, 1
PORT, STARBOARD = 0, 1
SPHERE, CYLINDER = 0, 1
BED = -1


class Bed(NamedTuple):
    """A bilinear height field; NaN marks nodes without a bed."""

    heights: NDArray[np.float32]  # (ny, nx), node (j, i) at (x0 + i spacing, y0 + j spacing)
    transposed: NDArray[np.float32]  # (nx, ny), the same heights laid out the other way
    materials: NDArray[np.uint8]  # (ny, nx), of the cell whose low corner is node (j, i)
    x0: float
    y0: float
    spacing: float
    periodic: bool  # whether node nx is node 0 again, and likewise ny
    low: float  # lowest height, NaN apart
    high: float  # highest height, NaN apart
    mapped: bool = True  # whether there is more than one material


class Solids(NamedTuple):
    """Analytic convex bodies, one row each; a pipe is a chain of cylinders jointed by spheres."""

    shape: NDArray[np.int64]  # (n,) SPHERE or CYLINDER
    start: NDArray[np.float64]  # (n, 3) centre of a sphere, or of a cylinder's first end
    axis: NDArray[np.float64]  # (n, 3) unit vector along a cylinder, zero for a sphere
    length: NDArray[np.float64]  # (n,) of a cylinder, 0 for a sphere
    radius: NDArray[np.float64]  # (n,)
    material: NDArray[np.int64]  # (n,) row of the reflectivity table
    target: NDArray[np.int64]  # (n,) index of the declared target


class Problem(NamedTuple):
    """A scene as every tracer takes it."""

    bed: Bed
    solids: Solids
    reflectivity: NDArray[np.float64]  # (n, 3) diffuse, specular, shininess
    law: int  # LIGHT or SONAR
    half_width: float  # of the fan beam, rad; 0 for a knife
    bins: int  # per side
    bin_length: float  # true slant range that one bin spans, m
    range_factor: NDArray[np.float64]  # (bins,) spreading and absorption at the bin centres


class Poses(NamedTuple):
    """Where the sonar is at each ping."""

    x: NDArray[np.float64]  # (n,)
    y: NDArray[np.float64]  # (n,)
    z: NDArray[np.float64]  # (n,) above the datum
    heading: NDArray[np.float64]  # (n,) rad, counter-clockwise from +x; port is to the left


Array = NDArray[Any]
