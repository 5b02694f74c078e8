"""One simulation of the steering gear under measured inputs."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from steering_core.errors import BenchError
from steering_core.parameters import ParameterSet
from steering_diagnosis.engine.model import Effects
from steering_diagnosis.steering.drive import RUN_UP, Drive, Driven, sensor
from steering_diagnosis.steering.full_model import full_model
from steering_diagnosis.steering.kernels.simulate import EXTRA, OK, WORK_ROWS
from steering_plant import boost_curve
from steering_plant.model import states
from steering_plant.plant import TOLERANCES, plant_record, state_names
from steering_plant.rest import rest_signals, rest_state

RELAXED = {
    "steering_wheel_angle": 1.0,
    "steering_wheel_speed": 1.0,
    "rack_position": 2e-8,
    "rack_speed": 2e-5,
    "column_friction": 1e-3,
    "rack_friction": 0.2,
    "left_pressure": 300.0,
    "right_pressure": 300.0,
    "pump_pressure": 300.0,
    "left_spool": 1e-7,
    "right_spool": 1e-7,
    "left_spool_speed": 1e-3,
    "right_spool_speed": 1e-3,
    "left_control_pressure": 1000.0,
    "right_control_pressure": 1000.0,
}
"""Local error allowed in an inner step, SI: some hundredths of the sensors' noise."""

KEPT = 4
"""Simulations remembered."""


@dataclass(frozen=True, repr=False)
class Trace:
    """States, rates and flows at every tick of the record (without the run-up), rows (n, ...)."""

    names: tuple[str, ...]
    rows: np.ndarray

    def __getitem__(self, name: str) -> np.ndarray:
        return self.rows[RUN_UP:, self.names.index(name)]

    def rate(self, name: str) -> np.ndarray:
        """Return what the model gives as the rate of a state, prescribed ones included."""
        width = (self.rows.shape[1] - EXTRA) // 2
        return self.rows[RUN_UP:, width + self.names.index(name)]

    def _extra(self, column: int) -> np.ndarray:
        return self.rows[RUN_UP:, self.rows.shape[1] - EXTRA + column]

    @property
    def torque(self) -> np.ndarray:
        """Torsion-bar torque [N m]."""
        return self._extra(0)

    @property
    def supply(self) -> np.ndarray:
        """Pressure of the pump line or the supply [Pa]."""
        return self._extra(1)

    @property
    def flows(self) -> np.ndarray:
        """Flows into left and right chamber and from the supply, (n, 3) [m3/s]."""
        return self.rows[RUN_UP:, -3:]


