"""The truth's right-hand side and its step: Runge-Kutta 4 around frictions solved exactly."""

from __future__ import annotations

from math import cos, exp, pi, sin

from steering_core.compiled import kernel

from . import states as s
from .laws import area, bristle, contact, dead_zone, holes, modulus, through


@kernel
def torsion(p, y):
    """Return the torsion bar's torque [N m]; a worn tooth makes the ratio ripple."""
    pinion = p.gear_ratio * y[s.RACK]
    if p.tooth > 0.0:
        pinion += p.tooth * sin(p.teeth * p.gear_ratio * y[s.RACK])
    twist = dead_zone(y[s.ANGLE] - pinion, p.half_gap)
    return (
        p.torsion_bar_stiffness * twist * (1.0 + p.bar_cubic * twist * twist) + y[s.BAR_HYSTERESIS]
    )


@kernel
def discharge(p, time):
    """Return the factor on all flow coefficients; it drifts as the oil warms up."""
    return p.discharge * (1.0 + p.warming * time)


@kernel
def load(p, y, u):
    """Return the force on the rack's end [N], friction of the load cylinder included."""
    return u[s.FORCE_IN] + u[s.STIFFNESS_IN] * (y[s.RACK] - u[s.POSITION_IN]) + y[s.LOAD_FRICTION]


@kernel
def rack_limits(p, y):
    """Return the rack's friction [N]: of the seals alone, and all of it in either direction."""
    pressed = p.friction_left * max(y[s.LEFT], 0.0) + p.friction_right * max(y[s.RIGHT], 0.0)
    seals = max(p.rack_friction + p.rack_friction_pressure_slope * pressed, 1.0)
    limit = seals
    if p.breakaway > 0.0:
        limit += p.breakaway / (1.0 + (y[s.RACK_SPEED] / p.stribeck_speed) ** 2)
    if p.bent > 0.0:
        limit += p.bent * exp(-(((y[s.RACK] - p.bent_at) / p.bent_width) ** 2))
    half = 0.5 * p.coulomb_difference
    return seals, max(limit - half, 1.0), max(limit + half, 1.0)


@kernel
def viscous(p, v, time):
    """Return the rack's viscous friction [N]: linear, a quadratic share, and by direction."""
    force = p.rack_damping * (1.0 - 3.0 * p.warming * time) * v
    force += p.more_damping * v * (1.0 + p.damping_growth * abs(v))
    if p.viscous_difference * v > 0.0:
        force += abs(p.viscous_difference) * v * (1.0 + p.damping_growth * abs(v))
    return force


@kernel
def valve(p, y, d, at, chamber, supply, force, friction, factor):
    """Fill one valve's rates; return flow drawn from the supply and flow into the chamber.

    factor: on the discharge of edges and damping orifice, and so on the momentum of the jets.
    """
    spool, speed, control = y[at], y[at + 1], y[at + 2]
    laminar = p.laminar_transition_pressure
    supply_area = holes(p, p.underlap + spool)
    tank_area = holes(p, p.underlap - spool)
    drawn = through(p, supply_area, supply - chamber, laminar, factor)
    back = through(p, tank_area, chamber, laminar, factor)
    orifice = 0.25 * pi * p.damping_orifice_diameter**2
    damping = through(p, orifice, chamber - control, p.damping_orifice_transition_pressure, factor)
    face = 0.25 * pi * p.pressure_area_diameter**2
    jet = 2.0 * factor * p.flow_coefficient * p.jet_angle_cosine
    closing = jet * (supply_area * abs(supply - chamber) - tank_area * abs(chamber))
    sum_of_forces = force - face * control - p.spring_preload - p.spring_stiffness * spool
    sum_of_forces -= closing + p.spool_damping * speed + friction
    over = abs(spool) - p.maximum_travel
    if over > 0.0:
        outward = speed if spool > 0.0 else -speed
        push = max(p.spool_stop_stiffness * over + p.spool_stop_damping * outward, 0.0)
        sum_of_forces -= push if spool > 0.0 else -push
    d[at] = speed
    d[at + 1] = sum_of_forces / p.spool_mass
    d[at + 2] = modulus(p, control) * (damping + face * speed) / p.control_chamber_volume
    return drawn, drawn - back - damping


@kernel
def magnet(p, y, d, at, command):
    """Return the force [N] of a solenoid that follows in two lags (coil, eddy currents)."""
    d[at], d[at + 1] = 0.0, 0.0
    if p.magnet_lag <= 0.0:
        return command
    d[at] = (command - y[at]) / (0.7 * p.magnet_lag)
    d[at + 1] = (y[at] - y[at + 1]) / (0.3 * p.magnet_lag)
    return y[at + 1]


