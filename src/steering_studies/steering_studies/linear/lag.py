"""Hydraulic lag of the open-centre system: static, where the pump is too small, and dynamic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from steering_core.parameters import ParameterSet
from steering_plant.boost_curve import FORMULA, boost_record, static_pressures
from steering_plant.model import states
from steering_plant.plant import Plant
from steering_studies.linear.open_centre_study import pressure_response
from steering_studies.linear.small_signal import LOCKED, small_signal, without_friction


@dataclass(frozen=True)
class CatchUp:
    """Static lag at rack speeds [m/s] (n,), for a load [N] that opposes the motion.

    predicted, simulated [N m]: torsion-bar torque at that speed (n,). onset_predicted,
    onset_simulated [m/s]: speed at which the torque is 1 N m above that at standstill.
    """

    load: float
    speed: np.ndarray
    predicted: np.ndarray
    simulated: np.ndarray
    onset_predicted: float
    onset_simulated: float


def catch_up(parameters: ParameterSet, load: float = 1500.0, points: int = 14) -> CatchUp:
    """Turn the wheel faster and faster against a load and watch the torque run away.

    The wheel is turned at a speed that rises linearly to 0.3 m/s of the rack within a second.
    """
    quiet = without_friction(parameters)
    speeds = np.linspace(0.0, 0.2, points)
    predicted = np.array([_static_torque(quiet, load, v) for v in speeds])
    speed, torque = _ramp(quiet, load)
    simulated = np.interp(speeds, speed, torque)
    return CatchUp(
        load,
        speeds,
        predicted,
        simulated,
        _onset(speeds, predicted),
        _onset(speeds, simulated),
    )


def _static_torque(parameters: ParameterSet, load: float, speed: float) -> float:
    """Return the torsion-bar torque [N m] that balances a load [N] at a rack speed [m/s]."""
    p, record = parameters.group("mechanics"), boost_record(parameters)[0]
    flow = p["piston_area"] * speed

    def surplus(torque: float) -> float:
        right, left = static_pressures(record, FORMULA, torque, flow)
        push = p["piston_area"] * (right - left) + torque * p["gear_ratio"]
        return float(push - load - p["rack_damping"] * speed)

    return float(brentq(surplus, -5.0, 30.0))


def _ramp(parameters: ParameterSet, load: float) -> tuple[np.ndarray, np.ndarray]:
    """Return rack speed [m/s] and torsion-bar torque [N m] of a slowly accelerated wheel.

    The wheel is led by a stiff, damped driver; speed and torque are means over 40 ms.
    """
    p = parameters.group("mechanics")
    plant = Plant(parameters, "open_centre")
    start, rise, reach = -0.06, 0.16, 0.06
    ticks = round(2000.0 * np.sqrt(reach / rise) * 1.2)
    torque = _static_torque(parameters, load, 0.0)
    y = plant.state
    y[states.POSITION] = start
    y[states.ANGLE] = torque / p["torsion_bar_stiffness"] + p["gear_ratio"] * start
    rows = []
    for tick in range(ticks):
        time = max(tick * 1e-3 - 0.3, 0.0)
        wanted = p["gear_ratio"] * (start + 0.5 * rise * time**2)
        wanted += torque / p["torsion_bar_stiffness"]
        out = plant.out
        if out[6] > reach:
            break
        applied = torque + 600.0 * (wanted - out[0])
        applied += 15.0 * (p["gear_ratio"] * rise * time - out[1])
        rows.append((out[7], out[2]))
        plant.step(tick, applied, 0.0, 0.0, load, 0.0, 0.0)
    mean = np.array(rows)
    smooth = np.ones(40) / 40.0
    speed, twist = (np.convolve(mean[:, k], smooth, "valid") for k in range(2))
    order = np.argsort(speed)
    return speed[order], twist[order]


def _onset(speed: np.ndarray, torque: np.ndarray) -> float:
    above = torque > torque[0] + 1.0
    if not above.any():
        return float("nan")
    first = int(above.argmax())
    return float(
        np.interp(torque[0] + 1.0, torque[first - 1 : first + 1], speed[first - 1 : first + 1])
    )


@dataclass(frozen=True)
class DynamicLag:
    """Frequency [Hz] at which the assistance lags 45 degrees behind the torque, by torque [N m]."""

    torque: np.ndarray
    predicted: np.ndarray
    simulated: np.ndarray


def dynamic_lag(parameters: ParameterSet) -> DynamicLag:
    """Compare the linear model's lag with the nonlinear simulation's, rack held."""
    linear = pressure_response(parameters)
    found = []
    for torque in linear.torque:
        ss = small_signal(parameters, "open_centre", float(torque), stiffness=LOCKED, highest=400.0)
        phase = np.degrees(np.unwrap(np.angle(ss.pressure_by_torque)))
        crossed = phase < -45.0
        found.append(np.interp(45.0, -phase, ss.frequency) if crossed.any() else np.nan)
    return DynamicLag(linear.torque, linear.corner(-45.0), np.array(found))
