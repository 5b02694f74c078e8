"""The seals' friction grows faster or slower with pressure."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="rack_friction_pressure_slope",
    summary="the rack's friction grows faster or slower with the chamber pressures",
    sees="hysteresis that is wider at high assistance and nominal on-centre",
    equation="F_lim = F_0 + factor slope (p_left + p_right)",
    source="H. K. Mueller and B. S. Nau, Fluid Sealing Technology (1998), pressed seals",
    balance="rack force",
    excitation="slow reversals of the rack at chamber pressures above 30 bar",
    separating="slow triangles of angle at low and at high load pressure",
    parameters={"factor": Parameter("slope over the data sheet's", "1", 1, 0.05, 10, 1.8)},
    sets={"factor": factor_of("mechanics.rack_friction_pressure_slope")},
)
