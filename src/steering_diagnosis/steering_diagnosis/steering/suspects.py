"""What a record can decide: nuisance parameters, hypotheses, and what is undecidable in it."""

from __future__ import annotations

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.engine.model import (
    Hypothesis,
    HypothesisParameter,
    Nuisance,
    Undecidable,
)
from steering_diagnosis.steering.drive import SENSORS, Drive
from steering_diagnosis.steering.outputs import LOAD_FRICTION, TYRES, Predicted
from steering_plant.effects import EFFECTS
from steering_plant.effects.base import Effect
from steering_plant.sensors import LONGEST_DELAY

COLUMN = (
    "mechanics.steering_wheel_inertia",
    "mechanics.steering_wheel_damping",
    "mechanics.column_friction",
    "mechanics.column_friction_angle",
)
"""Parameters of the column's balance: the wheel's motion is prescribed, nothing else feels them."""

RACK = (
    "mechanics.rack_mass",
    "mechanics.rack_damping",
    "mechanics.rack_friction",
    "mechanics.rack_friction_pressure_slope",
    "mechanics.rack_friction_displacement",
)
"""Parameters of the rack's balance alone: not felt where the rack's motion is prescribed."""

FELT = {
    "open_centre": ("mechanics.", "oil.", "open_centre."),
    "closed_centre": (
        "mechanics.",
        "oil.",
        "open_centre.chamber_volume",
        "closed_centre.",
        "pressure_control_valve.",
    ),
    "servo_valve": (
        "mechanics.",
        "oil.",
        "open_centre.chamber_volume",
        "closed_centre.",
        "servo_valve.",
    ),
}
"""Beginnings of the names of parameters that a valve system's plant feels."""

BOOST_FORMULA = ("open_centre.boost_scale", "open_centre.boost_rate")
EXACT = ("rack_mass", "torsion_bar_stiffness", "sensor_offset", "sensor_gain")
"""Parts of the names of effects whose formula is the only one there is."""

LOAD_CELL_DELAY, LATE = "rack_force_sensor.delay", 2e-3
"""An amplifier's and a converter's delay [s] that needs no explanation."""

LATEST = (LONGEST_DELAY - 1) * 1e-3
"""Longest delay of a sensor [s]."""

LEAST_SHARE = 0.02
"""Share of its nominal value below which a positive parameter is not taken."""

RACK_BALANCES = ("rack force",)
VALVE_BALANCES = (
    "valve flow",
    "valve spool",
    "supply",
    "left chamber continuity",
    "right chamber continuity",
    "chamber continuity",
)


def nuisances(drive: Drive, parameters: ParameterSet) -> tuple[Nuisance, ...]:
    """Return the toleranced parameters and sensor errors that the record can feel."""
    return (*_sheet(drive, parameters), *_sensors(drive, parameters))


def _sheet(drive: Drive, parameters: ParameterSet) -> list[Nuisance]:
    record = drive.record
    deaf: set[str] = set()
    if "driver_torque" not in record:
        deaf |= set(COLUMN)
    if drive.load == "none":
        deaf |= set(RACK)
    if record.boost_table is not None:
        deaf |= set(BOOST_FORMULA)
    found = []
    for name in parameters:
        info = parameters.info(name)
        felt = name.startswith(FELT[record.valve_system]) and name not in deaf
        hydraulic = not name.startswith("mechanics.")
        if info.tolerance > 0.0 and felt and (drive.valves or not hydraulic):
            value = parameters[name]
            found.append(_nuisance(parameters, name, info.unit, info.tolerance * abs(value)))
    return found


def _nuisance(parameters: ParameterSet, name: str, unit: str, tolerance: float) -> Nuisance:
    """Return a parameter of the data sheet as a nuisance, with the range that is checked there.

    A value that may not be below zero and is above it stays above a small share of itself: without
    any friction or volume the plant is another one. No sensor is later than its memory is long.
    """
    value, minimum = parameters[name], parameters.info(name).minimum
    low = 0.0 if minimum is None else minimum
    if value > 0.0 and low >= 0.0:
        low = max(low, LEAST_SHARE * value)
    high = LATEST if name.endswith(".delay") else np.inf
    return Nuisance(name, unit, value, tolerance, low, max(high, value))


