"""Explicit Runge-Kutta 5(4) of Dormand and Prince inside one tick, inputs held.

The inner step follows the local error, and with it the stiffness: 2 steps a tick while driving
on-centre with the closed-centre system, more where a spool stands wide open. It depends on nothing
but the state, so a run repeats to the bit. The last step's size travels with the state from tick
to tick.
"""

from __future__ import annotations

import math

from steering_core.compiled import kernel

from .dynamics import possible, rates, settle

WORK_ROWS = 9
"""Rows of the work array: seven slopes, a trial state and the stage's state."""

OK, NOT_FINITE, STEP_TOO_SMALL = 0, 1, 2
SMALLEST_STEP = 1e-9
MOST_STEPS = 20000
SAFETY, LEAST_FACTOR, GREATEST_FACTOR = 0.9, 0.2, 4.0
SMALL_ERROR = (SAFETY / GREATEST_FACTOR) ** 5

A21 = 1 / 5
A31, A32 = 3 / 40, 9 / 40
A41, A42, A43 = 44 / 45, -56 / 15, 32 / 9
A51, A52, A53, A54 = 19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729
A61, A62, A63, A64, A65 = 9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656
B1, B3, B4, B5, B6 = 35 / 384, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84
E1, E3, E4, E5, E6, E7 = 71 / 57600, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40
C2, C3, C4, C5 = 1 / 5, 3 / 10, 4 / 5, 8 / 9


@kernel
def trial_step(p, table, e, time, h, y, u, k1, k2, k3, k4, k5, k6, k7, new, at, flows):
    """Fill ``new`` with the state after a step ``h`` from ``y`` and ``k7`` with its slope.

    ``k1`` holds the slope at ``y`` on entry; ``at`` takes the stages' states.
    """
    n = y.shape[0]
    for i in range(n):
        at[i] = y[i] + h * (A21 * k1[i])
    rates(p, table, e, time + C2 * h, at, u, k2, flows)
    for i in range(n):
        at[i] = y[i] + h * (A31 * k1[i] + A32 * k2[i])
    rates(p, table, e, time + C3 * h, at, u, k3, flows)
    for i in range(n):
        at[i] = y[i] + h * (A41 * k1[i] + A42 * k2[i] + A43 * k3[i])
    rates(p, table, e, time + C4 * h, at, u, k4, flows)
    for i in range(n):
        at[i] = y[i] + h * (A51 * k1[i] + A52 * k2[i] + A53 * k3[i] + A54 * k4[i])
    rates(p, table, e, time + C5 * h, at, u, k5, flows)
    for i in range(n):
        slope = A61 * k1[i] + A62 * k2[i] + A63 * k3[i] + A64 * k4[i] + A65 * k5[i]
        at[i] = y[i] + h * slope
    rates(p, table, e, time + h, at, u, k6, flows)
    for i in range(n):
        slope = B1 * k1[i] + B3 * k3[i] + B4 * k4[i] + B5 * k5[i] + B6 * k6[i]
        new[i] = y[i] + h * slope
    rates(p, table, e, time + h, new, u, k7, flows)


@kernel
def error_norm(scale, h, k1, k3, k4, k5, k6, k7):
    """Return the largest local error over its tolerance ``scale`` (absolute, by state)."""
    worst = 0.0
    for i in range(scale.shape[0]):
        slope = E1 * k1[i] + E3 * k3[i] + E4 * k4[i] + E5 * k5[i] + E6 * k6[i] + E7 * k7[i]
        if abs(slope) > worst * scale[i]:
            worst = abs(slope) / scale[i]
    return h * worst


@kernel
def advance(p, table, e, scale, time, span, y, step, u, work, flows):
    """Integrate ``y`` in place over ``span`` seconds with held inputs ``u``; return a status.

    scale: error tolerance by state, shape (n,). step: shape (1,), inner step to begin with [s],
    replaced by the one to go on with. With p.inner_steps > 0 that many equal steps are taken
    instead. Status OK, NOT_FINITE or STEP_TOO_SMALL; on failure ``y`` is the last good state.
    """
    k1, k2, k3, k4, k5 = work[0], work[1], work[2], work[3], work[4]
    k6, k7, new, at = work[5], work[6], work[7], work[8]
    fixed = int(p.inner_steps)
    done = 0.0
    rates(p, table, e, time, y, u, k1, flows)
    for count in range(MOST_STEPS):
        if fixed > 0:
            if count == fixed:
                return OK
            h = span / fixed
        else:
            h = (span - done) / math.ceil((span - done) / step[0] * (1.0 - 1e-9))
        trial_step(p, table, e, time + done, h, y, u, k1, k2, k3, k4, k5, k6, k7, new, at, flows)
        fine = possible(p, new)
        if fixed > 0 and not fine:
            return NOT_FINITE
        if fixed == 0:
            error = error_norm(scale, h, k1, k3, k4, k5, k6, k7) if fine else math.inf
            if not error <= 1.0:
                step[0] = h * max(LEAST_FACTOR, SAFETY * error**-0.2 if fine else 0.0)
                if step[0] < SMALLEST_STEP:
                    return STEP_TOO_SMALL if fine else NOT_FINITE
                continue
            growth = SAFETY * error**-0.2 if error > SMALL_ERROR else GREATEST_FACTOR
            step[0] = min(h * growth, p.longest_step)
        done += h
        for i in range(y.shape[0]):
            y[i], k1[i] = new[i], k7[i]
        settle(p, e, y)
        if fixed == 0 and span - done <= 1e-12 * span:
            return OK
    return STEP_TOO_SMALL