@kernel
def chambers(p, y, d, into_left, into_right):
    """Fill the rates of both chambers: leaks, hoses, stroke."""
    left, right, v = y[s.LEFT], y[s.RIGHT], y[s.RACK_SPEED]
    across = p.piston_leak * (right - left) - p.piston_drag * v
    into_left += across - p.left_leak * left / (1.0 + max(left, 0.0) / 3e7) ** 0.5
    into_right -= across + p.right_leak * right / (1.0 + max(right, 0.0) / 3e7) ** 0.5
    d[s.LEFT_HOSE], d[s.RIGHT_HOSE] = 0.0, 0.0
    if p.hose > 0.0:
        d[s.LEFT_HOSE] = (p.hose * left - y[s.LEFT_HOSE]) / p.hose_time
        d[s.RIGHT_HOSE] = (p.hose * right - y[s.RIGHT_HOSE]) / p.hose_time
    left_volume = p.chamber_volume + p.left_more_volume - p.piston_area * y[s.RACK]
    right_volume = p.chamber_volume - p.left_more_volume + p.piston_area * y[s.RACK]
    d[s.LEFT] = modulus(p, left) * (into_left + p.piston_area * v - d[s.LEFT_HOSE]) / left_volume
    d[s.RIGHT] = (
        modulus(p, right) * (into_right - p.piston_area * v - d[s.RIGHT_HOSE]) / right_volume
    )


@kernel
def open_centre(p, y, d, u, torque):
    """Fill the open-centre hydraulics: four edges, pump line with relief."""
    left, right, pump, laminar = y[s.LEFT], y[s.RIGHT], y[s.SUPPLY], p.laminar_transition_pressure
    factor = discharge(p, u[s.TIME])
    valve_torque = torque + p.boost_offset
    a1, a2 = area(p, valve_torque - p.lap_torque), area(p, -valve_torque - p.lap_torque)
    to_right, to_left = (
        through(p, a1, pump - right, laminar, factor),
        through(p, a2, pump - left, laminar, factor),
    )
    into_right = to_right - through(p, a2, right, laminar, factor)
    into_left = to_left - through(p, a1, left, laminar, factor)
    phase = 2.0 * pi * p.ripple_frequency * u[s.TIME] + p.ripple_phase
    flow = p.pump_flow * (1.0 + p.ripple * (sin(phase) + 0.15 * cos(2.0 * phase)))
    relief = p.relief_slope * max(pump - p.relief_pressure, 0.0)
    d[s.SUPPLY] = modulus(p, pump) * (flow - relief - to_right - to_left) / p.pump_volume
    d[s.ENERGY] = pump * flow
    for i in range(s.LEFT_VALVE, s.BENDING):
        d[i] = 0.0
    chambers(p, y, d, into_left, into_right)


@kernel
def closed_centre(p, y, d, u):
    """Fill the closed-centre hydraulics: two pressure control valves on one supply."""
    supply = y[s.SUPPLY]
    factor = discharge(p, u[s.TIME])
    left_force = magnet(p, y, d, s.LEFT_MAGNET, u[s.LEFT_IN])
    right_force = magnet(p, y, d, s.RIGHT_MAGNET, u[s.RIGHT_IN])
    one, into_left = valve(
        p, y, d, s.LEFT_VALVE, y[s.LEFT], supply, left_force, y[s.LEFT_STICTION], factor
    )
    two, into_right = valve(
        p, y, d, s.RIGHT_VALVE, y[s.RIGHT], supply, right_force, y[s.RIGHT_STICTION], factor
    )
    d[s.SUPPLY] = 0.0
    if p.droop > 0.0:
        # An accumulator behind a line: its gas grows stiffer as it is compressed.
        stiffer = (supply / p.supply_pressure) ** 1.2
        d[s.SUPPLY] = (p.supply_pressure - supply - p.droop * (one + two)) / p.droop_time * stiffer
    d[s.ENERGY] = supply * (one + two)
    chambers(p, y, d, into_left, into_right)


@kernel
def given_pressures(d, u):
    """Fill the rates of hydraulics of which the chambers' pressures are given, and nothing else."""
    for i in range(s.LEFT, s.BENDING):
        d[i] = 0.0
    d[s.LEFT_HOSE], d[s.RIGHT_HOSE], d[s.ENERGY] = 0.0, 0.0, 0.0
    d[s.LEFT], d[s.RIGHT] = u[s.LEFT_RISE], u[s.RIGHT_RISE]


