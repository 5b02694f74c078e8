"""Laws of the truth: orifices, holes, bridge, oil, friction. Forms differ from the library's."""

from __future__ import annotations

from math import acos, copysign, exp, hypot, pi, sqrt, tanh

from steering_core.compiled import kernel


@kernel
def holes(p, depth):
    """Return the area [m2] of four round holes uncovered to a depth [m]: arc cosine."""
    r = 0.5 * p.hole_diameter
    if depth <= 0.0:
        return 0.0
    if depth >= 2.0 * r:
        return 4.0 * pi * r * r
    return 4.0 * (r * r * acos(1.0 - depth / r) - (r - depth) * sqrt(depth * (2.0 * r - depth)))


@kernel
def through(p, area, drop, transition, discharge):
    """Return the flow [m3/s] through an edge; discharge: factor on the flow coefficient."""
    root = sqrt(2.0 / p.density / hypot(drop, transition))
    return discharge * p.flow_coefficient * area * root * drop


@kernel
def boost(p, torque):
    """Return the load pressure's size [Pa] without load flow at a torque's size [N m]."""
    if torque <= p.boost_linear_above:
        return p.boost_scale * (exp(p.boost_rate * torque) - 1.0)
    knee = p.boost_scale * exp(p.boost_rate * p.boost_linear_above)
    return knee - p.boost_scale + knee * p.boost_rate * (torque - p.boost_linear_above)


@kernel
def area(p, torque):
    """Return the area [m2] of the edge that opens with positive torque [N m] (eq. 4.7, 4.8)."""
    q, cq = p.boost_reference_flow, p.boost_reference_flow_coefficient
    k = p.boost_reference_density * q * q / (8.0 * cq * cq)
    slope = p.boost_scale * p.boost_rate * p.centre_opening**3 / (4.0 * k)
    span = p.maximum_opening - p.centre_opening
    size = abs(torque)
    wide = p.centre_opening + span * tanh(slope * size / span)
    if torque >= 0.0:
        return wide
    return (
        q
        / (2.0 * cq)
        * sqrt(p.boost_reference_density / (2.0 * k / wide**2 + 2.0 * boost(p, size)))
    )


@kernel
def modulus(p, pressure):
    """Return the bulk modulus [Pa] of oil with free air that shrinks as (p0/p)^(1/n) (Wylie)."""
    value = p.bulk_modulus
    absolute = pressure + p.atmospheric_pressure
    if pressure < 0.0:
        value *= (absolute / p.atmospheric_pressure) ** 2
    if p.air > 0.0:
        absolute = max(absolute, 1e3)
        share = p.air * (p.atmospheric_pressure / absolute) ** (1.0 / p.air_exponent)
        value *= (1.0 + share) / (1.0 + share * value / (p.air_exponent * absolute))
    return value


@kernel
def bristle(force, back, forth, displacement, speed, period):
    """Return a bristle's force [N] after ``period`` at constant speed: Dahl's law, exactly solved.

    back, forth: sliding friction against negative and positive speed. displacement: the one that
    acts over the bristle's stiffness [m]; with a friction that follows a Stribeck curve and a
    constant stiffness it is the LuGre law without micro-damping.
    """
    force = min(max(force, -back), forth)
    towards = forth if speed > 0.0 else -back
    return towards + (force - towards) * exp(-abs(speed) * period / displacement)


@kernel
def dead_zone(twist, half):
    """Return twist less what a play of +-half takes up, with flanks rounded over half/20."""
    if half <= 0.0:
        return twist
    soft = 0.05 * half
    return twist + 0.5 * (hypot(twist - half, soft) - hypot(twist + half, soft))


@kernel
def contact(p, position, velocity):
    """Return the force [N] of the end stops: spring and damper at the nominal place.

    An early stop is a rubber: Hunt and Crossley's law with exponent 1.2 before the nominal one.
    """
    depth = abs(position) - p.rack_stop_position
    outward = copysign(1.0, position) * velocity
    size = 0.0
    if depth > 0.0:
        size += max(p.rack_stop_stiffness * depth + p.rack_stop_damping * outward, 0.0)
    depth = abs(position) - (p.rack_stop_position - p.stop_earlier)
    if p.stop_earlier > 0.0 and depth > 0.0:
        size += p.stop_soft * depth**1.2 * max(1.0 + 1.5 * outward, 0.0)
    return copysign(size, position)
