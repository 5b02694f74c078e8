"""The orifices pass more or less flow than the data sheet says."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="orifice_flow_coefficient",
    summary="the orifices pass more or less flow at the same pressure drop",
    sees="open centre: all pressures change alike; closed centre: another droop with load flow",
    equation="q = factor C_q A sqrt(2 dp/rho)",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 3: flow through orifices",
    balance="valve flow",
    excitation="load flow, or torsion-bar torque above 2 N m",
    separating="the pump's pressure at rest, at two pump flows",
    competes=("oil.density", "open_centre.boost_scale"),
    parameters={"factor": Parameter("over the data sheet's", "1", 1, 0.4, 1.6, 0.85)},
    sets={"factor": factor_of("oil.flow_coefficient")},
)
