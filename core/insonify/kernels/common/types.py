"""Arrays and numbers of a scene in metres and radians, as all kernels take them.

Heights are metres above the *datum*, the mean bed, so that float32 is precise enough at any depth. x and y are the
scene's own local coordinates.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LIGHT, SONAR = 0, 1
PORT, STARBOARD = 0, 1
SPHERE, FRUSTUM = 0, 1
EVERY_GRAZING, TOP_HAT, GAUSSIAN, TABLE = 0, 1, 2, 3
BED = -1


class Bed(NamedTuple):
    """A bilinear height field; NaN marks nodes without a bed."""

    heights: NDArray[np.float32]  # (ny, nx), node (j, i) at (x0 + i spacing, y0 + j spacing)
    transposed: NDArray[np.float32]  # (nx, ny), the same heights laid out the other way
    materials: NDArray[np.uint8]  # (ny, nx), of the cell with its low corner at node (j, i)
    x0: float
    y0: float
    spacing: float
    periodic: bool  # whether node nx is node 0 again, and node ny too
    low: float  # lowest height, NaN apart
    high: float  # highest height, NaN apart
    mapped: bool = True  # whether there is more than one material


class SegmentLimits(NamedTuple):
    """How far a segment of the bed's profile may extend before it is divided."""

    shininess: float  # greatest exponent of the specular lobes of its materials, 0 where none has a lobe
    bin_length: float  # slant range of one bin, m
    angle: float  # greatest angle it may span at the sonar, rad
    misplaced: float  # greatest share of a bin's echo that a segment may add wrongly; infinite for no limit
    linear: bool  # whether the echoes of whole segments along planes oblique to the grid have linear densities


class Solids(NamedTuple):
    """Analytic convex bodies, one row each; a pipe is a chain of cylinders jointed by spheres."""

    shape: NDArray[np.int64]  # (n,) SPHERE or FRUSTUM: a cylinder, or a cone, or a part of one
    start: NDArray[np.float64]  # (n, 3) centre of a sphere, or of a frustum's first end
    axis: NDArray[np.float64]  # (n, 3) unit vector along a frustum, zero for a sphere
    length: NDArray[np.float64]  # (n,) of a frustum, 0 for a sphere
    radius: NDArray[np.float64]  # (n,) of a sphere, or of a frustum's first end
    taper: NDArray[np.float64]  # (n,) by which the radius grows per metre along the axis, 0 for a cylinder and a sphere
    material: NDArray[np.int64]  # (n,) row of the reflectivity table
    target: NDArray[np.int64]  # (n,) index of the declared target


class Mesh(NamedTuple):
    """Triangles of all targets that have any, in the order of the bounding volume hierarchy over them.

    The hierarchy lies in depth-first order: a search that enters node i continues with i + 1, one that passes it with
    ``skip[i]``; it is over at the number of nodes.
    """

    corners: NDArray[np.float64]  # (n, 3, 3) of each triangle, counter-clockwise from outside
    normal: NDArray[np.float64]  # (n, 3) unit vectors
    material: NDArray[np.int64]  # (n,) row of the reflectivity table
    target: NDArray[np.int64]  # (n,) index of the declared target
    closed: NDArray[np.bool_]  # (n,) whether it bounds a body, so that its back is never seen from outside
    low: NDArray[np.float64]  # (nodes, 3) corner of each node's box
    high: NDArray[np.float64]  # (nodes, 3) and the opposite one
    skip: NDArray[np.int64]  # (nodes,) node after this one's whole branch
    first: NDArray[np.int64]  # (nodes,) first triangle of the branch
    leaf_size: NDArray[np.int64]  # (nodes,) triangles of a leaf, 0 for an inner node


class BeamPattern(NamedTuple):
    """Two-way sensitivity of the beam by direction and slant range.

    Directions are given by s, the sine of their angle from the plane athwart the fish, positive towards its bow: lines
    of equal s are cones about its axis. Rows belong to slant ranges, for near a long array the beam is wider.
    """

    tabulated: bool  # whether it differs from a level fish's top-hat about athwart, alike at every grazing angle
    centre: float  # s of the beam's axis: the sine of its squint
    extent: NDArray[np.float64]  # (rows,) a row spans centre - extent to centre + extent; beyond it the response is 0
    energy: NDArray[np.float64]  # (rows, columns) sensitivity at equal steps of s, 1 on the axis far away
    integral: NDArray[np.float64]  # (rows, columns) its integral over s from the row's beginning
    first_range: float  # slant range of row 0, m
    per_octave: float  # rows per doubling of slant range; nearer and farther the outermost rows apply
    vertical: int  # EVERY_GRAZING, TOP_HAT, GAUSSIAN or TABLE
    tilt: float  # depression of the vertical beam's axis, rad
    s_vertical: float  # sine of half its width, to -3 dB one way for a Gaussian; 1 for a table
    two_way: bool  # whether the beam weights both the outgoing and the returning sound
    vertical_energy: NDArray[np.float64] = np.ones(2)  # (n,) of a TABLE: at equal sines above its axis, from -1 to 1


