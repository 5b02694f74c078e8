"""Steering wheel, torsion bar and rack around any assistance (4.16 to 4.19, 6.13, 7.14).

The loop that the source draws: the steering wheel angle is the reference, R_T x the answer, and
their difference twists the torsion bar. Friction is left out, as there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from steering_core.parameters import ParameterSet
from steering_plant.linear.linear_model import LinearModel


@dataclass(frozen=True)
class Assistance:
    """Frequency responses of the load pressure, complex (n,), at omega [rad/s] (n,).

    by_torque [Pa/(N m)]; by_rack_speed [Pa s/m], negative: it damps; by_wheel_speed [Pa s/m]: of
    steering wheel speed/R_T, zero for the open-centre valve.
    """

    omega: np.ndarray
    by_torque: np.ndarray
    by_rack_speed: np.ndarray
    by_wheel_speed: np.ndarray


def assistance(model: LinearModel, omega: np.ndarray) -> Assistance:
    """Return the responses of a model with inputs torque and rack_speed."""
    pressure = model.response(omega)[:, model.outputs.index("load_pressure")]
    torque, speed = (model.inputs.index(name) for name in ("torque", "rack_speed"))
    return Assistance(omega, pressure[:, torque], pressure[:, speed], np.zeros(len(omega)))


@dataclass(frozen=True)
class LinearGear:
    """Constants of the gear, SI units. stiffness [N/m]: of the load on the rack (C_rw)."""

    K_T: float
    R_T: float
    M: float
    b: float
    A_p: float
    stiffness: float
    J: float
    b_sw: float

    def loop_gain(self, a: Assistance) -> np.ndarray:
        """Return R_T x over the torsion bar's twist with the loop open, complex (n,)."""
        s = 1j * a.omega
        push = self.K_T * (self.R_T + self.A_p * a.by_torque)
        push = self.R_T * push + self.A_p * s * a.by_wheel_speed
        damping = self.b - self.A_p * (a.by_rack_speed + a.by_wheel_speed)
        return push / (self.M * s * s + damping * s + self.stiffness)

    def closed_loop(self, a: Assistance) -> np.ndarray:
        """Return R_T x over the steering wheel angle (4.19, 6.13, 7.14), complex (n,)."""
        loop = self.loop_gain(a)
        return loop / (1.0 + loop)


def linear_gear(parameters: ParameterSet, stiffness: float | None = None) -> LinearGear:
    """Return the gear; stiffness [N/m] of the load, by default that of the front tyres at speed."""
    p = parameters.group("mechanics")
    return LinearGear(
        p["torsion_bar_stiffness"],
        p["gear_ratio"],
        p["rack_mass"],
        p["rack_damping"],
        p["piston_area"],
        tyre_stiffness(parameters) if stiffness is None else stiffness,
        p["steering_wheel_inertia"],
        p["steering_wheel_damping"],
    )


def tyre_stiffness(parameters: ParameterSet) -> float:
    """Return the rack's stiffness [N/m] by the front tyres while the car does not answer yet."""
    p = parameters.group("vehicle")
    trail = p["pneumatic_trail"] + p["mechanical_trail"]
    return p["front_cornering_stiffness"] * trail / p["steering_arm"] ** 2


def gear_with(model: LinearModel, gear: LinearGear, hands_free: bool = True) -> LinearModel:
    """Return gear and assistance as one model, for its poles.

    hands_free: the wheel turns under the driver's torque; otherwise it is held still. Inputs:
    driver torque [N m] (of no effect on a held wheel). Outputs: torque, rack position, load
    pressure.
    """
    n = len(model.a)
    size = n + 4
    torque = np.zeros(size)
    torque[n], torque[n + 2] = gear.K_T, -gear.K_T * gear.R_T
    row = model.outputs.index("load_pressure")
    by_torque, by_speed = (model.inputs.index(name) for name in ("torque", "rack_speed"))
    a, b = np.zeros((size, size)), np.zeros((size, 1))
    a[:n, :n] = model.a
    a[:n] += np.outer(model.b[:, by_torque], torque)
    a[:n, n + 3] += model.b[:, by_speed]
    pressure = np.zeros(size)
    pressure[:n] = model.c[row]
    if hands_free:
        a[n, n + 1] = 1.0
        a[n + 1] = -torque / gear.J
        a[n + 1, n + 1] -= gear.b_sw / gear.J
        b[n + 1, 0] = 1.0 / gear.J
    a[n + 2, n + 3] = 1.0
    a[n + 3] = (gear.A_p * pressure + gear.R_T * torque) / gear.M
    a[n + 3, n + 2] -= gear.stiffness / gear.M
    a[n + 3, n + 3] -= gear.b / gear.M
    if not hands_free:
        kept = [k for k in range(size) if k not in (n, n + 1)]
        a, b, torque, pressure = a[np.ix_(kept, kept)], b[kept], torque[kept], pressure[kept]
    names = (*model.states, *(GEAR_STATES if hands_free else GEAR_STATES[2:]))
    position = np.array([1.0 if name == "rack_position" else 0.0 for name in names])
    return LinearModel(
        a,
        b,
        np.array([torque, position, pressure]),
        np.zeros((3, 1)),
        names,
        ("driver_torque",),
        ("torque", "rack_position", "load_pressure"),
    )


GEAR_STATES = (
    "steering_wheel_angle",
    "steering_wheel_speed",
    "rack_position",
    "rack_speed",
)
