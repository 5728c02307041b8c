"""Streams of random numbers: no two purposes share one."""

from insonify.kernels.common import streams
from insonify.scene.receiver.speckles import Rayleigh
from insonify.scene.seabed.reliefs.fractal import Fractal

STEPS = ("RELIEF_PART", "RELIEF_BAND")


def named():
    return {name: value for name, value in vars(streams).items() if name.isupper() and name not in STEPS}


def test_no_stream_is_used_twice():
    numbers = list(named().values())
    assert len(numbers) > 10
    assert len(set(numbers)) == len(numbers)


def test_looks_reach_no_other_stream():
    most = next(bound.le for bound in Rayleigh.model_fields["looks"].metadata if hasattr(bound, "le"))
    assert not set(range(streams.SPECKLE + 1, streams.SPECKLE + most)) & set(named().values())


def test_parts_and_bands_of_relief_reach_no_other_stream():
    assert max(named().values()) < streams.RELIEF_BAND
    peaks = next(bound.max_length for bound in Fractal.model_fields["peaks"].metadata if hasattr(bound, "max_length"))
    bands = 2 * peaks  # every peak may be mirrored into the other quadrants
    # The last field of the last band may share the number of the next part, whose lattice has another spacing.
    assert streams.RELIEF_BAND * (2 * (bands - 1) + 1 + 1) <= streams.RELIEF_PART
