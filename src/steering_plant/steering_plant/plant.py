"""The steering plant: parameters, state and one step a tick."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from steering_core.naming import unknown
from steering_core.parameters import ParameterSet, record
from steering_plant import boost_curve, sensors
from steering_plant.effects.base import VALVE_SYSTEMS
from steering_plant.effects.models import NO_EFFECTS, STATE_NAMES, plant_model
from steering_plant.model import integrator, states
from steering_plant.rest import rest_signals, rest_state

SERVO_FIELDS = {
    "resonance": "resonance",
    "damping": "damping",
    "full_opening": "full_opening",
    "bias": "bias_opening",
    "stroke": "stroke",
    "spool_mass": "spool_mass",
}
"""Fields of the record, after ``servo_``, by the data sheet's names of the servo valves."""
GROUPS = ("mechanics", "oil", "open_centre", "pressure_control_valve", "simulation")

SERVO_SPOOLS = states.SERVO_VALVE_NAMES[states.LEFT_SERVO :]

TOLERANCES = (
    {
        "steering_wheel_angle": 1e-7,
        "steering_wheel_speed": 1e-5,
        "rack_position": 1e-9,
        "rack_speed": 1e-6,
        "column_friction": 1e-5,
        "rack_friction": 1e-2,
        "left_pressure": 50.0,
        "right_pressure": 50.0,
        "supply_energy": 1e9,
        "pump_pressure": 50.0,
        "left_spool": 1e-8,
        "left_spool_speed": 1e-4,
        "left_control_pressure": 200.0,
        "right_spool": 1e-8,
        "right_spool_speed": 1e-4,
        "right_control_pressure": 200.0,
        "load_piston_position": 1e-10,
        "load_piston_speed": 1e-6,
        "load_piston_friction": 1e-2,
        "load_left_pressure": 50.0,
        "load_right_pressure": 50.0,
        "load_spool": 1e-8,
        "load_spool_speed": 1e-5,
    }
    | dict.fromkeys(SERVO_SPOOLS[::2], 1e-8)
    | dict.fromkeys(SERVO_SPOOLS[1::2], 1e-5)
)
"""Local error allowed in one inner step, by state, SI units (the energy is only accumulated)."""

MOST_FIXED_STEPS = 10_000

LONGEST_STEP = {"open_centre": 1.001e-3, "closed_centre": 5.01e-4, "servo_valve": 5.01e-4}
"""Longest inner step [s]. The tolerances alone would pass over what the spools do within a tick."""


class PlantError(RuntimeError):
    """The plant's state left what is physically possible."""


class Plant:
    """Steering wheel, torsion bar, rack and one of the hydraulic systems, stepped once a tick.

    parameters: the parameter set. valve_system: a name of VALVE_SYSTEMS.
    boost_table: measured boost curve (measured_boost_curve) in place of the formula.
    effects: effects that are on, name to parameters; those not given are typical.
    load_cylinder: whether the rig's load cylinder stands in for the ideal load force.

    At rest the rack stands in the middle, without load, at the pressures of the static map.
    ``effects`` holds the effects' parameters, ``effect_positions`` where each (effect, parameter)
    is in it and ``effect_states`` where each (effect, state) is in ``state``, from the end.
    ``out`` is the measurement of the present tick, shape (9,), order of sensors.CHANNELS;
    ``truth()`` the true states. All arrays are float64 and SI.
    """

    def __init__(
        self,
        parameters: ParameterSet,
        valve_system: str,
        boost_table: np.ndarray = boost_curve.FORMULA,
        effects: Mapping[str, Mapping[str, float]] = NO_EFFECTS,
        load_cylinder: bool = False,
    ) -> None:
        if valve_system not in VALVE_SYSTEMS:
            raise ValueError(unknown("valve system", valve_system, VALVE_SYSTEMS))
        self.valve_system = valve_system
        self.model, added = plant_model(effects, valve_system)
        known = plant_record(parameters, valve_system, boost_table, load_cylinder)
        parameters = added.changed(parameters, valve_system)
        self.par = plant_record(parameters, valve_system, boost_table, load_cylinder)
        self.table = boost_table
        self.sensors = sensors.sensor_table(parameters)
        self.effects = added.values
        self.effect_positions, self.effect_states = added.positions, added.states
        self.names = state_names(valve_system, load_cylinder)
        group = "servo_valve" if valve_system == "servo_valve" else "valve_controller"
        raised = parameters[f"{group}.common_pressure_raise"]
        nominal = rest_state(self.par, self.table, raised, known)
        at_rest = rest_signals(self.par[0], self.names, nominal)
        rests = [at_rest[rest] if isinstance(rest, str) else rest for rest in added.rests]
        self.state = np.concatenate([nominal, rests])
        allowed = [TOLERANCES[name] for name in self.names]
        self.scale = np.array([*allowed, *added.tolerances]) * parameters["simulation.tolerance"]
        self.inner_step = np.array([1e-4])
        self.inputs = np.zeros(states.INPUTS)
        self.work = np.zeros((integrator.WORK_ROWS, len(self.state)))
        self.flows = np.zeros(states.FLOWS)
        self.history = np.zeros((sensors.HISTORY_ROWS, len(sensors.CHANNELS)))
        self.true = np.zeros(len(sensors.CHANNELS))
        self.out = np.zeros(len(sensors.CHANNELS))
        self.observe(0)

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Return the arrays that ``plant_step`` takes before the tick and the inputs."""
        return (
            self.par,
            self.table,
            self.sensors,
            self.effects,
            self.scale,
            self.state,
            self.inner_step,
            self.inputs,
            self.work,
            self.flows,
            self.history,
            self.true,
            self.out,
        )

    def observe(self, tick: int) -> np.ndarray:
        """Measure at ``tick`` without moving on; needed once, at tick 0."""
        self.model.observe(
            self.par,
            self.sensors,
            self.effects,
            tick,
            self.state,
            self.inputs,
            self.history,
            self.true,
            self.out,
        )
        return self.out

    def step(
        self,
        tick: int,
        driver_torque: float,
        left_solenoid_force: float,
        right_solenoid_force: float,
        load_force: float,
        load_stiffness: float,
        load_position: float,
        load_valve: float = 0.0,
    ) -> np.ndarray:
        """Integrate from ``tick`` to the next with held commands; return what is measured there.

        With servo valves the solenoids' places take the commands of the chambers' valves, -1 to 1.
        load_valve, -1 to 1: of the load cylinder, which has no use for the load's force.
        Raises PlantError where the state leaves what is possible.
        """
        status = self.model.plant_step(
            *self.arrays(),
            tick,
            driver_torque,
            left_solenoid_force,
            right_solenoid_force,
            load_force,
            load_stiffness,
            load_position,
            load_valve,
        )
        if status != integrator.OK:
            raise PlantError(failure_text(self, tick, status))
        return self.out

    def truth(self, tick: int) -> np.ndarray:
        """Return the true states, shape (8,), fields of steering_msgs/PlantTruth."""
        truth = np.zeros(8)
        self.model.report_truth(
            self.par,
            self.table,
            self.effects,
            tick,
            self.state,
            self.inputs,
            self.work,
            self.flows,
            truth,
        )
        return truth

    def energy(self) -> float:
        """Return the hydraulic energy drawn from the supply so far [J]."""
        return float(self.state[states.ENERGY])


def state_names(valve_system: str, load_cylinder: bool = False) -> tuple[str, ...]:
    """Return the names of the nominal model's states in order."""
    names = STATE_NAMES[valve_system]
    return (*names, *states.LOAD_CYLINDER_NAMES) if load_cylinder else names