def plain_pattern() -> BeamPattern:
    """Return the pattern of a level top-hat or knife, which its half width alone describes."""
    one = np.ones((1, 1))
    return BeamPattern(False, 0.0, one[0], one, one, 1.0, 1.0, EVERY_GRAZING, 0.0, 1.0, True)


class Water(NamedTuple):
    """Speed of sound: linear between nodes of height and between stations, constant beyond the outermost of both."""

    bent: bool  # whether sound bends; if not, the reference speed holds everywhere
    height: NDArray[np.float64]  # (n,) nodes, ascending, m
    speed: NDArray[np.float64]  # (stations, n) m/s
    station: NDArray[np.float64]  # (stations,) places along the axis, ascending, m; layered water has one
    axis_x: float  # level unit vector along which the stations lie
    axis_y: float
    reference: float  # speed at the sonar: slant range is one-way travel time times this, m/s
    surface: float  # height of the sea surface, m
    wavelength: float = 0.0  # of the sound at the sonar, m: sets the width of caustics; 0 for rays alone


def still_water(speed: float = 1500.0, surface: float = 0.0) -> Water:
    """Return water of one speed, m/s, in which sound goes straight, below a surface at a height above the datum, m."""
    return Water(False, np.zeros(1), np.full((1, 1), speed), np.zeros(1), 1.0, 0.0, speed, surface)


class SurfaceMultipath(NamedTuple):
    """Propagation paths by way of the sea surface that are traced, and how its waves spread their echoes in range."""

    enabled: bool  # whether any is
    surface_bottom: bool
    surface_bottom_surface: bool
    second_bottom: bool
    surface_echo: bool
    rms_height: float  # of the waves, m
    slope_variance: float  # of the waves, along one direction
    facets: NDArray[np.float64]  # (2, n, 4) of one pass and of two: each facet's ends of height and of squared tilt


def no_surface_multipath() -> SurfaceMultipath:
    """Return the settings of a sea without surface multipath."""
    return SurfaceMultipath(False, False, False, False, False, 0.0, 0.0, np.zeros((2, 1, 4)))


class RangeDecay(NamedTuple):
    """How spreading and absorption decrease with slant range."""

    spreading: float  # power of slant range
    loss: float  # relative decrease per bin by absorption


NO_DECAY = RangeDecay(0.0, 0.0)


class SceneArrays(NamedTuple):
    """Arrays of one scene, packed from its declarations, as every tracer takes them."""

    bed: Bed
    solids: Solids
    mesh: Mesh
    reflectivity: NDArray[np.float64]  # (n, 3) diffuse, specular, shininess
    interface: NDArray[np.float64]  # (n, 2) reflection coefficient of amplitude, and speed of sound over that of water
    law: int  # LIGHT or SONAR
    half_width: float  # of a top-hat beam, or of what a pattern's main lobe spans, rad; 0 for a knife
    pattern: BeamPattern
    bins: int  # per side
    bin_length: float  # true slant range that one bin spans, m
    range_factor: NDArray[np.float64]  # (bins,) spreading and absorption, their mean over each bin
    range_decay: RangeDecay
    limits: SegmentLimits
    bounces: int = 0  # specular reflections and transmissions followed after the first echo
    water: Water = still_water()
    multipath: SurfaceMultipath = no_surface_multipath()


class Poses(NamedTuple):
    """Position and attitude of the sonar at each ping."""

    x: NDArray[np.float64]  # (n,)
    y: NDArray[np.float64]  # (n,)
    z: NDArray[np.float64]  # (n,) above the datum
    heading: NDArray[np.float64]  # (n,) rad, counter-clockwise from +x; port is to the left
    pitch: NDArray[np.float64]  # (n,) rad, bow up
    roll: NDArray[np.float64]  # (n,) rad, port up
