"""A run without ROS: the compiled cores in this process, recorded to the same bag."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from steering_bringup.cores import build_cores
from steering_bringup.graphs import connection_delays, recorded_types
from steering_bringup.outcome import Outcome, peaks
from steering_bringup.plans import Plan
from steering_bringup.process_age import process_age
from steering_bringup.progress import Bar
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import CLOCK, wire
from steering_lockstep.wire import NANOSECONDS_PER_TICK
from vehicle_model.motion_messages import IMU, ODOMETRY, imu_fields, odometry_fields

if TYPE_CHECKING:
    from steering_bringup.direct.runner import DirectTrace
    from vehicle_model.vehicle import Vehicle

BLOCK_TICKS = 1000
"""Ticks written at once; within a block the messages are sorted by topic rate, then by tick."""


def run_direct(plan: Plan) -> Outcome:
    """Run the plan and return what it did. Raises PlantError where the plant gives up."""
    from steering_bringup.direct.runner import run

    started, age = time.perf_counter(), process_age()
    scenario = plan.scenario
    # A first tick apart loads the compiled loop, or compiles it, outside of the timed run.
    run(build_cores(scenario, plan.node_set), 1, truth=scenario.truth)
    cores = build_cores(scenario, plan.node_set)
    ready = time.perf_counter()
    with Bar(plan.node_set.name, scenario.duration) as bar:

        def progress(tick: int) -> None:
            bar.update(tick, tick * 1e-3 / (time.perf_counter() - ready))

        delays = connection_delays(plan.graph)
        replays = plan.replays.values()
        recorded = {topic: rows for r in replays for topic, rows in r.columns().items()}
        trace = run(cores, scenario.ticks, delays, scenario.truth, progress, recorded)
    done = time.perf_counter()
    outcome = Outcome(
        scenario.name,
        plan.node_set.name,
        scenario.ticks,
        ticks=scenario.ticks,
        wall_time=done - ready,
        start_time=ready - started,
        since_command=age + ready - started,
        peaks=peaks(trace.torque, trace.pressure, trace.rack),
    )
    if plan.bag is not None:
        outcome.messages = write_bag(plan, trace, cores.vehicle)
        outcome.bag = plan.bag
    return outcome


def write_bag(plan: Plan, trace: DirectTrace, vehicle: Vehicle) -> int:
    """Write a direct run's bag with the bytes that the graph would publish.

    ``vehicle``: the core that made ``trace.motion``. Returns the number of messages.
    """
    from steering_bringup.bags import BagWriter

    assert plan.bag is not None
    types = recorded_types(plan.graph)
    columns = trace_columns(trace, vehicle)
    replayed = {t: rows for replay in plan.replays.values() for t, rows in replay.payloads.items()}
    run = RunSettings(plan.graph, plan.scenario.ticks)
    rate = {t: run.every(t) for t in types}
    payloads = {
        t: replayed[t] if t in replayed else _payload(t, columns[t], rate[t]) for t in types
    }
    with BagWriter(plan.bag, types, plan.metadata(), compress=plan.manner.compress) as writer:
        for start in range(0, plan.scenario.ticks, BLOCK_TICKS):
            for every in sorted(set(rate.values())):
                first = -(-start // every)
                stop = min(start + BLOCK_TICKS, plan.scenario.ticks)
                ticks = np.arange(first * every, stop, every)
                rows = slice(first, first + len(ticks))
                block = {t: payloads[t][rows] for t in types if rate[t] == every}
                writer.write_block(ticks * NANOSECONDS_PER_TICK, block)
    return sum(len(rows) for rows in payloads.values())


def trace_columns(trace: DirectTrace, vehicle: Vehicle) -> dict[str, np.ndarray]:
    """Return the numbers of every topic's messages, (n, fields); /clock has no fields."""
    motion = {
        topic: np.empty((len(trace.motion), len(wire(topic).fields))) for topic in (ODOMETRY, IMU)
    }
    for row, state in enumerate(trace.motion):
        vehicle.state[: len(state)] = state
        motion[ODOMETRY][row] = odometry_fields(vehicle.odometry())
        motion[IMU][row] = imu_fields(vehicle.imu())
    return {**trace.topics(), **motion, CLOCK: np.empty((len(trace.torque), 0))}


def _payload(topic: str, columns: np.ndarray, every: int) -> np.ndarray:
    """Return the CDR bytes of a topic's messages, one ``every`` so many ticks, (n, size) uint8."""
    ticks = np.arange(len(columns), dtype=np.int64) * every
    layout = wire(topic)
    rows = layout.from_columns(ticks, columns)
    return rows.view(np.uint8).reshape(len(ticks), layout.size)
