"""Run a closed loop of cores without ROS and return its traces."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from driver_model.driver import Driver
from pressure_control.load_force import LoadForceController
from pressure_control.overlay.arbiter import OUTPUTS as APPLIED_FIELDS
from pressure_control.overlay.arbiter import OverlayArbiter
from steering_bringup.direct import loop as nominal_loop
from steering_bringup.lane_keeping.keeper import LaneKeeper, keeper_record
from steering_core.naming import unknown
from steering_core.parameters import load_parameters
from steering_lockstep.topics import LOAD_COMMAND
from steering_plant.plant import Plant, PlantError, failure_text
from vehicle_model.motion import STATES as MOTION_STATES
from vehicle_model.vehicle import Vehicle

CHUNK = 10_000
"""Ticks between two reports of progress."""

CONNECTIONS = (
    "/steering/torque->driver",
    "/steering/torque->valve_left",
    "/steering/pressure->valve_left",
    "/steering/rack->valve_left",
    "/steering/torque->valve_right",
    "/steering/pressure->valve_right",
    "/steering/rack->valve_right",
    "/steering/rack->vehicle",
    "/driver/torque->plant",
    "/valve/left/command->plant",
    "/valve/right/command->plant",
    "/vehicle/rack_force->plant",
    "/steering/torque->arbiter",
    "/torque_overlay/lane_keeper->arbiter",
    "/vehicle/odometry->arbiter",
    "/torque_overlay/applied->valve_left",
    "/torque_overlay/applied->valve_right",
    "/steering/rack->load_cylinder",
    "/vehicle/rack_force->load_cylinder",
    "/load_cylinder/command->plant",
)
"""Connections that can have a delay, in the order of the loop's vector of delays."""

REPLAYABLE: Mapping[str, tuple[int, int]] = {
    "/steering/torque": (nominal_loop.MEASURED, 0),
    "/steering/pressure": (nominal_loop.MEASURED, 3),
    "/steering/rack": (nominal_loop.MEASURED, 6),
    "/driver/torque": (nominal_loop.DRIVER, 0),
    "/valve/left/command": (nominal_loop.LEFT_VALVE, 0),
    "/valve/right/command": (nominal_loop.RIGHT_VALVE, 0),
    "/vehicle/rack_force": (nominal_loop.LOAD, 0),
    LOAD_COMMAND: (nominal_loop.CYLINDER, 0),
}
"""Topics that can be recorded ones: trace and first column."""

MEASURED_TOPICS = frozenset(list(REPLAYABLE)[:3])
RECORDED_TOPICS = frozenset(REPLAYABLE) | {
    "/truth/plant",
    "/clock",
    "/vehicle/odometry",
    "/vehicle/imu",
}
"""Topics that a replayed node may publish in a direct run."""


@dataclass(frozen=True)
class Cores:
    """The cores of one closed loop; the valve controllers are None for the open-centre system.

    left, right: of a kind in pressure_control.controller.CONTROLLERS. loop: module with
    ``run_ticks``; another one carries effects, as ``plant.model`` does, or other controllers.
    load_cylinder: force control of the plant's load cylinder, None without one.
    """

    plant: Plant
    driver: Driver
    vehicle: Vehicle
    left: Any = None
    right: Any = None
    loop: ModuleType = nominal_loop
    arbiter: OverlayArbiter | None = None
    lane_keeper: LaneKeeper | None = None
    load_cylinder: LoadForceController | None = None


