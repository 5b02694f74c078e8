"""What a rig does not measure: groups of channels that a case may lack, drawn from its seed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from steering_core.errors import BenchError
from steering_core.naming import unknown

LACKABLE: Mapping[str, tuple[str, ...]] = {
    "load_command": ("load_force", "load_stiffness", "load_position"),
    "speeds": ("steering_wheel_speed", "rack_speed"),
    "driver_torque": ("driver_torque",),
    "valve_commands": (
        "left_reference_pressure",
        "left_solenoid_force",
        "right_reference_pressure",
        "right_solenoid_force",
    ),
    "left_pressure": ("left_pressure",),
    "right_pressure": ("right_pressure",),
}
"""Groups to their channels."""

RIG = ("load_command", "speeds", "driver_torque", "valve_commands")
"""What a rig with seven sensors lacks; angle, torque, three pressures, position, force remain."""

NONE = "none"
"""Word for no group: all channels are measured."""

CHAMBERS = ("left_pressure", "right_pressure")
ALL_MEASURED, AS_A_RIG = 0.25, 0.25
"""Shares of cases with all channels and with a rig's seven; the others lack one or two groups."""


def draw_lacking(random: np.random.Generator) -> tuple[str, ...]:
    """Return the groups that a case lacks."""
    which = random.uniform()
    count, chamber = int(random.integers(1, 3)), str(random.choice(CHAMBERS))
    groups = [*RIG, chamber]
    chosen = [groups[i] for i in random.permutation(len(groups))[:count]]
    if which < ALL_MEASURED:
        return ()
    return (
        RIG if which < ALL_MEASURED + AS_A_RIG else checked(chosen[:1] if both(chosen) else chosen)
    )


def both(groups: Iterable[str]) -> bool:
    """Return whether valve commands and a chamber are lacking: then nothing tells the pressures."""
    groups = set(groups)
    return "valve_commands" in groups and bool(groups & set(CHAMBERS))


def checked(groups: Iterable[str]) -> tuple[str, ...]:
    """Return the groups in their order, none for "none".

    BenchError for an unknown one, or where too many lack.
    """
    asked = set(groups) - {NONE}
    for name in asked:
        if name not in LACKABLE:
            raise BenchError(unknown("group of channels", name, (NONE, *LACKABLE)))
    if both(asked):
        raise BenchError("without valve_commands both chamber pressures must be measured")
    return tuple(name for name in LACKABLE if name in asked)


def lacking_in(system: str, groups: Iterable[str]) -> tuple[str, ...]:
    """Return the groups that a gear could have: an open-centre valve has no commands."""
    return tuple(g for g in groups if g != "valve_commands" or system == "closed_centre")


def measured(channels: Mapping[str, np.ndarray], groups: Iterable[str]) -> dict[str, np.ndarray]:
    """Return the channels without those of ``groups``."""
    gone = {name for group in groups for name in LACKABLE[group]}
    return {name: values for name, values in channels.items() if name not in gone}
