"""A model against a system test, as in section 4.5 of the source: five channels, overlaid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.errors import BenchError
from steering_bringup.scenario_files import load_node_set
from steering_bringup.schema import Scenario
from steering_core.parameters import ParameterSet
from steering_studies.channels import Channels, from_direct, require
from steering_studies.identification.estimate import smooth

COMPARED: dict[str, str] = {
    "steering_wheel_angle": "rad",
    "torsion_bar_torque": "N m",
    "rack_position": "m",
    "supply_pressure": "Pa",
    "load_pressure": "Pa",
}
"""Channels that the source compares (figs 4.8 to 4.12), with their unit."""

CUT_OFF_HZ = 30.0
"""The driver's lead would turn the angle's noise into torque."""

SETTLED_S = 0.5


@dataclass(frozen=True)
class Merit:
    """How well one channel is met. rms, peak: of the error, SI. fit: 1 - rms over the signal's own.

    delay: s by which the model is late (positive) where that makes the error smallest.
    """

    unit: str
    rms: float
    peak: float
    fit: float
    delay: float


@dataclass(frozen=True)
class Validation:
    """Measured and simulated channels, (n,) each, and each one's figures of merit."""

    time: np.ndarray
    measured: Mapping[str, np.ndarray]
    simulated: Mapping[str, np.ndarray]
    merits: Mapping[str, Merit]


def validate(
    channels: Channels,
    parameters: ParameterSet,
    valve_system: str = "open_centre",
    boost_curve: Mapping[str, Sequence[float]] | None = None,
) -> Validation:
    """Return a model's answer to a system test beside the measurement.

    The driver model follows the measured steering wheel angle, and the measured rack force loads
    the rack: nothing else of the record is used. Raises BenchError for a record without them.
    """
    angle, force = require(channels, "steering_wheel_angle", "rack_force")
    if len(angle) < 2000:
        raise BenchError(f"validation: the record lasts {len(angle)} ms, at least 2 s are needed")
    seconds = tuple((np.arange(len(angle)) * 1e-3).tolist())
    wanted = smooth(angle, CUT_OFF_HZ)
    scenario = Scenario.model_validate(
        {
            "schema": 1,
            "name": "validation",
            "node_set": valve_system,
            "duration": len(angle) * 1e-3,
            "manoeuvre": {
                "kind": "table",
                "time_s": seconds,
                "steering_wheel_angle_deg": tuple(np.degrees(wanted).tolist()),
            },
            "load": {
                "kind": "table",
                "time_s": seconds,
                "rack_force_n": tuple(force.tolist()),
            },
            "parameters": parameters.flat(),
            "boost_curve": boost_curve,
            "truth": False,
        }
    )
    cores = build_cores(scenario, load_node_set(valve_system))
    answer = from_direct(run(cores, scenario.ticks))
    measured, simulated = _compared(channels), _compared(answer)
    merits = {
        name: merit(measured[name], simulated[name], unit)
        for name, unit in COMPARED.items()
        if name in measured
    }
    return Validation(np.arange(len(angle)) * 1e-3, measured, simulated, merits)


def merit(measured: np.ndarray, simulated: np.ndarray, unit: str) -> Merit:
    """Return the figures of merit of one channel after the first half second."""
    part = slice(round(SETTLED_S * 1e3), None)
    error = (simulated - measured)[part]
    own = float(np.std(measured[part]))
    rms = float(np.sqrt(np.mean(error**2)))
    lags = np.arange(-30, 31)
    rest = [np.mean((np.roll(simulated, -lag) - measured)[part][:-60] ** 2) for lag in lags]
    return Merit(
        unit,
        rms,
        float(np.max(np.abs(error))),
        1.0 - rms / own if own > 0.0 else 0.0,
        float(lags[int(np.argmin(rest))]) * 1e-3,
    )


def _compared(channels: Channels) -> dict[str, np.ndarray]:
    found = {name: channels[name] for name in COMPARED if name in channels}
    if "left_pressure" in channels and "right_pressure" in channels:
        found["load_pressure"] = channels["right_pressure"] - channels["left_pressure"]
    return found
