"""Running the truth: a closed loop as the bench runs it, or clamped to given inputs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from pressure_control.controller import ValveController
from steering_core.errors import BenchError
from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.course import Course
from steering_diagnosis.benchmark.truth.laws import through
from steering_diagnosis.benchmark.truth.loop import PLAYS, STAGES, simulate
from steering_diagnosis.benchmark.truth.specimen import Specimen
from vehicle_model.loads import make_load
from vehicle_model.vehicle import Vehicle

SUBSTEPS = {False: 10, True: 20}
"""Equal steps in a tick, open and closed centre: 100 and 50 us."""

LED_IN = 500
"""Ticks at rest before the record, in which valves and controllers settle."""


@dataclass(frozen=True, repr=False)
class Signals:
    """What a run leaves, SI, one row a tick.

    true, measured: (n, 9) in the order of MEASURED. driver (n, 2), left, right (n, 2), load (n, 3):
    fields of the messages. balance (n, 2): only of a clamped run, torque that the driver must give
    [N m] and force beyond the load's command [N]. energy: drawn from the supply [J].
    """

    true: np.ndarray
    measured: np.ndarray
    driver: np.ndarray
    left: np.ndarray
    right: np.ndarray
    load: np.ndarray
    balance: np.ndarray
    energy: float = 0.0
    final: np.ndarray | None = None


def run_closed_loop(
    specimen: Specimen,
    nominal: ParameterSet,
    course: Course,
    closed: bool,
    noise: np.ndarray | None = None,
    resolution: np.ndarray | None = None,
) -> Signals:
    """Run a course with nominal driver, vehicle and controllers around a specimen.

    noise: (n, 9), added to the measurements; None: ideal sensors. BenchError: the loop is lost.
    """
    n = LED_IN + len(course.angle)
    padded = np.concatenate([np.zeros(LED_IN), course.angle])
    force = np.concatenate([np.full(LED_IN, course.force[0]), course.force])
    driver = Driver(nominal, make_manoeuvre("hold"), n)
    driver.reference[:] = np.append(padded, padded[-1])
    vehicle = Vehicle(nominal, make_load(course.load), n)
    if course.load == "table":
        vehicle.external = np.append(force, force[-1])
    added = np.zeros((n, s.CHANNELS))
    if noise is not None:
        added[LED_IN:] = noise
    out = tuple(np.zeros((n, k)) for k in (9, 9, 2, 2, 2, 3, 2))
    y, u = rest(specimen, closed), np.zeros(s.INPUTS)
    cores = [_controller(nominal, side) for side in ("left", "right")]
    par = specimen.par(closed, clamped=False)
    done = _simulate(specimen, par, y, u, added, resolution, driver, vehicle, cores, out)
    if done < n:
        raise BenchError(f"the truth's loop was lost after {(done - LED_IN) * 1e-3:.3f} s")
    cut = [rows[LED_IN:] for rows in out]
    return Signals(*cut, float(y[s.ENERGY]), y)  # type: ignore[call-arg, arg-type]


def run_clamped(
    specimen: Specimen,
    nominal: ParameterSet,
    course: Course,
    given: Signals,
    closed: bool,
    steps: int | None = None,
    pressed: bool = False,
) -> Signals:
    """Run a specimen along the true wheel angle, rack force and commands of ``given``.

    What a replay of the record would see; ideal resolution, no noise. pressed: along the chambers'
    pressures as well, for a record without the valves' commands.
    """
    n = len(given.true)
    out = (
        given.true.copy(),
        np.zeros((n, 9)),
        given.driver,
        given.left,
        given.right,
        given.load,
        np.zeros((n, 2)),
    )
    driver = Driver(nominal, make_manoeuvre("hold"), 1)
    vehicle = Vehicle(nominal, make_load("none"), 1)
    cores = [_controller(nominal, side) for side in ("left", "right")]
    y, u = rest(specimen, closed), np.zeros(s.INPUTS)
    y[s.RACK] = given.true[0, s.RACK_OUT]
    noise = np.zeros((n, s.CHANNELS))
    par = specimen.par(closed, clamped=True, pressed=pressed)
    done = _simulate(specimen, par, y, u, noise, None, driver, vehicle, cores, out, steps)
    if done < n:
        raise BenchError(f"the clamped truth was lost after {done * 1e-3:.3f} s")
    return Signals(*out)


def rest(specimen: Specimen, closed: bool) -> np.ndarray:
    """Return the state near rest: chambers at half the idle pressure of the open-centre valve."""
    p, y = specimen.par(closed, False)[0], np.zeros(s.STATES)
    idle = brentq(
        lambda x: 2.0 * through(p, p["centre_opening"], x, 2e4, 1.0) - p["pump_flow"], 1.0, 1e8
    )
    y[s.LEFT] = y[s.RIGHT] = idle
    y[s.SUPPLY] = 2.0 * idle
    y[s.LEFT_HOSE] = y[s.RIGHT_HOSE] = p["hose"] * idle
    if closed:
        y[s.SUPPLY] = p["supply_pressure"]
        y[s.LEFT_VALVE + 2] = y[s.RIGHT_VALVE + 2] = idle
    return y


def _controller(nominal: ParameterSet, side: str) -> ValveController:
    return ValveController(nominal, side)  # type: ignore[arg-type]


def _simulate(
    specimen: Specimen,
    par: np.ndarray,
    y: np.ndarray,
    u: np.ndarray,
    noise: np.ndarray,
    resolution: np.ndarray | None,
    driver: Driver,
    vehicle: Vehicle,
    cores: list[ValveController],
    out: tuple[np.ndarray, ...],
    steps: int | None = None,
) -> int:
    closed = bool(par["closed"][0])
    steps = SUBSTEPS[closed] if steps is None else steps
    sensors = np.column_stack(
        [specimen.sensors, np.zeros(s.CHANNELS) if resolution is None else resolution]
    )
    start = cores[0].out[1] if closed else 0.0
    if closed:
        y[s.LEFT_MAGNET : s.RIGHT_MAGNET + 2] = start
    plays = np.full((2, PLAYS), start)
    relaxation = specimen.extras["relaxation"]
    speed = float(vehicle.par["speed"][0]) if vehicle.par["speed"][0] > 0.0 else 0.0
    relaxing = (
        1.0
        if relaxation <= 0.0 or speed == 0.0
        else 1.0 - float(np.exp(-speed * 1e-3 / relaxation))
    )
    return int(
        simulate(
            par,
            steps,
            y,
            u,
            sensors,
            specimen.delays,
            np.zeros((s.CHANNELS, 1 + STAGES)),
            plays,
            noise,
            np.zeros((6, s.STATES)),
            (driver.par, driver.reference, driver.hands_on, driver.state, driver.out),
            (vehicle.par, vehicle.external, vehicle.effects, vehicle.state, vehicle.out),
            (cores[0].par, cores[0].table, cores[0].state, cores[0].out),
            (cores[1].par, cores[1].table, cores[1].state, cores[1].out),
            relaxing,
            out,
        )
    )
