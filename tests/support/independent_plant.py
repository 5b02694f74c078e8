"""The steering plant written a second time, from the equations and the data sheet alone.

Nothing of the plant's model is imported. Where two forms of one law exist the other one is taken:
the holes by the arc cosine, the bridge areas by (4.7, 4.8), the limits of friction by a projected
differential equation (where the limit falls it carries the force along), end stops by cases.
Compiled, so that stiff solvers get through a manoeuvre.
"""

# mypy: allow-untyped-defs

from math import acos, copysign, exp, hypot, pi, sqrt, tanh
from typing import NamedTuple

import numba
import numpy as np
from scipy.integrate import odeint, solve_ivp
from scipy.optimize import brentq

GROUPS = (
    "mechanics",
    "oil",
    "open_centre",
    "closed_centre",
    "pressure_control_valve",
)
MECHANICS = ["angle", "speed", "x", "v", "column_friction", "rack_friction", "left", "right"]
OPEN_CENTRE = [*MECHANICS, "energy", "pump"]
VALVES = ["left_spool", "left_spool_speed", "left_control"]
VALVES += ["right_spool", "right_spool_speed", "right_control"]
CLOSED_CENTRE = [*MECHANICS, "energy", *VALVES]
# Absolute tolerances of the stiff solvers, about 1e-9 of each state's range.
ABSOLUTE = {
    "angle": 1e-10,
    "speed": 1e-9,
    "x": 1e-12,
    "v": 1e-10,
    "column_friction": 1e-9,
    "rack_friction": 1e-6,
    "left": 1e-2,
    "right": 1e-2,
    "energy": 1e-5,
    "pump": 1e-2,
    "left_spool": 1e-12,
    "left_spool_speed": 1e-9,
    "left_control": 1e-2,
    "right_spool": 1e-12,
    "right_spool_speed": 1e-9,
    "right_control": 1e-2,
}


class Sheet(NamedTuple):
    """The data sheet's values, SI units."""

    steering_wheel_inertia: float
    torsion_bar_stiffness: float
    steering_wheel_damping: float
    gear_ratio: float
    rack_mass: float
    rack_damping: float
    piston_area: float
    column_friction: float
    column_friction_angle: float
    rack_friction: float
    rack_friction_pressure_slope: float
    rack_friction_displacement: float
    rack_stop_position: float
    rack_stop_stiffness: float
    rack_stop_damping: float
    density: float
    flow_coefficient: float
    bulk_modulus: float
    laminar_transition_pressure: float
    atmospheric_pressure: float
    pump_flow: float
    chamber_volume: float
    pump_volume: float
    relief_pressure: float
    relief_slope: float
    boost_scale: float
    boost_rate: float
    boost_linear_above: float
    boost_reference_flow: float
    boost_reference_density: float
    boost_reference_flow_coefficient: float
    centre_opening: float
    maximum_opening: float
    supply_pressure: float
    pressure_area_diameter: float
    spring_stiffness: float
    hole_diameter: float
    spring_preload: float
    spool_mass: float
    spool_damping: float
    jet_angle_cosine: float
    control_chamber_volume: float
    damping_orifice_diameter: float
    damping_orifice_transition_pressure: float
    underlap: float
    maximum_travel: float
    spool_stop_stiffness: float
    spool_stop_damping: float


compiled = numba.njit(cache=True, error_model="numpy")


def sheet(parameters):
    """Return the data sheet's values as a named tuple."""
    values = {}
    for group in GROUPS:
        values.update(parameters.group(group))
    return Sheet(*(values[name] for name in Sheet._fields))


@compiled
def holes(c, depth):
    """Open area [m2] of four round holes uncovered to a depth [m]: circle segments."""
    r = 0.5 * c.hole_diameter
    if depth <= 0.0:
        return 0.0
    if depth >= 2.0 * r:
        return 4.0 * pi * r * r
    return 4.0 * (r * r * acos(1.0 - depth / r) - (r - depth) * sqrt(depth * (2.0 * r - depth)))


@compiled
def through(c, area, drop, transition):
    """Flow [m3/s] through a edge, C_q A sqrt(2 dp/rho) with sign, laminar below transition."""
    return c.flow_coefficient * area * sqrt(2.0 / c.density / hypot(drop, transition)) * drop


@compiled
def boost(c, torque):
    """Load pressure [Pa] without load flow, exponential, linear above the knee."""
    size = abs(torque)
    if size <= c.boost_linear_above:
        value = c.boost_scale * (exp(c.boost_rate * size) - 1.0)
    else:
        knee = c.boost_scale * exp(c.boost_rate * c.boost_linear_above)
        value = knee - c.boost_scale + knee * c.boost_rate * (size - c.boost_linear_above)
    return copysign(value, torque)


