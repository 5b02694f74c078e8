"""Column: friction, stiffness, inertia and damping (source section 3.2, figs 3.7 to 3.9)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from steering_bringup.errors import BenchError
from steering_core.compiled import kernel
from steering_core.parameters import ParameterSet
from steering_studies.channels import Channels, require
from steering_studies.identification.estimate import (
    POSITION_GAIN,
    TORQUE_GAIN,
    Estimate,
    fit,
    rate,
    smooth,
)
from steering_studies.identification.friction_element import friction_share

SETTLED_S = 3.0
EVERY = 10
TICK_S = 1e-3


def column_friction(channels: Channels, parameters: ParameterSet) -> dict[str, Estimate]:
    """Return the column's friction [N m] and its displacement constant [rad].

    The rack turns the free wheel (4.1): -T = J theta'' + b theta' + friction, with given J and b.
    """
    angle, torque = require(channels, "steering_wheel_angle", "torsion_bar_torque")
    p = parameters.group("mechanics")
    speed = rate(angle, 20.0)
    moved = -smooth(torque, 20.0) - p["steering_wheel_damping"] * speed
    moved -= p["steering_wheel_inertia"] * np.gradient(speed, TICK_S)
    part = slice(round(SETTLED_S / TICK_S), -500)
    position, friction = smooth(angle, 20.0)[part], moved[part][::EVERY]

    def residual(values: np.ndarray) -> np.ndarray:
        error = friction - values[0] * friction_share(position, values[1])[::EVERY]
        return error - error.mean()

    start = (p["column_friction"], p["column_friction_angle"])
    level, displacement = fit(
        residual,
        start,
        ("N m", "rad"),
        lags=200,
        source="column friction test",
        calibration=TORQUE_GAIN,
    )
    return {"mechanics.column_friction": level, "mechanics.column_friction_angle": displacement}


def stiffness(channels: Channels, parameters: ParameterSet) -> dict[str, Estimate]:
    """Return the stiffness of torsion bar and column in series [N m/rad], rack clamped.

    Slope of the torque over the twist theta - R_T x; the little that a clamp gives is measured.
    """
    angle, torque = require(channels, "steering_wheel_angle", "torsion_bar_torque")
    twist = angle - parameters["mechanics.gear_ratio"] * channels.get("rack_position", 0.0 * angle)
    if np.ptp(twist) < 0.02:
        raise BenchError("stiffness test: the wheel is turned by less than 1 deg")
    x, y = smooth(twist, 20.0)[::EVERY], smooth(torque, 20.0)[::EVERY]
    x, y = x - x.mean(), y - y.mean()
    start = (parameters["mechanics.torsion_bar_stiffness"],)
    (found,) = fit(
        lambda values: y - values[0] * x,
        start,
        ("N m/rad",),
        lags=50,
        source="stiffness test",
        calibration=TORQUE_GAIN + POSITION_GAIN,
    )
    return {"mechanics.torsion_bar_stiffness": found}


@kernel
def _swing(
    inertia: float,
    damping: float,
    limit: float,
    displacement: float,
    stiffness: float,
    angle: float,
    speed: float,
    share: float,
    out: np.ndarray,
) -> None:
    """Fill ``out`` with the angle [rad] of the free wheel, 1 kHz, friction element included."""
    steps = 5
    h = 1e-3 / steps
    for i in range(out.shape[0]):
        out[i] = angle
        for _ in range(steps):
            # Symplectic half steps keep the swing's energy; friction follows the motion exactly.
            angle += 0.5 * h * speed
            step = h * speed
            if step > 0.0:
                share = 1.0 - (1.0 - share) * np.exp(-step / displacement)
            else:
                share = -1.0 + (1.0 + share) * np.exp(step / displacement)
            torque = -stiffness * angle - limit * share
            decay = np.exp(-damping / inertia * h)
            speed = decay * speed + h * torque / inertia
            angle += 0.5 * h * speed


def released_at(channels: Channels) -> int:
    """Return the sample after which nobody holds the wheel; BenchError where it cannot be seen."""
    if "driver_torque" in channels:
        held = np.flatnonzero(np.abs(channels["driver_torque"]) > 1e-9)
        if len(held):
            return int(held[-1]) + 2
    (torque,) = require(channels, "torsion_bar_torque")
    falls = np.abs(rate(torque, 30.0))
    at = int(np.argmax(falls))
    if at < 10 or at > len(torque) - 1000:
        raise BenchError("inertia test: no release of the wheel is seen in the torque")
    return at


def inertia(
    channels: Channels, parameters: ParameterSet, known: Mapping[str, Estimate]
) -> dict[str, Estimate]:
    """Return inertia [kg m2] and damping [N m s/rad] from the free oscillation, rack clamped.

    known: column friction and its displacement constant by full name, from their own test. The
    frequency is sqrt(K_T/J_sw)/(2 pi) (3.1); friction shortens the swing by an amount and damping
    by a share, so its envelope tells them apart.
    """
    angle, torque = require(channels, "steering_wheel_angle", "torsion_bar_torque")
    begin = released_at(channels)
    swing = angle[begin : begin + 2500]
    pull = torque[begin : begin + 2500]
    # The clamp gives a little: what pulls the wheel back is the torque over its own angle.
    K = float(pull @ swing / (swing @ swing))
    if len(swing) < 800:
        raise BenchError("inertia test: less than 0.8 s after the release of the wheel")
    first = np.polyfit(np.arange(12) * TICK_S, swing[:12], 2)
    friction = known["mechanics.column_friction"]
    angle_constant = known["mechanics.column_friction_angle"]
    out = np.zeros(len(swing))

    def residual(values: np.ndarray) -> np.ndarray:
        J, b, start_angle, speed, share, limit, displacement = values
        _swing(J, b, limit, displacement, K, start_angle, speed - 1.0, share - 2.0, out)
        # The friction is known from its own test, as well as that test knows it.
        error = (swing - out)[::2]
        prior = np.array(
            [
                (limit - friction.value) / friction.deviation,
                (displacement - angle_constant.value) / angle_constant.deviation,
            ]
        )
        return np.append(error, prior * np.std(error))

    # The states at release are fitted along, kept positive by an offset.
    start = (
        parameters["mechanics.steering_wheel_inertia"],
        parameters["mechanics.steering_wheel_damping"],
        float(first[2]),
        1.0 + float(first[1]),
        2.5,
        friction.value,
        angle_constant.value,
    )
    units = ("kg m2", "N m s/rad", "rad", "rad/s", "1", "N m", "rad")
    gain = TORQUE_GAIN + POSITION_GAIN
    found = fit(residual, start, units, lags=100, source="inertia test", calibration=gain)
    return {
        "mechanics.steering_wheel_inertia": found[0],
        "mechanics.steering_wheel_damping": found[1],
    }
