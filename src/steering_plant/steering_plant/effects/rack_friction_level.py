"""The rack's friction without pressure is higher or lower than the data sheet says."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="rack_friction_level",
    summary="the rack's friction without pressure is higher or lower",
    sees="a wider hysteresis of torque against angle on-centre, alike at all pressures",
    equation="F_lim = factor F_0 + slope (p_left + p_right)",
    source="P. Pfeffer and M. Harrer, Steering Handbook (2017), chapter on steering feel",
    balance="rack force",
    excitation="slow reversals of the rack below 20 bar",
    separating="slow triangles of angle at low and at high load pressure",
    parameters={"factor": Parameter("level over the data sheet's", "1", 1, 0.05, 10, 2)},
    sets={"factor": factor_of("mechanics.rack_friction")},
)