@compiled
def areas(c, torque):
    """Bridge areas (A1, A2) [m2]: the wide one by its law, the narrow one by (4.7)."""
    q, rho, cq = (
        c.boost_reference_flow,
        c.boost_reference_density,
        c.boost_reference_flow_coefficient,
    )
    k = rho * q * q / (8.0 * cq * cq)
    slope = c.boost_scale * c.boost_rate * c.centre_opening**3 / (4.0 * k)
    span = c.maximum_opening - c.centre_opening
    wide = c.centre_opening + span * tanh(slope * abs(torque) / span)
    pump_less_load = 2.0 * k / wide**2
    pump_and_load = pump_less_load + 2.0 * abs(boost(c, torque))
    narrow = q / (2.0 * cq) * sqrt(rho / pump_and_load)
    return (wide, narrow) if torque >= 0.0 else (narrow, wide)


@compiled
def modulus(c, pressure):
    """Bulk modulus [Pa]; below zero gauge it falls with the square of the absolute pressure."""
    if pressure >= 0.0:
        return c.bulk_modulus
    return c.bulk_modulus * (1.0 + pressure / c.atmospheric_pressure) ** 2


@compiled
def one_sided_stop(position, speed, limit, stiffness, damping):
    """Force of a pair of stops [N] that push inwards only."""
    if position > limit:
        return max(0.0, stiffness * (position - limit) + damping * speed)
    if position < -limit:
        return min(0.0, stiffness * (position + limit) + damping * speed)
    return 0.0


@compiled
def projected(force, limit, limit_rate, speed, displacement):
    """Rate of a friction force: exponential spring inside +-limit, carried along by the limit."""
    direction = 1.0 if speed > 0.0 else -1.0
    rate = speed * (limit - force * direction) / displacement
    if force >= limit:
        rate = min(rate, limit_rate)
    if force <= -limit:
        rate = max(rate, -limit_rate)
    return rate


@compiled
def valve(c, supply, pressure, spool, speed, control, solenoid):
    """Pressure control valve, (5.1) to (5.7).

    Returns flow drawn [m3/s], flow into the chamber [m3/s], spool acceleration, control rate.
    """
    supply_area = holes(c, c.underlap + spool)
    tank_area = holes(c, c.underlap - spool)
    drawn = through(c, supply_area, supply - pressure, c.laminar_transition_pressure)
    returned = through(c, tank_area, pressure, c.laminar_transition_pressure)
    orifice = 0.25 * pi * c.damping_orifice_diameter**2
    damping = through(c, orifice, pressure - control, c.damping_orifice_transition_pressure)
    face = 0.25 * pi * c.pressure_area_diameter**2
    closing = abs(2.0 * c.flow_coefficient * supply_area * (supply - pressure) * c.jet_angle_cosine)
    opening = abs(2.0 * c.flow_coefficient * tank_area * pressure * c.jet_angle_cosine)
    force = solenoid - control * face - c.spring_preload - c.spring_stiffness * spool
    force += opening - closing - c.spool_damping * speed
    force -= one_sided_stop(
        spool, speed, c.maximum_travel, c.spool_stop_stiffness, c.spool_stop_damping
    )
    rate = modulus(c, control) * (damping + face * speed) / c.control_chamber_volume
    return drawn, drawn - returned - damping, force / c.spool_mass, rate


@compiled
def derivatives(y, t, c, closed, u, dy, carried):
    """Right-hand side; u: driver torque, left and right solenoid, load force, stiffness, position.

    carried: whether a falling limit carries the friction's state along. That makes the right-hand
    side jump at the limit; solvers that fit their step to the error get the continuous form, in
    which the state waits outside the limit until the next ``project``.
    """
    angle, omega, x, v, column, rack, left, right = y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7]
    torque = c.torsion_bar_stiffness * (angle - c.gear_ratio * x)
    left_volume = c.chamber_volume - c.piston_area * x
    right_volume = c.chamber_volume + c.piston_area * x
    if closed:
        supply = c.supply_pressure
        drawn, into_left, dy[10], dy[11] = valve(c, supply, left, y[9], y[10], y[11], u[1])
        more, into_right, dy[13], dy[14] = valve(c, supply, right, y[12], y[13], y[14], u[2])
        dy[9], dy[12] = y[10], y[13]
        dy[8] = supply * (drawn + more)
    else:
        pump, t0 = y[9], c.laminar_transition_pressure
        a1, a2 = areas(c, torque)
        pump_right, pump_left = through(c, a1, pump - right, t0), through(c, a2, pump - left, t0)
        into_right = pump_right - through(c, a2, right, t0)
        into_left = pump_left - through(c, a1, left, t0)
        relieved = c.relief_slope * (pump - c.relief_pressure) if pump > c.relief_pressure else 0.0
        lost = pump_right + pump_left + relieved
        dy[9] = modulus(c, pump) * (c.pump_flow - lost) / c.pump_volume
        dy[8] = pump * c.pump_flow
    dy[6] = modulus(c, left) * (into_left + c.piston_area * v) / left_volume
    dy[7] = modulus(c, right) * (into_right - c.piston_area * v) / right_volume

    level, level_rate = c.rack_friction, 0.0
    if left > 0.0:
        level += c.rack_friction_pressure_slope * left
        level_rate += c.rack_friction_pressure_slope * dy[6]
    if right > 0.0:
        level += c.rack_friction_pressure_slope * right
        level_rate += c.rack_friction_pressure_slope * dy[7]
    column = min(max(column, -c.column_friction), c.column_friction)
    rack = min(max(rack, -level), level)
    dy[4] = projected(column, c.column_friction, np.inf, omega, c.column_friction_angle)
    if not carried:
        level_rate = np.inf
    dy[5] = projected(rack, level, level_rate, v, c.rack_friction_displacement)

    stop = one_sided_stop(x, v, c.rack_stop_position, c.rack_stop_stiffness, c.rack_stop_damping)
    resisting = c.rack_damping * v + rack + u[3] + u[4] * (x - u[5]) + stop
    dy[0], dy[2] = omega, v
    dy[1] = (u[0] - torque - c.steering_wheel_damping * omega - column) / c.steering_wheel_inertia
    dy[3] = (c.piston_area * (right - left) + c.gear_ratio * torque - resisting) / c.rack_mass


