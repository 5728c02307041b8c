"""Echo of the sea surface straight above the sonar.

Theory: docs/theory/multipath.md.
"""

from __future__ import annotations

from insonify.compiler.jit import kernel_uncounted
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.common.types import LIGHT, SONAR
from insonify.kernels.multipath.echo_list import SurfaceEcho, deposit_echoes, list_echo
from insonify.kernels.multipath.image_sources import SURFACE_ECHO, height_delay, surface_image, tilt_delay
from insonify.kernels.rays.launch import orient_beam


@kernel_uncounted
def add_surface_echo(arrays, poses, ping, side, echoes, sink):
    """Add the echo of the sea surface straight above: of an image source twice as far away as the surface.

    It is 1 / (2d)² in the bin of the depth d, with the record's 1/d⁴ taken out; under law `light` it is the image of a
    lamp in a mirror.
    """
    image = surface_image(arrays, poses.z[ping])
    depth, law = image.above, arrays.law
    if not 0.0 < depth < arrays.bins * arrays.bin_length:
        return
    value = 1.0
    if arrays.pattern.tabulated:
        beam, fan = orient_beam(arrays, poses, ping, side), arrays.half_width > 0.0
        value = two_way_response(arrays.pattern, beam, fan, SONAR, 0.0, 0.0, 1.0, depth)
    energy = value if law == LIGHT else 0.25 * value * depth * depth
    rise = height_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.rms_height)
    tilt = tilt_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.slope_variance)
    n = list_echo(echoes, 0, SurfaceEcho(depth, depth, energy, rise, tilt, 0.0, 1.0, 0))
    deposit_echoes(echoes, n, arrays.multipath.facets[0], arrays.bin_length, SURFACE_ECHO, sink)
