"""Speed, accuracy and memory of the direct runner, and its ratio to scipy's LSODA.

    steer bench direct_speed
    steer python benchmarks/direct_speed.py --duration 60 --repetitions 10

The closed-centre on-centre manoeuvre on one core. LSODA integrates the same compiled right-hand
side under the commands that the run recorded, restarted every tick, over 20 stretches spread over
the manoeuvre. It gets the loosest of its tolerances at which its worst state, as a share of the
state's range, is as near to its own converged solution as the plant's is to the plant's. It is
called in three ways, each time with the parameters frozen into one compiled function:
solve_ivp(method="LSODA"), which the target is about, the bare class scipy.integrate.LSODA, and
odeint, where no Python runs between its steps. All are timed in turns within one run; ratios are
medians over the turns, per tick. The target compares like with like: LSODA's plant with the direct
runner's plant under the same recorded commands. The ratio that charges the direct runner with its
controllers, driver and vehicle as well, and LSODA still with the plant alone, stands beside it.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from scipy.integrate import LSODA, odeint, solve_ivp

from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.benchmarking.timing import in_turns, ratio, seconds
from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import Cores, DirectTrace, run
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_bringup.schema import Scenario
from steering_plant.model.dynamics import rates, settle
from steering_plant.plant import Plant

TICK = 1e-3  # s
BAR = 1e5  # Pa
CONVERGED_STEPS = 20.0
STRETCH = 50  # ticks
TIGHT = 1e-3
LOOSER = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""LSODA's absolute tolerances as multiples of the plant's own."""
RTOL = 1e-9


def scenario(duration: float, **parameters: float) -> Scenario:
    """Return the on-centre scenario with a sweep of ``duration`` [s] and changed parameters."""
    shipped = load_scenario("on_centre")
    choice = shipped.manoeuvre.model_copy(update={"duration_s": duration})
    changed = {**shipped.parameters, **parameters}
    update = {"duration": duration, "manoeuvre": choice, "parameters": changed}
    return shipped.model_copy(update=update)


def fresh(duration: float, **parameters: float) -> Cores:
    """Return cores at rest for the closed-centre system."""
    return build_cores(scenario(duration, **parameters), load_node_set("closed_centre"))


@dataclass(frozen=True)
class Recorded:
    """The plant's way through the manoeuvre: states and inputs of every tick, and the stretches."""

    states: np.ndarray
    inputs: np.ndarray
    starts: np.ndarray


def stepped(duration: float, inputs: np.ndarray, **parameters: float) -> np.ndarray:
    """Return the plant's states at every tick under ``inputs``, shape (n, 15)."""
    plant = fresh(duration, **parameters).plant
    states = np.empty((len(inputs), len(plant.state)))
    for tick, held in enumerate(inputs):
        states[tick] = plant.state
        plant.step(tick, *held)
    return states


def recorded(duration: float, trace: DirectTrace, stretches: int) -> Recorded:
    """Return the way of a converged run, with starts of ``stretches`` spread over it."""
    inputs = commands(trace)
    states = stepped(duration, inputs, **{"simulation.inner_steps": CONVERGED_STEPS})
    starts = np.linspace(0, len(inputs) - STRETCH, stretches).astype(int)
    return Recorded(states, inputs, starts)


def commands(trace: DirectTrace) -> np.ndarray:
    """Return the plant's inputs at every tick, shape (n, 7); the load cylinder's valve is shut."""
    torque, left, right = trace.driver[:, :1], trace.left_valve[:, 1:], trace.right_valve[:, 1:]
    shut = np.zeros((len(torque), 1))
    return np.ascontiguousarray(np.hstack([torque, left, right, trace.load, shut]))


def right_hand_side(plant: Plant) -> Callable[..., np.ndarray]:
    """Return the plant's rates as one compiled function of (y, t, u), parameters frozen."""
    par, table, effects = plant.par, plant.table, plant.effects
    size = len(plant.state)

    @numba.njit(error_model="numpy")
    def slopes(y: np.ndarray, t: float, u: np.ndarray) -> np.ndarray:
        dy, flows = np.empty(size), np.empty(3)
        rates(par[0], table, effects, t, y, u, dy, flows)
        return dy

    return slopes


@numba.njit
def plant_alone(
    plant: tuple[np.ndarray, ...], plant_step: Callable[..., int], inputs: np.ndarray
) -> None:
    """Step the plant's arrays through the recorded ``inputs``, shape (n, 7)."""
    for tick in range(inputs.shape[0]):
        u = inputs[tick]
        plant_step(*plant, tick, u[0], u[1], u[2], u[3], u[4], u[5], u[6])


def by_odeint(slopes: Callable, state: np.ndarray, held: np.ndarray, atol: np.ndarray) -> Any:
    """Return the state a tick later."""
    grid = np.array([0.0, TICK])
    return odeint(slopes, state, grid, (held,), rtol=RTOL, atol=atol, mxstep=5000)[1]


def by_class(slopes: Callable, state: np.ndarray, held: np.ndarray, atol: np.ndarray) -> Any:
    """Return the state a tick later."""
    solver = LSODA(lambda t, y: slopes(y, t, held), 0.0, state, TICK, rtol=RTOL, atol=atol)
    while solver.status == "running":
        solver.step()
    return solver.y


