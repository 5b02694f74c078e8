"""The pump delivers more or less than the data sheet says."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="pump_flow_level",
    summary="the pump delivers more or less",
    sees="pump and load pressures change with the square of the flow, at all torques",
    equation="q_p = factor q_0",
    source="J. and M. Ivantysynova, Hydrostatic Pumps and Motors (2001): volumetric losses",
    balance="supply",
    excitation="torsion-bar torque above 2 N m, or the pump's pressure at rest",
    separating="fast ramps of angle: the flow limits the rack's speed",
    valve_systems=("open_centre",),
    parameters={"factor": Parameter("over the data sheet's", "1", 1, 0.3, 2, 0.88)},
    sets={"factor": factor_of("open_centre.pump_flow")},
)