@dataclass(frozen=True)
class DirectTrace:
    """What a direct run leaves: one float64 array a topic, row k of tick k, SI units.

    torque (n, 3), pressure (n, 3), rack (n, 3), driver (n, 2), left_valve and right_valve (n, 2;
    no rows for the open-centre system), load (n, 3), overlay (n, 19; no rows without an arbiter),
    truth (n, 8; no rows unless asked for): fields of the messages in order. motion (n/10, 7): the
    vehicle's states at 100 Hz. lane_keeper: (n/period, 2), load_cylinder: (n, 2); no rows without
    one.
    """

    torque: np.ndarray
    pressure: np.ndarray
    rack: np.ndarray
    driver: np.ndarray
    left_valve: np.ndarray
    right_valve: np.ndarray
    load: np.ndarray
    overlay: np.ndarray
    truth: np.ndarray
    motion: np.ndarray
    lane_keeper: np.ndarray
    load_cylinder: np.ndarray

    def topics(self) -> dict[str, np.ndarray]:
        """Return the arrays of the lock-step topics that were produced, by topic."""
        named = {
            "/steering/torque": self.torque,
            "/steering/pressure": self.pressure,
            "/steering/rack": self.rack,
            "/driver/torque": self.driver,
            "/valve/left/command": self.left_valve,
            "/valve/right/command": self.right_valve,
            "/vehicle/rack_force": self.load,
            "/torque_overlay/applied": self.overlay,
            "/torque_overlay/lane_keeper": self.lane_keeper,
            LOAD_COMMAND: self.load_cylinder,
            "/truth/plant": self.truth,
        }
        return {topic: rows for topic, rows in named.items() if len(rows)}


def delay_vector(delays: Mapping[str, int]) -> np.ndarray:
    """Return the loop's delays in ticks, int64 of shape (20,), from connections by name.

    Names are ``topic->node``. Raises ValueError for an unknown one or a negative delay.
    """
    vector = np.zeros(len(CONNECTIONS), dtype=np.int64)
    for name, ticks in delays.items():
        if name not in CONNECTIONS:
            raise ValueError(unknown("connection", name, CONNECTIONS))
        if ticks < 0:
            raise ValueError(f"the delay of {name} must not be negative, got {ticks}")
        vector[CONNECTIONS.index(name)] = ticks
    return vector


def rest_rows(cores: Cores) -> tuple[np.ndarray, ...]:
    """Return what each delayed topic held before the first tick: the state of rest."""
    zeros = np.zeros(2)
    left = zeros if cores.left is None else cores.left.out.copy()
    right = zeros if cores.right is None else cores.right.out.copy()
    return (cores.plant.out.copy(), zeros, left, right, np.zeros(3), np.zeros(APPLIED_FIELDS))


def run(
    cores: Cores,
    ticks: int,
    delays: Mapping[str, int] | None = None,
    truth: bool = False,
    on_progress: Callable[[int], None] | None = None,
    recorded: Mapping[str, np.ndarray] | None = None,
) -> DirectTrace:
    """Run ``ticks`` ticks from the cores' present state and return the traces.

    The cores are moved on in place, so a run needs fresh ones. ``on_progress`` gets the number of
    ticks done. ``recorded``: topic -> (ticks, fields), taken in place of what its core would give.
    Raises PlantError where the plant's state leaves what is possible.
    """
    waiting = delay_vector(delays or {})
    before = int(waiting.max())
    traces = _traces(cores, ticks, before, truth)
    replayed = _fill(traces, before, recorded or {})
    arrays = _arrays(cores)
    for start in range(0, ticks, CHUNK):
        stop = min(start + CHUNK, ticks)
        status, tick = cores.loop.run_ticks(
            start, stop, ticks, *arrays, waiting, before, replayed, traces
        )
        if status != 0:
            raise PlantError(failure_text(cores.plant, tick, status))
        if on_progress is not None:
            on_progress(stop)
    measured, *commands = (trace[before:] for trace in traces[:6])
    torque, pressure, rack = measured[:, :3], measured[:, 3:6], measured[:, 6:]
    others = [*traces[6:9], traces[nominal_loop.CYLINDER][before:]]
    return DirectTrace(torque, pressure, rack, *commands, *others)