def by_solve_ivp(slopes: Callable, state: np.ndarray, held: np.ndarray, atol: np.ndarray) -> Any:
    """Return the state a tick later."""
    span = (0.0, TICK)
    return solve_ivp(lambda t, y: slopes(y, t, held), span, state, "LSODA", rtol=RTOL, atol=atol).y[
        :, -1
    ]


def replayed(
    tick_of: Callable, slopes: Callable, plant: Plant, looser: float, way: Recorded
) -> np.ndarray:
    """Return LSODA's states over the stretches, shape (n, 15)."""
    allowed = plant.scale * looser
    states = []
    for start in way.starts:
        state = way.states[start].copy()
        for held in way.inputs[start : start + STRETCH]:
            state = tick_of(slopes, state, held, allowed)
            settle(plant.par[0], plant.effects, state)
            states.append(state.copy())
    return np.array(states)


def peak_memory(duration: float) -> int:
    """Return the peak of what a run allocates beside the trace that it returns [bytes]."""
    cores = fresh(duration)
    ticks = round(duration / TICK)
    tracemalloc.start()
    trace = run(cores, ticks)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    bases = {id(a.base if a.base is not None else a): a for a in vars(trace).values()}
    return peak - sum((a.base if a.base is not None else a).nbytes for a in bases.values())


def worst(pressures: np.ndarray, expected: np.ndarray) -> float:
    """Return the largest difference of two sets of pressures [bar]."""
    return float(np.abs(pressures - expected).max()) / BAR


def share(states: np.ndarray, exact: np.ndarray, way: Recorded) -> float:
    """Return the worst state's largest error as a share of its range over the manoeuvre."""
    return float((np.abs(states - exact) / np.ptp(way.states, axis=0)).max())


def same_accuracy(
    way: Recorded, plant: Plant, error: float, slopes: Callable
) -> tuple[float, list[dict[str, float]]]:
    """Return LSODA's loosest tolerance that keeps the ``error`` of the states, and the scan."""
    exact = replayed(by_odeint, slopes, plant, TIGHT, way)
    scan = [
        {"tolerance": k, "error": share(replayed(by_odeint, slopes, plant, k, way), exact, way)}
        for k in LOOSER
    ]
    return max(s["tolerance"] for s in scan if s["error"] <= error or s is scan[0]), scan


def measure(options: argparse.Namespace) -> Measured:
    """Return all figures."""
    duration, ticks = options.duration, round(options.duration / TICK)
    trace = run(fresh(duration), ticks)
    converged = run(fresh(duration, **{"simulation.inner_steps": CONVERGED_STEPS}), ticks)

    plant, way = fresh(duration).plant, recorded(duration, converged, options.stretches)
    slopes = right_hand_side(plant)
    state_error = share(stepped(duration, way.inputs), way.states, way)
    tolerance, scan = same_accuracy(way, plant, state_error, slopes)
    plant_alone(plant.arrays(), plant.model.plant_step, way.inputs[:1])
    times = per_tick(duration, way, slopes, plant, tolerance, options.repetitions)
    short, long = peak_memory(duration), peak_memory(5.0 * duration)
    values = {
        "ratio_to_lsoda": ratio(times["solve_ivp"], times["plant"]),
        "whole_loop_to_lsoda": ratio(times["solve_ivp"], times["loop"]),
        "ratio_to_class": ratio(times["class"], times["plant"]),
        "ratio_to_odeint": ratio(times["odeint"], times["plant"]),
        "pressure_error": worst(trace.pressure[:, :2], converged.pressure[:, :2]),
        "state_error": state_error,
        "real_time": TICK / statistics.median(times["loop"]),
        "memory": short / 1e3,
        "memory_growth": long / short,
    }
    details = {"lsoda_tolerance": tolerance, "lsoda_scan": scan, "seconds_per_tick": times}
    return Measured(values, details)


def per_tick(
    duration: float,
    way: Recorded,
    slopes: Callable,
    plant: Plant,
    tolerance: float,
    repetitions: int,
) -> dict[str, list[float]]:
    """Return the times of a tick [s]: our whole loop, our plant alone, and LSODA's three doors."""
    ticks, few = len(way.inputs), len(way.starts) * STRETCH

    def loop() -> float:
        cores = fresh(duration)
        return seconds(lambda: run(cores, ticks)) / ticks

    def alone() -> float:
        moved = fresh(duration).plant
        arrays, step = moved.arrays(), moved.model.plant_step
        return seconds(lambda: plant_alone(arrays, step, way.inputs)) / ticks

    def lsoda(door: Callable) -> Callable[[], float]:
        return lambda: seconds(lambda: replayed(door, slopes, plant, tolerance, way)) / few

    doors = {"solve_ivp": by_solve_ivp, "class": by_class, "odeint": by_odeint}
    calls = {"loop": loop, "plant": alone, **{name: lsoda(d) for name, d in doors.items()}}
    return in_turns(calls, repetitions)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    parser.add_argument("--duration", type=float, default=20.0, help="length of the sweep [s]")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--stretches", type=int, default=20, help="of 50 ticks, for LSODA")


if __name__ == "__main__":
    sys.exit(main("direct_speed", measure, arguments, __doc__))
