"""Distributions, and draws from them by hashing."""

import math
from typing import Literal

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError
from scipy import stats

from insonify.surveys.datasets.scenes import Draws, hash_share
from insonify.surveys.distributions import DISTRIBUTIONS, DistributionKind, Drawn
from own_things import forgetting

SHARES = (np.arange(10_000) + 0.5) / 10_000


def distribution(**fields):
    return TypeAdapter(Drawn).validate_python(fields)


def quantiles(made):
    return [made.quantile(share) for share in SHARES]


@pytest.mark.parametrize(
    ("fields", "known"),
    [
        ({"draw": "uniform", "low": 2.0, "high": 5.0}, stats.uniform(2.0, 3.0)),
        ({"draw": "log_uniform", "low": 0.1, "high": 10.0}, stats.loguniform(0.1, 10.0)),
        ({"draw": "normal", "mean": 1.0, "deviation": 2.0}, stats.norm(1.0, 2.0)),
        (
            {"draw": "normal", "mean": 1.0, "deviation": 2.0, "low": 0.0, "high": 2.0},
            stats.truncnorm(-0.5, 0.5, loc=1.0, scale=2.0),
        ),
    ],
)
def test_quantiles_are_those_of_scipy(fields, known):
    drawn = quantiles(distribution(**fields))
    np.testing.assert_allclose(drawn, known.ppf(SHARES), rtol=1e-9, atol=1e-9)


def test_integers_are_equally_often_and_both_bounds_are_reached():
    drawn = quantiles(distribution(draw="integers", low=-1, high=3))
    assert np.unique(drawn, return_counts=True)[1].tolist() == [2000] * 5
    assert {min(drawn), max(drawn)} == {-1, 3}


def test_a_choice_keeps_to_its_weights():
    drawn = quantiles(distribution(draw="choice", of=["a", "b", {"kind": "flat"}], weights=[1, 0, 3]))
    assert drawn.count("a") == 2500
    assert drawn.count({"kind": "flat"}) == 7500


def test_a_table_without_draw_is_a_value():
    assert distribution(kind="uniform", sound_speed=1500.0) == {"kind": "uniform", "sound_speed": 1500.0}


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        (
            {"draw": "beta"},
            "draw: 'beta' is not a known distribution; choose one of uniform, log_uniform,",
        ),
        ({"draw": "uniform", "low": 2.0}, "high: is missing; add it"),
        ({"draw": "uniform", "low": 2.0, "high": 1.0}, "low 2 is above high 1; swap them"),
        ({"draw": "log_uniform", "low": 0.0, "high": 1.0}, "low: 0.0 is out of bounds; give a value above 0"),
        ({"draw": "normal", "mean": 0.0, "deviation": 1.0, "low": 50.0}, "almost no value of mean"),
        ({"draw": "choice", "of": [1, 2], "weights": [1.0]}, "weights: there are 1 for 2 values; give one for each"),
        ({"draw": "integers", "low": 1, "high": 0.5}, "high: 0.5 is not a whole number"),
    ],
)
def test_a_mistake_is_told_in_a_sentence(fields, told):
    with pytest.raises(ValidationError, match=told.replace("(", "\\(")):
        distribution(**fields)


def test_one_new_class_adds_a_distribution():
    class Triangular(DistributionKind):
        kind: Literal["triangular"] = "triangular"

        def quantile(self, share: float) -> float:
            return math.sqrt(share)

    with forgetting(DISTRIBUTIONS, "triangular"):
        assert distribution(draw="triangular").quantile(0.25) == 0.5


def test_draws_are_independent_of_one_another_and_even():
    shares = np.array([[hash_share(7, number, path) for number in range(4000)] for path in ("a", "b")])
    assert stats.kstest(shares[0], "uniform").pvalue > 0.01
    assert abs(np.corrcoef(shares)[0, 1]) < 0.05
    assert hash_share(7, 0, "a") == shares[0, 0] != hash_share(8, 0, "a")


def test_what_is_drawn_is_recorded():
    draws = Draws(1, 0)
    value = draws.value("sonar.range", distribution(draw="uniform", low=10.0, high=20.0))
    assert draws.value("seed", 5) == 5
    assert draws.drawn == {"sonar.range": value}
