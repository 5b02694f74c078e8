"""Slots: the places of the model where effects act. Here, without effects, each is the identity.

Every slot takes the nominal value first, then what it may depend on, then the whole state ``y``,
which ends with the effects' states, and the effects' parameters ``e``; it returns the value to be
used. With effects chosen, a module with the same functions is generated
(steering_plant.effects.compose) and compiled in this one's place.
"""

from __future__ import annotations

from steering_core.compiled import kernel


@kernel
def column_torque(value, angle, speed, y, e):
    """Resisting torque on the steering wheel beside damping and friction [N m], nominally 0."""
    return value


@kernel
def column_friction_limit(value, speed, y, e):
    """Limit of the column's friction element [N m]."""
    return value


@kernel
def torsion_torque(value, twist, y, e):
    """Torque of the torsion bar and column [N m] at a twist [rad]."""
    return value


@kernel
def rack_force(value, position, velocity, left, right, y, e):
    """Resisting force on the rack beside damping, friction and load [N], nominally 0."""
    return value


@kernel
def rack_friction_limit(value, position, velocity, left, right, y, e):
    """Limit of the rack's friction element [N]."""
    return value


@kernel
def rack_friction_middle(value, limit, position, velocity, y, e):
    """Middle of the rack's friction between its limits in both directions [N], nominally 0."""
    return value


@kernel
def load_force(value, position, velocity, y, e):
    """Force of the ideal load on the rack [N]; positive opposes positive motion."""
    return value


@kernel
def valve_torque(value, y, e):
    """Torsion-bar torque as the open-centre valve sees it [N m]."""
    return value


@kernel
def valve_overlap(value, y, e):
    """Torque by which each edge of the open-centre valve closes earlier [N m], nominally 0."""
    return value


@kernel
def bulk_modulus(value, pressure, y, e):
    """Effective bulk modulus [Pa] at a pressure [Pa]."""
    return value


@kernel
def flow_coefficient(value, y, e):
    """Flow coefficient of the valves' edges, times sqrt(2/rho) [sqrt(m3/kg)]."""
    return value


@kernel
def left_flow(value, left, right, y, e):
    """Flow into the left chamber beside its volume change [m3/s]."""
    return value


@kernel
def right_flow(value, left, right, y, e):
    """Flow into the right chamber beside its volume change [m3/s]."""
    return value


@kernel
def left_volume(value, y, e):
    """Volume of the left chamber [m3]."""
    return value


@kernel
def right_volume(value, y, e):
    """Volume of the right chamber [m3]."""
    return value


@kernel
def pump_flow(value, time, y, e):
    """Flow of the open-centre system's pump [m3/s]."""
    return value


@kernel
def supply_pressure(value, time, y, e):
    """Pressure of the supply of control or servo valves [Pa]."""
    return value


@kernel
def spool_opening(value, y, e):
    """Displacement that uncovers the supply edge of a control valve or a servo valve's edge [m]."""
    return value


@kernel
def spool_force(value, spool, speed, y, e):
    """Resisting force on a servo valve's spool beside the modelled ones [N], nominally 0."""
    return value


@kernel
def left_spool_force(value, spool, speed, y, e):
    """Resisting force on the left control valve's spool beside the modelled ones [N]."""
    return value


@kernel
def right_spool_force(value, spool, speed, y, e):
    """Resisting force on the right control valve's spool beside the modelled ones [N]."""
    return value


@kernel
def left_command(value, y, e):
    """Command of the left chamber's valve as it acts over the coming tick."""
    return value


@kernel
def right_command(value, y, e):
    """Command of the right chamber's valve as it acts over the coming tick."""
    return value


@kernel
def left_solenoid(value, y, e):
    """Force of the left valve's solenoid [N]; the value is what the command asks for."""
    return value


@kernel
def right_solenoid(value, y, e):
    """Force of the right valve's solenoid [N]; the value is what the command asks for."""
    return value


@kernel
def load_cylinder_friction_limit(value, speed, y, e):
    """Limit of the load cylinder's friction element [N] at its piston's speed [m/s]."""
    return value


@kernel
def effect_rates(time, y, dy, u, flows, e):
    """Fill the rates of the effects' states, the last ones of ``y``."""


@kernel
def sampled_states(y, u, e):
    """Move the effects' sampled states on at the start of a tick with its commands ``u``."""
