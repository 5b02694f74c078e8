"""What is known of noise: an error far above it is structure, what the inputs shake is none."""

from __future__ import annotations

import numpy as np
import pytest

from steering_diagnosis.engine.model import Output
from steering_diagnosis.engine.structure import LOUD, Remains, structures

SAMPLES, BLOCKS = 3000, 30
TIME = np.arange(SAMPLES) * 5e-3
OWN = 0.02
"""Mean square of the output's own noise."""


def found(residual, shaken=0.0, own=OWN, state=None):
    """Return the kinds of structure in a residual beside a state, unrelated unless given."""
    if state is None:
        state = np.sin(2.0 * np.pi * 0.31 * TIME) * moving()
    remains = Remains(
        (Output("pressure", "Pa", "left chamber"),),
        residual[:, None],
        np.ones((SAMPLES, 1), bool),
        np.arange(SAMPLES) * BLOCKS // SAMPLES,
        {"rack position [m]": state},
        np.array([1e-3]),
        8,
        1.0,
        np.broadcast_to(np.reshape(shaken, (-1, 1)), (SAMPLES, 1)),
        np.array([own]),
    )
    return [s.kind for s in structures(remains)]


def moving():
    """Return a manoeuvre that comes and goes."""
    return np.maximum(np.sin(2.0 * np.pi * TIME / 7.0), 0.0)


def slow(seed):
    """Return a slow error of unit size that depends on nothing that is known."""
    walk = np.random.default_rng(seed).standard_normal(SAMPLES).cumsum()
    walk -= np.convolve(np.pad(walk, 200, mode="edge"), np.ones(401) / 401, mode="valid")
    return walk / walk.std()


@pytest.mark.parametrize(("size", "expected"), [(0.6, []), (1.5, ["loud"])])
def test_an_error_far_above_known_noise_is_structure(size, expected):
    white = np.sqrt(OWN) * np.random.default_rng(1).standard_normal(SAMPLES)
    error = size * LOUD * np.sqrt(OWN) * slow(2)
    assert found(white + error) == expected


def test_nothing_is_loud_where_no_noise_is_known():
    assert found(5.0 * slow(2), own=0.0) == []


def test_what_the_inputs_noise_does_while_the_gear_moves_comes_and_goes_by_right():
    random = np.random.default_rng(3)
    white = np.sqrt(OWN) * random.standard_normal(SAMPLES)
    draws = 1.5 * moving() * random.standard_normal((2, SAMPLES))
    assert found(white + draws[0], shaken=draws[1]) == []
    assert found(white + draws[0]) == ["bursts"]


def test_the_replay_s_own_states_predict_what_the_inputs_noise_does():
    """A rack that rings with its load cell's noise: the state has the ringing, measured or not."""
    random = np.random.default_rng(4)
    white = np.sqrt(OWN) * random.standard_normal(SAMPLES)
    ringing = 0.25 * (slow(5) + 0.3 * random.standard_normal(SAMPLES))
    assert found(white + ringing, state=ringing) == ["predictable"]
    assert found(white + ringing, shaken=0.25 * slow(6), state=ringing) == []
