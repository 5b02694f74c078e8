"""Force control of the rig's load cylinder (section 7.1).

    G(s) = K_p0 (1 + tau s)/(gamma + tau s)                                   (7.4)

The servo valve's flow fills an oil spring, so valve opening to force is nearly an integrator (7.2
with a small K_c), K_q A 2 beta/V. A lag would turn its phase further back; what the spools' 250 Hz
and the sampling take away is given back by a lead, which in (7.4) means gamma above 1. The piston's
speed disturbs the force (A_p X s in 7.2); the rack's measured speed is fed forward, which (7.4)
lacks; where it comes late, a low-pass keeps it off the oil springs' resonance.
"""

from __future__ import annotations

import math

import numpy as np

from pressure_control.lead import sampled_lead
from pressure_control.limits import bounded
from pressure_control.reference import SPEED_LIMIT
from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet, record
from steering_core.ticks import TICK_PERIOD

FORCE_LIMIT = 1e5
"""Largest force [N] that is asked for or believed."""

SMALLEST_DROP = 0.1
"""Pressure drop over that without load, down to which the valve's loss of gain is made up for."""


@kernel
def load_force_step(
    par: np.ndarray,
    state: np.ndarray,
    out: np.ndarray,
    tick: int,
    rack_x: float,
    rack_v: float,
    rack_force: float,
    force: float,
    stiffness: float,
    position: float,
) -> None:
    """Advance one tick: out = [wanted load force N, valve opening -1 to 1].

    rack_*: as measured; the wanted load is force + stiffness (rack_x - position).
    """
    p = par[0]
    wanted = bounded(force + stiffness * (rack_x - position), -FORCE_LIMIT, FORCE_LIMIT)
    made = bounded(rack_force, -FORCE_LIMIT, FORCE_LIMIT)
    error = wanted - made
    led = p.lead_gain * error + state[0]
    state[0] = p.lead_pole * led - p.lead_gain * p.lead_zero * error
    state[1] += p.speed_weight * (bounded(rack_v, -SPEED_LIMIT, SPEED_LIMIT) - state[1])
    unloaded = p.force_gain * led - p.forward_gain * state[1]
    # The load takes from the pressure drop over the open edges, or adds to it.
    share = made / p.largest_force if unloaded > 0.0 else -made / p.largest_force
    out[0] = wanted
    out[1] = bounded(unloaded / math.sqrt(max(1.0 - share, SMALLEST_DROP)), -1.0, 1.0)


class LoadForceController:
    """Force controller of the load cylinder with its parameters and state; ``out`` at rest is 0."""

    def __init__(self, parameters: ParameterSet) -> None:
        self.par = load_force_record(parameters)
        self.state = np.zeros(2)
        self.out = np.zeros(2)

    def step(
        self,
        tick: int,
        rack_x: float,
        rack_v: float,
        rack_force: float,
        force: float,
        stiffness: float,
        position: float,
    ) -> np.ndarray:
        """Return ``out`` = [wanted load force N, valve opening -1 to 1] for one tick.

        Inputs: RackState as measured, then RackForce, the load that the cylinder is to make.
        """
        load_force_step(
            self.par,
            self.state,
            self.out,
            tick,
            rack_x,
            rack_v,
            rack_force,
            force,
            stiffness,
            position,
        )
        return self.out


def load_flow_gain(parameters: ParameterSet) -> float:
    """Return K_q [m3/s] of the load cylinder's valve, per share of its stroke, without load."""
    oil = parameters.group("oil")
    coefficient = oil["flow_coefficient"] * math.sqrt(2.0 / oil["density"])
    drop = 0.5 * parameters["load_cylinder.supply_pressure"]
    return coefficient * parameters["load_cylinder.full_opening"] * math.sqrt(drop)


def load_force_rate(parameters: ParameterSet) -> float:
    """Return A_p K_q 2 beta/V [N/s], the rate of the force of a clamped piston per opening."""
    cylinder = parameters.group("load_cylinder")
    spring = 2.0 * parameters["oil.bulk_modulus"] / cylinder["chamber_volume"]
    return cylinder["piston_area"] * load_flow_gain(parameters) * spring


def load_force_record(parameters: ParameterSet) -> np.ndarray:
    """Return the record, shape (1,), that ``load_force_step`` takes as ``par``.

    force_gain [1/N]: static gain K_p0/gamma of (7.4); forward_gain [s/m], and speed_weight of its
    low-pass; largest_force [N] of the supply on the piston.
    """
    p = parameters.group("load_force_controller")
    rate = 1.0 / p["lead_time"]
    lead = sampled_lead(rate, p["lead_ratio"] * rate)
    lowpass = p["speed_lowpass"]
    gain, area = p["gain"] / p["lead_ratio"], parameters["load_cylinder.piston_area"]
    return record(
        dict(zip(("lead_gain", "lead_zero", "lead_pole"), lead, strict=True))
        | {"force_gain": gain / load_force_rate(parameters)}
        | {"speed_weight": -math.expm1(-TICK_PERIOD / lowpass) if lowpass > 0.0 else 1.0}
        | {"forward_gain": p["speed_feed_forward"] * area / load_flow_gain(parameters)}
        | {"largest_force": area * parameters["load_cylinder.supply_pressure"]}
    )