@compiled
def project(c, y):
    """Put the friction forces back on their limits, at the restart of each tick."""
    level = c.rack_friction
    level += c.rack_friction_pressure_slope * (max(y[6], 0.0) + max(y[7], 0.0))
    y[4] = min(max(y[4], -c.column_friction), c.column_friction)
    y[5] = min(max(y[5], -level), level)


@compiled
def runge_kutta(c, closed, y, u, span, steps):
    """Integrate in place with the classical method of fourth order in equal small steps."""
    n = y.shape[0]
    k1, k2, k3, k4 = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    h = span / steps
    for _ in range(steps):
        derivatives(y, 0.0, c, closed, u, k1, True)
        derivatives(y + 0.5 * h * k1, 0.0, c, closed, u, k2, True)
        derivatives(y + 0.5 * h * k2, 0.0, c, closed, u, k3, True)
        derivatives(y + h * k3, 0.0, c, closed, u, k4, True)
        y += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        project(c, y)


@compiled
def slopes(y, t, c, closed, u):
    """Return the right-hand side as a new array, as scipy's solvers want it."""
    dy = np.empty(y.shape[0])
    derivatives(y, t, c, closed, u, dy, False)
    return dy


class IndependentPlant:
    """Steps like the plant does, by a scipy solver restarted every tick with held commands."""

    def __init__(self, parameters, valve_system, solver="LSODA", rtol=1e-7):
        self.c = sheet(parameters)
        self.closed = valve_system == "closed_centre"
        self.names = CLOSED_CENTRE if self.closed else OPEN_CENTRE
        self.solver, self.rtol = solver, rtol
        self.atol = np.array([ABSOLUTE[name] for name in self.names])
        self.state = self.rest()
        self.inputs = np.zeros(6)
        self.out = self.observed()

    def rest(self):
        """Return the equilibrium: both chambers at half the pump's idle pressure."""
        c, y = self.c, np.zeros(len(self.names))
        y[6:8] = self.idle_pressure()
        if not self.closed:
            y[9] = 2.0 * y[6]
            return y
        y[11] = y[14] = y[6]
        if c.underlap > 0.0:
            y[9] = y[12] = brentq(self.surplus, -c.underlap, c.underlap, args=(y[6],), xtol=1e-16)
        return y

    def idle_pressure(self):
        """Return the pressure that half the pump's flow needs through a centred edge."""
        c = self.c
        laminar = 0.0 if self.closed else c.laminar_transition_pressure
        return brentq(
            lambda p: 2.0 * through(c, c.centre_opening, p, laminar) - c.pump_flow, 1.0, 1e8
        )

    def surplus(self, spool, pressure):
        """Return supply flow less tank flow of a valve [m3/s]."""
        return valve(self.c, self.c.supply_pressure, pressure, spool, 0.0, pressure, 0.0)[1]

    def observed(self):
        """Return what ideal sensors report, in the order of the messages."""
        c, y, u = self.c, self.state, self.inputs
        torque = c.torsion_bar_stiffness * (y[0] - c.gear_ratio * y[2])
        supply = c.supply_pressure if self.closed else y[9]
        load = u[3] + u[4] * (y[2] - u[5])
        return np.array([y[0], y[1], torque, y[6], y[7], supply, y[2], y[3], load])

    def step(self, tick, *inputs):
        """Integrate over one tick and return the measurement at its end."""
        self.inputs[:] = inputs
        self.state = self.integrated(1e-3)
        project(self.c, self.state)
        self.out = self.observed()
        return self.out

    def integrated(self, span):
        """Return the state after ``span`` seconds."""
        if self.solver == "runge_kutta":
            y = self.state.copy()
            runge_kutta(self.c, self.closed, y, self.inputs, span, round(span / 2e-5))
            return y
        arguments = (self.c, self.closed, self.inputs)
        if self.solver == "LSODA":
            grid = np.array([0.0, span])
            return odeint(
                slopes, self.state, grid, arguments, rtol=self.rtol, atol=self.atol, mxstep=20000
            )[-1]
        solved = solve_ivp(
            lambda t, y: slopes(y, t, *arguments),
            (0.0, span),
            self.state,
            self.solver,
            rtol=self.rtol,
            atol=self.atol,
        )
        assert solved.success, solved.message
        return solved.y[:, -1]
