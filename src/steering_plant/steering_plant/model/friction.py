"""The friction element: an exponential spring with limited force and hysteresis."""

from __future__ import annotations

from steering_core.compiled import kernel


@kernel
def friction_rate(force, limit, velocity, displacement):
    """Return dF/dt of the exponential spring with limited force (after Pfeffer, fig 4.2).

    dF/dt = v (limit - F sign(v))/displacement: F tends to +-limit exponentially in displacement.
    Any unit of force and the matching ones of velocity and displacement.
    """
    return (limit * velocity - force * abs(velocity)) / displacement


@kernel
def limited(force, limit):
    """Return ``force`` within +-limit: a falling limit releases the spring, never loads it."""
    return min(max(force, -limit), limit)


@kernel
def yielding_rate(force, nominal, reached, velocity, displacement):
    """Return dF/dt of the element whose limit ``reached`` depends on the motion.

    dF/dt = (nominal/displacement) (v - F |v|/reached): the spring under it stays as stiff as the
    nominal one, so that a limit that differs with direction or speed (Stribeck) creates no energy,
    however small the cycles. With the nominal limit it is ``friction_rate``, bit for bit. Without
    friction both limits are zero, and so is the force.
    """
    share = nominal / reached if reached > 0.0 else 1.0
    return (nominal * velocity - force * abs(velocity) * share) / displacement