@kernel
def rates(p, y, u, d):
    """Fill the time derivatives of the smooth states."""
    torque = torsion(p, y)
    if p.pressed > 0.0:
        given_pressures(d, u)
    elif p.closed > 0.0:
        closed_centre(p, y, d, u)
    else:
        open_centre(p, y, d, u, torque)
    v = y[s.RACK_SPEED]
    resisting = viscous(p, v, u[s.TIME]) + y[s.RACK_FRICTION] + load(p, y, u)
    resisting += contact(p, y[s.RACK], v)
    d[s.BENDING], d[s.BENDING_SPEED] = 0.0, 0.0
    if p.bending_mass > 0.0:
        stiffness = p.bending_mass * p.bending_rate**2
        back = stiffness * (y[s.RACK] - y[s.BENDING])
        back += 0.06 * p.bending_mass * p.bending_rate * (v - y[s.BENDING_SPEED])
        resisting += back
        d[s.BENDING], d[s.BENDING_SPEED] = y[s.BENDING_SPEED], back / p.bending_mass
    d[s.ANGLE], d[s.RACK] = y[s.SPEED], v
    d[s.SPEED] = u[s.ACCELERATION]
    if p.clamped <= 0.0:
        d[s.SPEED] = (u[s.TORQUE_IN] - torque - column(p, y)) / p.steering_wheel_inertia
    pressed = p.piston_area * (y[s.RIGHT] - y[s.LEFT])
    d[s.RACK_SPEED] = (pressed + p.gear_ratio * torque - resisting) / p.rack_mass


@kernel
def column(p, y):
    """Return what resists the steering wheel beside the torsion bar [N m]."""
    cogging = p.cogging * sin(p.cogs * y[s.ANGLE])
    return p.steering_wheel_damping * y[s.SPEED] + y[s.COLUMN_FRICTION] + cogging


@kernel
def rub(p, y, period):
    """Move the frictions on over ``period`` at the present speeds.

    What makes a limit differ with direction, speed or place leaves the bristles as stiff as they
    are (LuGre): they only bend further. Stiffer ones on the way out than back would give energy.
    """
    v = y[s.RACK_SPEED]
    y[s.COLUMN_FRICTION] = bristle(
        y[s.COLUMN_FRICTION],
        p.column_friction,
        p.column_friction,
        p.column_friction_angle,
        y[s.SPEED],
        period,
    )
    seals, back, forth = rack_limits(p, y)
    bent = p.rack_friction_displacement * (forth if v > 0.0 else back) / seals
    y[s.RACK_FRICTION] = bristle(y[s.RACK_FRICTION], back, forth, bent, v, period)
    level = p.load_friction
    if level > 0.0:
        y[s.LOAD_FRICTION] = bristle(y[s.LOAD_FRICTION], level, level, 1e-4, v, period)
    if p.stiction > 0.0:
        for at, friction in ((s.LEFT_VALVE, s.LEFT_STICTION), (s.RIGHT_VALVE, s.RIGHT_STICTION)):
            speed = y[at + 1]
            more = 1.0 + 0.15 / (1.0 + (speed / 2e-3) ** 2)
            limit, bent = p.stiction * more, p.stiction_displacement * more
            y[friction] = bristle(y[friction], limit, limit, bent, speed, period)
    if p.bar_hysteresis > 0.0:
        twisting = y[s.SPEED] - p.gear_ratio * v
        limit = p.bar_hysteresis
        y[s.BAR_HYSTERESIS] = bristle(y[s.BAR_HYSTERESIS], limit, limit, 5e-3, twisting, period)


@kernel
def substep(p, y, u, h, k1, k2, k3, k4, at):
    """Advance ``y`` in place by ``h`` [s]: half a friction step, Runge-Kutta 4, half a step."""
    n = s.SMOOTH
    rub(p, y, 0.5 * h)
    for i in range(y.shape[0]):
        at[i] = y[i]
    rates(p, y, u, k1)
    for i in range(n):
        at[i] = y[i] + 0.5 * h * k1[i]
    u[s.TIME] += 0.5 * h
    u[s.FORCE_IN] += 0.5 * h * u[s.RISE]
    rates(p, at, u, k2)
    for i in range(n):
        at[i] = y[i] + 0.5 * h * k2[i]
    rates(p, at, u, k3)
    for i in range(n):
        at[i] = y[i] + h * k3[i]
    u[s.TIME] += 0.5 * h
    u[s.FORCE_IN] += 0.5 * h * u[s.RISE]
    rates(p, at, u, k4)
    for i in range(n):
        y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
    rub(p, y, 0.5 * h)