def plant_record(
    parameters: ParameterSet,
    valve_system: str,
    boost_table: np.ndarray = boost_curve.FORMULA,
    load_cylinder: bool = False,
) -> np.ndarray:
    """Return the record, shape (1,), that the plant's kernels read, with derived constants.

    load_cylinder in it is the position of the cylinder's first state, 0 without one.
    """
    values: dict[str, float] = {}
    for group in GROUPS:
        values |= parameters.group(group)
    orifice_constant = values["flow_coefficient"] * math.sqrt(2.0 / values["density"])
    damping_area = 0.25 * math.pi * values["damping_orifice_diameter"] ** 2
    values |= boost_curve.valve_constants(parameters, boost_table)
    values |= {
        "supply_pressure": parameters["closed_centre.supply_pressure"],
        "closed_centre": 1.0 if valve_system == "closed_centre" else 0.0,
        "servo_valve": 1.0 if valve_system == "servo_valve" else 0.0,
        "load_cylinder": float(len(state_names(valve_system))) if load_cylinder else 0.0,
        "longest_step": LONGEST_STEP["servo_valve" if load_cylinder else valve_system],
        "orifice_constant": orifice_constant,
        "pressure_area": 0.25 * math.pi * values["pressure_area_diameter"] ** 2,
        "damping_orifice_conductance": orifice_constant * damping_area,
    }
    values |= {
        f"servo_{name}": parameters[f"servo_valve.{full}"] for name, full in SERVO_FIELDS.items()
    }
    values |= {f"load_{name}": value for name, value in parameters.group("load_cylinder").items()}
    check_geometry(values, load_cylinder)
    check_steps(values["inner_steps"])
    return record(values)


def check_geometry(values: dict[str, float], load_cylinder: bool) -> None:
    """Raise ValueError where the stroke is longer than the chambers are large."""
    chambers = {"open_centre.chamber_volume": "mechanics.piston_area"}
    if load_cylinder:
        chambers["load_cylinder.chamber_volume"] = "load_cylinder.piston_area"
    for volume_name, area_name in chambers.items():
        prefix = "load_" if area_name.startswith("load_") else ""
        volume = values[f"{prefix}chamber_volume"]
        swept = values[f"{prefix}piston_area"] * values["rack_stop_position"]
        if swept >= volume:
            raise ValueError(
                f"{volume_name} ({volume:g} m3) must exceed "
                f"{area_name} x mechanics.rack_stop_position ({swept:g} m3), "
                "or a chamber would vanish at the end of the stroke"
            )


def check_steps(inner_steps: float) -> None:
    """Raise ValueError unless ``inner_steps`` is a number of steps that a tick can have."""
    if not (inner_steps.is_integer() and inner_steps <= MOST_FIXED_STEPS):
        raise ValueError(
            f"simulation.inner_steps must be a whole number up to {MOST_FIXED_STEPS}, "
            f"got {inner_steps:g}"
        )


def failure_text(plant: Plant, tick: int, status: int) -> str:
    """Return the text of a PlantError: when, what, the state, and what to look at."""
    what = {
        integrator.NOT_FINITE: "left what is physically possible",
        integrator.STEP_TOO_SMALL: "needs an inner step below 1 ns",
    }[status]
    listed = ", ".join(f"{n} {v:.4g}" for n, v in zip(plant.names, plant.state, strict=False))
    return (
        f"the plant's state {what} after t = {tick * 1e-3:.3f} s (tick {tick}). Last good state: "
        f"{listed}. Usual causes: an unstable controller (lower valve_controller.resonance), "
        "an extreme parameter, or simulation.inner_steps set too low (0 fits it to the error)"
    )
