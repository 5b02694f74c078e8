"""The supply's pressure falls with the flow that is drawn."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter, State


@kernel
def supply_pressure(value, drop):
    """Return the pressure at the valves' inlet [Pa]."""
    return value - drop


@kernel
def drop_rate(drop, supply_flow, resistance, time_constant):
    """Return the rate of the pressure's drop [Pa/s]."""
    return (resistance * supply_flow - drop) / time_constant


EFFECT = Effect(
    name="supply_pressure_droop",
    summary="the supply's pressure falls with the flow that is drawn",
    sees="supply pressure dips while the rack moves fast, and comes back",
    equation="p_s = p_0 - d, time_constant d' = resistance q_s - d",
    source="H. E. Merritt, Hydraulic Control Systems (1967), hydraulic power supplies",
    balance="supply",
    excitation="rack speeds above 20 mm/s",
    separating="fast ramps of angle in both directions",
    valve_systems=("closed_centre", "servo_valve"),
    competes=("closed_centre.supply_pressure",),
    parameters={
        "resistance": Parameter("pressure over flow", "Pa s/m3", 0, 0, 5e11, 3e10),
        "time_constant": Parameter("to 63 % of it", "s", 0.02, 1e-3, 1, 0.02, shape=True),
    },
    slots={"supply_pressure": supply_pressure},
    states={"drop": State(0.0, drop_rate, tolerance=50.0)},
)
