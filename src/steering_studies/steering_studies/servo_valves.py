"""The source's test rig with servo valves, simulated: figures 7.2, 7.8 to 7.10, 8.7 and 8.8.

Each function runs a shipped scenario without ROS and returns its curves with the figures of merit
that the source's figure shows. ``changes`` replace parameters, full name to SI value.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import DirectTrace, run
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_bringup.schema import Scenario
from steering_core.ticks import TICK_PERIOD

NO_CHANGES: Mapping[str, float] = {}


@dataclass(frozen=True)
class Sine:
    """Figures 7.8 to 7.10: 20 degrees up to 2 Hz. Arrays (n,), SI; load pressures are right - left.

    reference_error, open_centre_error [Pa], torque_difference [N m]: largest sizes.
    """

    time: np.ndarray
    reference: np.ndarray
    servo_valve: np.ndarray
    open_centre: np.ndarray
    torque: np.ndarray
    reference_error: float
    open_centre_error: float
    torque_difference: float


@dataclass(frozen=True)
class Step:
    """Figure 8.7: 50 to 100 bar and back with the rack locked. Arrays (n,), s and Pa.

    rise, fall [s]: to 63 % of the step. overshoot [Pa]: beyond either end, the larger one.
    """

    time: np.ndarray
    reference: np.ndarray
    left: np.ndarray
    right: np.ndarray
    rise: float
    fall: float
    overshoot: float


@dataclass(frozen=True)
class LoadForce:
    """Figure 7.2: the load cylinder follows the vehicle's rack force. Arrays (n,), s and N.

    largest: of the reference. error: largest deviation. error_at_reversal: within 50 ms of where
    the rack turns round; error_between: elsewhere, at the 95th percentile both.
    """

    time: np.ndarray
    reference: np.ndarray
    measured: np.ndarray
    largest: float
    error: float
    error_at_reversal: float
    error_between: float


@dataclass(frozen=True)
class OnCentre:
    """Figure 8.8: on-centre driving on the rig. Arrays (n,), s and Pa, load pressures.

    error [Pa]: root mean square below 5 Hz. reference_jerks, pressure_jerks [Pa]: root mean
    square above 20 Hz, what the strain gauge's noise makes of the reference and what is left.
    """

    time: np.ndarray
    reference: np.ndarray
    measured: np.ndarray
    error: float
    reference_jerks: float
    pressure_jerks: float


def sine(changes: Mapping[str, float] = NO_CHANGES, node_set: str = "servo_valve") -> Sine:
    """Return servo valves beside the open-centre valve, friction alike (scenario servo_sine)."""
    servo, plain = _run("servo_sine", node_set, changes), _run("servo_sine", "open_centre", {})
    reference = servo.right_valve[:, 0] - servo.left_valve[:, 0]
    pressure, target = _load_pressure(servo), _load_pressure(plain)
    torque = servo.torque[:, 2] - plain.torque[:, 2]
    return Sine(
        _time(servo),
        reference,
        pressure,
        target,
        torque,
        _largest(pressure - reference),
        _largest(pressure - target),
        _largest(torque),
    )


def step(changes: Mapping[str, float] = NO_CHANGES) -> Step:
    """Return the step response of both chambers (scenario servo_step)."""
    trace = _run("servo_step", "servo_valve", changes)
    time, reference = _time(trace), trace.right_valve[:, 0]
    left, right = trace.pressure[:, 0], trace.pressure[:, 1]
    up = int(np.argmax(np.diff(reference) > 0.0)) + 1
    down = int(np.argmax(np.diff(reference) < 0.0)) + 1
    low, high = reference[0], reference[up]
    beyond = max(right[up:down].max() - high, low - right[down:].min())
    rise = _crossing(time[up:down], right[up:down], low + 0.63 * (high - low))
    fall = _crossing(time[down:], -right[down:], -(high - 0.63 * (high - low)))
    return Step(time, reference, left, right, rise, fall, float(max(beyond, 0.0)))


def load_force(changes: Mapping[str, float] = NO_CHANGES) -> LoadForce:
    """Return the load cylinder's force control on the rig (scenario load_cylinder)."""
    trace = _run("load_cylinder", "servo_rig", changes)
    reference, measured = trace.load_cylinder[:, 0], trace.rack[:, 2]
    away = np.abs(measured - reference)
    turns = np.flatnonzero(np.diff(np.sign(trace.rack[:, 1])))
    near = np.zeros(len(away), bool)
    for turn in turns:
        near[max(turn - 50, 0) : turn + 50] = True
    return LoadForce(
        _time(trace),
        reference,
        measured,
        _largest(reference),
        float(away.max()),
        float(np.percentile(away[near], 95)),
        float(np.percentile(away[~near], 95)),
    )


def on_centre(changes: Mapping[str, float] = NO_CHANGES) -> OnCentre:
    """Return on-centre driving at 70 km/h on the rig (scenario servo_on_centre)."""
    trace = _run("servo_on_centre", "servo_rig", changes)
    reference = trace.right_valve[:, 0] - trace.left_valve[:, 0]
    measured = _load_pressure(trace)
    slow = butter(2, 5.0, "lowpass", fs=1.0 / TICK_PERIOD, output="sos")
    fast = butter(2, 20.0, "highpass", fs=1.0 / TICK_PERIOD, output="sos")
    return OnCentre(
        _time(trace),
        reference,
        measured,
        float(np.std(sosfiltfilt(slow, measured - reference))),
        float(np.std(sosfiltfilt(fast, reference))),
        float(np.std(sosfiltfilt(fast, measured))),
    )


def _run(name: str, node_set: str, changes: Mapping[str, float]) -> DirectTrace:
    scenario: Scenario = load_scenario(name)
    given = {**scenario.parameters, **changes}
    scenario = scenario.model_copy(update={"parameters": given})
    return run(build_cores(scenario, load_node_set(node_set)), scenario.ticks)


def _time(trace: DirectTrace) -> np.ndarray:
    return np.arange(len(trace.torque)) * TICK_PERIOD


def _load_pressure(trace: DirectTrace) -> np.ndarray:
    return trace.pressure[:, 1] - trace.pressure[:, 0]


def _largest(values: np.ndarray) -> float:
    return float(np.abs(values).max())


def _crossing(time: np.ndarray, rising: np.ndarray, level: float) -> float:
    """Return the time from the first sample until ``rising`` passes ``level``, interpolated."""
    after = int(np.argmax(rising >= level))
    share = (level - rising[after - 1]) / (rising[after] - rising[after - 1])
    return float(time[after - 1] + share * (time[after] - time[after - 1]) - time[0])
