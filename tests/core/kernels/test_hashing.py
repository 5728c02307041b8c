"""Hashed random numbers, and their streams: no two purposes share one."""

import itertools

import numpy as np
import pytest
from scipy import stats

from insonify.kernels.common import streams
from insonify.kernels.common.hashing import hash_integers, hash_uniform, splitmix64, unit_interval, wave_noise
from insonify.scene.receiver.speckles import Rayleigh
from insonify.scene.seabed.reliefs.fractal import Fractal


def test_splitmix64_gives_the_published_sequence():
    # First outputs of Vigna's reference implementation from state 1234567; the state moves by the golden gamma.
    state, gamma, outputs = 1234567, 0x9E3779B97F4A7C15, []
    for _ in range(5):
        outputs.append(int(splitmix64(np.uint64(state))))
        state = (state + gamma) % 2**64
    assert outputs == [
        6457827717110365317,
        3203168211198807973,
        9817491932198370423,
        4593380528125082431,
        16408922859458223821,
    ]


def test_uniform_numbers_fill_the_open_interval_and_depend_on_every_integer_and_its_place():
    assert unit_interval(np.uint64(0)) > 0.0
    assert unit_interval(np.uint64(2**64 - 1)) < 1.0
    numbers = np.array([[hash_uniform(1, 2, a, b, 0) for a in range(-70, 70)] for b in range(-70, 70)])
    assert stats.kstest(numbers.ravel(), "uniform").pvalue > 0.01
    for shifted in (numbers[1:, :] * numbers[:-1, :], numbers[:, 1:] * numbers[:, :-1]):
        assert shifted.mean() == pytest.approx(0.25, abs=0.01)
    keys = [*itertools.permutations((1, 2, 3, 4, 5)), (-1, 2, 3, 4, 5), (2**63 - 1, 2, 3, 4, 5)]
    assert len({int(hash_integers(*key)) for key in keys}) == len(keys)


@pytest.mark.parametrize("shape", [(16, 16), (15, 17), (1, 8), (8, 1)])
def test_noise_of_unit_modulus_is_zero_only_at_the_mean_and_nyquist(shape):
    noise = wave_noise(1, 1, *shape, False)
    present = np.ones(noise.shape, dtype=bool)
    present[0, 0] = False
    if shape[0] % 2 == 0:
        present[shape[0] // 2] = False
    if shape[1] % 2 == 0:
        present[:, shape[1] // 2] = False
    np.testing.assert_allclose(np.abs(noise), present, atol=1e-15)


def test_gaussian_noise_has_unit_power_and_exponential_intensity():
    noise = wave_noise(1, 1, 128, 128, True)[1:64, 1:64].ravel()
    assert stats.kstest(np.abs(noise) ** 2, "expon").pvalue > 0.01
    assert stats.kstest(np.angle(noise) / np.pi, "uniform", (-1, 2)).pvalue > 0.01


def test_no_two_purposes_share_a_stream():
    steps = ("RELIEF_PART", "RELIEF_BAND")
    numbers = [value for name, value in vars(streams).items() if name.isupper() and name not in steps]
    assert len(numbers) > 10
    assert len(set(numbers)) == len(numbers)
    looks = next(bound.le for bound in Rayleigh.model_fields["looks"].metadata if hasattr(bound, "le"))
    assert not set(range(streams.SPECKLE + 1, streams.SPECKLE + looks)) & set(numbers)
    # Parts and bands of relief begin beyond all other streams, and bands end before the next part.
    assert max(numbers) < streams.RELIEF_BAND
    peaks = next(bound.max_length for bound in Fractal.model_fields["peaks"].metadata if hasattr(bound, "max_length"))
    bands = 2 * peaks  # every peak may be mirrored into the other quadrants
    # The last field of the last band may share the number of the next part, whose lattice has another spacing.
    assert streams.RELIEF_BAND * (2 * (bands - 1) + 1 + 1) <= streams.RELIEF_PART
