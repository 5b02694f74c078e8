"""The solenoids' force depends on where the command came from.

A play between command and force. It is moved on once a tick, as the command is, and is exact.
"""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter, State


@kernel
def left_command(value, left_held):
    """Return the left valve's command as it acts [N]."""
    return left_held


@kernel
def right_command(value, right_held):
    """Return the right valve's command as it acts [N]."""
    return right_held


@kernel
def left_play(left_solenoid, left_held, width):
    """Return what acts over the coming tick [N]."""
    return min(max(left_held, left_solenoid - 0.5 * width), left_solenoid + 0.5 * width)


@kernel
def right_play(right_solenoid, right_held, width):
    """Return what acts over the coming tick [N]."""
    return min(max(right_held, right_solenoid - 0.5 * width), right_solenoid + 0.5 * width)


EFFECT = Effect(
    name="solenoid_hysteresis",
    summary="the solenoids' force depends on where the command came from",
    sees="pressure against command is a loop of constant width, alike at all speeds",
    equation="F = clip(F_before, F_command - width/2, F_command + width/2)",
    source="A. Visintin, Differential Models of Hysteresis (1994), chapter III: play",
    balance="valve spool",
    excitation="slow reversals of the commanded pressures",
    separating="slow triangles of command against a blocked rack, with and without dither",
    valve_systems=("closed_centre",),
    parameters={"width": Parameter("rising minus falling command", "N", 0, 0, 10, 1, shape=True)},
    slots={"left_command": left_command, "right_command": right_command},
    states={
        "left_held": State("left_solenoid", left_play, sampled=True),
        "right_held": State("right_solenoid", right_play, sampled=True),
    },
    adds_energy=True,
)
