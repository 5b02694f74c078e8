"""The solenoids' force lags behind its command."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter, State


@kernel
def left_solenoid_force(value, left_force, time_constant):
    """Return the left solenoid's force [N]."""
    return left_force if time_constant > 0.0 else value


@kernel
def right_solenoid_force(value, right_force, time_constant):
    """Return the right solenoid's force [N]."""
    return right_force if time_constant > 0.0 else value


@kernel
def left_rate(left_solenoid, left_force, time_constant):
    """Return the rate of the left force [N/s]."""
    return (left_solenoid - left_force) / time_constant if time_constant > 0.0 else 0.0


@kernel
def right_rate(right_solenoid, right_force, time_constant):
    """Return the rate of the right force [N/s]."""
    return (right_solenoid - right_force) / time_constant if time_constant > 0.0 else 0.0


EFFECT = Effect(
    name="solenoid_lag",
    summary="the solenoids' force follows its command with a first-order lag",
    sees="chamber pressures late behind the commands, alike at all pressures and both directions",
    equation="tau F' = F_command - F",
    source="outlook of the source, chapters 9 and 11: a solenoid adds a time lag",
    balance="valve spool",
    valve_systems=("closed_centre",),
    separating="steps of command against a blocked rack, up and down",
    excitation="commands that change within a few milliseconds",
    parameters={"time_constant": Parameter("of the lag", "s", 0, 0, 0.02, 0.002)},
    slots={"left_solenoid": left_solenoid_force, "right_solenoid": right_solenoid_force},
    states={
        "left_force": State("left_solenoid", left_rate),
        "right_force": State("right_solenoid", right_rate),
    },
    adds_energy=True,
)
