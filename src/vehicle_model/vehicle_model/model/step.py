"""One tick of the vehicle."""

from __future__ import annotations

import math

import numpy as np

from steering_core.compiled import kernel

from . import slots


@kernel
def vehicle_step(
    par: np.ndarray,
    external: np.ndarray,
    e: np.ndarray,
    state: np.ndarray,
    out: np.ndarray,
    tick: int,
    x: float,
    v: float,
    F: float,
) -> None:
    """Move the vehicle to ``tick`` and write the rack's load to ``out``, [N, N/m, m].

    ``x`` [m] is the measured rack displacement of the same tick; rack speed ``v`` and force ``F``
    are measured too, but not needed. ``external`` [N] holds one rack force for each tick, the last
    one is kept past the end. Every kind of load runs through these lines: the kinds differ in the
    constants alone. All terms are odd in x, so that left and right mirror each other exactly.
    """
    p = par[0]
    if tick > 0:
        _advance(par, state, x)
    state[5] = x
    if p.wind_force != 0.0:
        risen = (tick * p.period - p.wind_start) / p.wind_rise
        state[6] = p.wind_force * min(max(risen, 0.0), 1.0)
    tyres = (
        p.force_by_sideslip * state[0] + p.force_by_curvature * state[1] + p.force_by_position * x
    )
    distance = p.speed * p.period
    if tick > 0:
        slots.next_states(tyres, distance, state, e)
    tyres = slots.rack_force(tyres, distance, state, e)
    out[0] = tyres + external[min(tick, external.shape[0] - 1)]
    out[1] = slots.stiffness(p.stiffness, distance, state, e)
    out[2] = x


@kernel
def _advance(par: np.ndarray, state: np.ndarray, x: float) -> None:
    p = par[0]
    sideslip, curvature, heading, position = state[0], state[1], state[2], state[5]
    rise = x - position
    state[0] = (
        p.sideslip_by_sideslip * sideslip
        + p.sideslip_by_curvature * curvature
        + p.sideslip_by_position * position
        + p.sideslip_by_rise * rise
    )
    state[1] = (
        p.curvature_by_sideslip * sideslip
        + p.curvature_by_curvature * curvature
        + p.curvature_by_position * position
        + p.curvature_by_rise * rise
    )
    state[2] = heading + (
        p.heading_by_sideslip * sideslip
        + p.heading_by_curvature * curvature
        + p.heading_by_position * position
        + p.heading_by_rise * rise
    )
    wind = state[6]
    if wind != 0.0:
        state[0] += p.sideslip_by_wind * wind
        state[1] += p.curvature_by_wind * wind
        state[2] += p.heading_by_wind * wind
    # The path is the one nonlinear part: trapezoidal rule, nanometres a tick at 70 km/h.
    half = 0.5 * p.period * p.speed
    cos0, sin0 = math.cos(heading), math.sin(heading)
    cos1, sin1 = math.cos(state[2]), math.sin(state[2])
    state[3] += half * ((cos0 - sideslip * sin0) + (cos1 - state[0] * sin1))
    state[4] += half * ((sin0 + sideslip * cos0) + (sin1 + state[0] * cos1))