def _sensors(drive: Drive, parameters: ParameterSet) -> list[Nuisance]:
    """Return offset and gain of each sensor, and how late a load cell is that drives the replay.

    A sensor of two channels is named once. Beside the load's command the cell's age is known.
    """
    found: dict[str, Nuisance] = {}
    for channel, made in MEASURED.items():
        if channel not in drive.record:
            continue
        for name, unit, tolerance in (("offset", made.unit, made.offset), ("gain", "1", made.gain)):
            full = f"{SENSORS[channel]}.{name}"
            if tolerance > 0.0 and full not in found:
                found[full] = _nuisance(parameters, full, unit, tolerance)
    if drive.load == "cell" and not drive.knows_load:
        found[LOAD_CELL_DELAY] = _nuisance(parameters, LOAD_CELL_DELAY, "s", LATE)
    return list(found.values())


def hypotheses(
    drive: Drive, outputs: tuple[Predicted, ...], known: tuple[Nuisance, ...]
) -> tuple[dict[str, Hypothesis], tuple[Undecidable, ...]]:
    """Return the effects that the record can decide, and the others with the reason."""
    found: dict[str, Hypothesis] = {}
    open_questions: list[Undecidable] = []
    names = {n.name for n in known}
    for name, effect in EFFECTS.items():
        if drive.record.valve_system not in effect.valve_systems:
            continue
        why = _why_not(effect, drive, {p.output.name for p in outputs})
        if why:
            open_questions.append(Undecidable(name, why))
        else:
            found[name] = _hypothesis(effect, drive.record.valve_system, names)
    return found, tuple(open_questions)


def _hypothesis(effect: Effect, valve_system: str, nuisance_names: set[str]) -> Hypothesis:
    competing = (*effect.sheet_parameters, *effect.competes)
    return Hypothesis(
        name=effect.name,
        summary=effect.summary,
        balance=effect.balance,
        parameters=tuple(
            HypothesisParameter(
                name,
                p.unit,
                float(p.neutral),
                float(p.low),
                float(p.high),
                float(p.typical),
                p.shape,
            )
            for name, p in effect.acting(valve_system).items()
        ),
        competes=tuple(dict.fromkeys(name for name in competing if name in nuisance_names)),
        replaces=tuple(n for n in effect.sheet_parameters if n in nuisance_names),
        excitation=effect.excitation,
        separating=effect.separating,
        exact=any(part in effect.name for part in EXACT),
    )


def _why_not(effect: Effect, drive: Drive, outputs: set[str]) -> str:
    """Return why the record cannot decide an effect; "" where it can."""
    if effect.name == LOAD_FRICTION:
        if drive.load == "cell" and "rack_force" in outputs:
            return ""
        return "the measured rack force drives the replay; the load's command is needed beside it"
    if effect.acts_in == "vehicle":
        if effect.name == TYRES and "load_force" in outputs:
            return ""
        return "it acts in the vehicle; a bicycle's force and the rack's position are needed"
    sensors = {full.split(".")[0] for full in effect.sheet_parameters}
    channels = [c for c, group in SENSORS.items() if group in sensors and c not in _RATES]
    if channels and not any(channel in drive.record for channel in channels):
        return f"not measured: {', '.join(channels)}"
    if effect.balance == "column torque" and "driver_torque" not in outputs:
        return "the driver's torque was not recorded"
    if effect.balance in RACK_BALANCES and drive.load == "none":
        return "neither the rack's force nor the load's command was recorded"
    if effect.balance in VALVE_BALANCES and not drive.valves:
        return "the valves' commands were not recorded"
    return ""


_RATES = ("steering_wheel_speed", "rack_speed")