def _fill(
    traces: tuple[np.ndarray, ...], before: int, recorded: Mapping[str, np.ndarray]
) -> np.ndarray:
    """Write what is recorded into the traces; return which cores it stands for, int64 (10,)."""
    replayed = np.zeros(len(traces), dtype=np.int64)
    for topic, columns in recorded.items():
        if topic in REPLAYABLE:
            position, first = REPLAYABLE[topic]
            traces[position][before:, first : first + columns.shape[1]] = columns
            replayed[position] = 1
    if len(traces[nominal_loop.TRUTH]) and "/truth/plant" in recorded:
        traces[nominal_loop.TRUTH][:] = recorded["/truth/plant"]
    return replayed


def _traces(cores: Cores, ticks: int, before: int, truth: bool) -> tuple[np.ndarray, ...]:
    """Return the loop's traces; the delayed ones begin with ``before`` rows of rest."""
    present = [True, True, cores.left is not None, cores.right is not None, True]
    present.append(cores.arbiter is not None)
    delayed = [
        _delayed(rest, before, ticks if there else 0)
        for rest, there in zip(rest_rows(cores), present, strict=True)
    ]
    motion = np.empty((-(-ticks // nominal_loop.MOTION_PERIOD), len(MOTION_STATES)))
    asked = 0 if cores.lane_keeper is None else -(-ticks // cores.lane_keeper.period)
    opened = _delayed(np.zeros(2), before, 0 if cores.load_cylinder is None else ticks)
    true = np.empty((ticks if truth else 0, 8))
    return (*delayed, true, motion, np.empty((asked, 2)), opened)


def _delayed(rest: np.ndarray, before: int, ticks: int) -> np.ndarray:
    """Return an empty trace that begins with ``before`` rows of rest; no rows without ticks."""
    trace = np.empty((before + ticks if ticks else 0, len(rest)))
    trace[:before] = rest
    return trace


def _arrays(cores: Cores) -> tuple[tuple[np.ndarray, ...], ...]:
    driver, vehicle = cores.driver, cores.vehicle
    return (
        cores.plant.arrays(),
        _controller_arrays(cores.left),
        _controller_arrays(cores.right),
        (driver.par, driver.reference, driver.hands_on, driver.state, driver.out),
        (vehicle.par, vehicle.external, vehicle.effects, vehicle.state, vehicle.out),
        _arbiter_arrays(cores.arbiter),
        _lane_keeper_arrays(cores.lane_keeper),
        _cylinder_arrays(cores.load_cylinder),
    )


def _arbiter_arrays(arbiter: OverlayArbiter | None) -> tuple[np.ndarray, ...]:
    """Return the arbiter's arrays, or some of their types for a loop without one."""
    return (OverlayArbiter(load_parameters()) if arbiter is None else arbiter).arrays()


def _lane_keeper_arrays(keeper: LaneKeeper | None) -> tuple[np.ndarray, ...]:
    """Return the lane keeper's arrays, or some of their types for a loop without one."""
    if keeper is None:
        par = keeper_record(load_parameters(), 1)
        return (par, np.zeros((1, 4)), np.zeros(2), np.zeros(2), np.array([1]))
    return (keeper.par, keeper.lane, keeper.state, keeper.out, np.array([keeper.period]))


def _cylinder_arrays(control: LoadForceController | None) -> tuple[np.ndarray, ...]:
    """Return the force control's arrays, or some of their types for a loop without one."""
    made = LoadForceController(load_parameters()) if control is None else control
    return (made.par, made.state, made.out)


def _controller_arrays(controller: Any) -> tuple[np.ndarray, ...]:
    if controller is None:
        return _absent_controller()
    return (controller.par, controller.table, controller.state, controller.out)


def _absent_controller() -> tuple[np.ndarray, ...]:
    """Return arrays of a controller's types for a loop that has none; they are never used."""
    from pressure_control.record import controller_record
    from pressure_control.state_places import STATES
    from steering_plant.boost_curve import FORMULA

    return (controller_record(load_parameters(), "left"), FORMULA, np.zeros(STATES), np.zeros(2))
