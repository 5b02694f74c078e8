"""Prediction across a known delay (after Smith): what the loop will have answered by itself.

The compensator cancels the valve, so without delay the loop would answer an error e as

    w_k^2/(s (s + a)) e = r_1/s e - (r_1/a) a/(s + a) e,    r_1/a = 1/(4 d_k^2)

with the compensator's own low-pass in it. What it answers to the errors of the last ticks, those
whose commands are still on their way, is pending: it is taken off the error, and the loop is that
without delay, behind the delay. The flow's feed-forward is left out: it moves no pressure.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from pressure_control.state_places import ANSWER, FILTERED, LONGEST
from steering_core.compiled import kernel


@kernel
def pending_answer(p: Any, state: np.ndarray, tick: int) -> float:
    """Return the answer [Pa] that is still on its way at ``tick``, and keep the present one."""
    answer = state[ANSWER] - 0.25 / (p.damping * p.damping) * state[FILTERED]
    late = state[ANSWER + 1 + (tick - int(p.delay_compensation)) % LONGEST]
    state[ANSWER + 1 + tick % LONGEST] = answer
    return float(answer - late)