class Simulation:
    """The full model under a drive; remembers its last results."""

    def __init__(self, drive: Drive) -> None:
        self.drive = drive
        record = drive.record
        self.valve_system = record.valve_system
        self.table = boost_curve.FORMULA if record.boost_table is None else record.boost_table
        self.names = state_names(self.valve_system)
        self._cache: OrderedDict[tuple[bytes, bytes, Driven], np.ndarray] = OrderedDict()
        self.count = 0

    def __getstate__(self) -> dict[str, object]:
        return self.__dict__ | {"_cache": OrderedDict()}

    def run(
        self,
        parameters: ParameterSet,
        effects: Effects,
        inputs: Mapping[str, int] | None = None,
    ) -> Trace:
        """Simulate with the data sheet ``parameters`` (as effects change it already).

        Effects here act in the plant's slots alone. inputs: as for ``Drive.driven``. BenchError
        where the state leaves what is possible.
        """
        driven = self.drive.driven(parameters, inputs)
        return self.driven_by(driven, parameters, effects)

    def driven_by(self, driven: Driven, parameters: ParameterSet, effects: Effects) -> Trace:
        """Simulate under given inputs; see ``run``."""
        par = plant_record(parameters, self.valve_system, self.table)
        e = full_model(self.valve_system).values(effects)
        key = (par.tobytes(), e.tobytes(), driven)
        rows = self._cache.get(key)
        if rows is None:
            rows = self._simulate(par, e, driven, parameters)
            self._cache[key] = rows
            if len(self._cache) > KEPT:
                self._cache.popitem(last=False)
        return Trace(self.names, rows)

    def _simulate(
        self, par: np.ndarray, e: np.ndarray, driven: Driven, parameters: ParameterSet
    ) -> np.ndarray:
        model = full_model(self.valve_system)
        y = self._start(par, driven, parameters)
        scale = np.array(
            [RELAXED.get(name, TOLERANCES[name]) for name in self.names] + list(model.tolerances)
        )
        scale[driven.at] = np.inf
        rows = np.empty((len(driven.given), 2 * len(y) + EXTRA))
        status, tick = model.kernel.simulate(
            par,
            self.table,
            e,
            self.drive.valves,
            scale,
            driven.at,
            driven.given,
            driven.slopes,
            RUN_UP,
            driven.held,
            driven.rise,
            y,
            np.zeros(states.INPUTS),
            np.zeros((WORK_ROWS, len(y))),
            np.zeros(states.FLOWS),
            rows,
        )
        self.count += 1
        if status != OK:
            raise BenchError(
                f"the replay of '{self.drive.record.name}' left what is physically possible after "
                f"{max(tick - RUN_UP, 0) * 1e-3:.3f} s: check units and signs of its channels"
            )
        return rows

    def _start(self, par: np.ndarray, driven: Driven, parameters: ParameterSet) -> np.ndarray:
        """Return the state to begin the run-up with: at rest, but where it was measured.

        By the nominal sensors: the beginning must follow from what is remembered with the result,
        plant and inputs, and from nothing else.
        """
        model, drive = full_model(self.valve_system), self.drive
        sensors = drive.record.nominal
        group = "servo_valve" if self.valve_system == "servo_valve" else "valve_controller"
        nominal = rest_state(par, self.table, parameters[f"{group}.common_pressure_raise"])
        measured = {}
        for channel, state in (
            ("rack_position", states.POSITION),
            ("left_pressure", states.LEFT),
            ("right_pressure", states.RIGHT),
        ):
            if channel in drive.curves:
                measured[state] = drive.felt(channel, sensors)[0]
        for state, value in measured.items():
            nominal[state] = value if state == states.POSITION else max(value, 0.0)
        if "rack_position" not in drive.curves:
            nominal[states.POSITION] = driven.given[0, 0] / parameters["mechanics.gear_ratio"]
        nominal[states.RACK_FRICTION] = self._rack_friction(nominal, driven, parameters)
        if self.valve_system == "closed_centre":
            nominal[states.LEFT_VALVE + states.CONTROL] = nominal[states.LEFT]
            nominal[states.RIGHT_VALVE + states.CONTROL] = nominal[states.RIGHT]
        elif self.valve_system == "open_centre" and "supply_pressure" in drive.curves:
            nominal[states.PUMP] = max(drive.felt("supply_pressure", sensors)[0], 0.0)
        at_rest = rest_signals(par[0], self.names, nominal)
        if drive.valves and self.valve_system != "open_centre":
            at_rest["left_solenoid"] = driven.held[0, states.LEFT_SOLENOID]
            at_rest["right_solenoid"] = driven.held[0, states.RIGHT_SOLENOID]
        rests = [at_rest[rest] if isinstance(rest, str) else rest for rest in model.rests]
        y = np.concatenate([nominal, rests])
        y[driven.at] = driven.given[0]
        return y

    def _rack_friction(self, y: np.ndarray, driven: Driven, parameters: ParameterSet) -> float:
        """Return the rack's friction [N] that the measured balance of forces leaves."""
        channels = ("torsion_bar_torque", "left_pressure", "right_pressure")
        if self.drive.load != "cell" or not all(c in self.drive.curves for c in channels):
            return 0.0
        sensors = self.drive.record.nominal
        torque = self.drive.felt("torsion_bar_torque", sensors)[: RUN_UP // 4].mean()
        pressed = (y[states.RIGHT] - y[states.LEFT]) * parameters["mechanics.piston_area"]
        force = driven.held[: RUN_UP // 4, states.LOAD_FORCE].mean()
        left = pressed + torque * parameters["mechanics.gear_ratio"] - force
        loaded = max(y[states.LEFT], 0.0) + max(y[states.RIGHT], 0.0)
        limit = parameters["mechanics.rack_friction"]
        limit += parameters["mechanics.rack_friction_pressure_slope"] * loaded
        return float(np.clip(left, -limit, limit))


def as_measured(values: np.ndarray, parameters: ParameterSet, channel: str) -> np.ndarray:
    """Return what the sensor of ``channel`` reports of true ``values`` (n,) at the ticks."""
    by = sensor(parameters, channel)
    if by.lag > 0.0:
        values = _lagged(values, by.lag * 1e3)
    if by.delay > 0.0:
        ticks = np.arange(len(values))
        values = np.interp(ticks - by.delay * 1e3, ticks, values)
    return by.gain * values + by.offset


def _lagged(values: np.ndarray, ticks: float) -> np.ndarray:
    """Return a first-order lag of ``ticks`` of values that run straight from tick to tick."""
    from scipy.signal import lfilter

    decay = np.exp(-1.0 / ticks)
    direct = 1.0 - ticks * (1.0 - decay)
    before = (1.0 - decay) - direct
    lagged, _ = lfilter([direct, before], [1.0, -decay], values - values[0], zi=[0.0])
    return np.asarray(lagged + values[0])
