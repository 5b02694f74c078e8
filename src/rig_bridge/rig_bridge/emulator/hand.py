"""A hand on the rig's steering wheel: a motor that follows an angle, the same in every run."""

from __future__ import annotations

from math import pi, radians, sin

from pydantic import Field

from steering_core.strict import Number, Strict


class Hand(Strict):
    """A sine of constant amplitude whose frequency rises linearly, held by a stiff motor.

    torque = stiffness (wanted angle - angle) - damping speed, at most ``largest_torque``.
    """

    amplitude_deg: Number = Field(0.0, ge=0.0, description="0 holds the wheel straight")
    final_frequency_hz: Number = Field(2.0, ge=0.0)
    duration_s: Number = Field(10.0, gt=0.0, description="until the final frequency; it stays then")
    start_s: Number = Field(0.0, ge=0.0, description="after the rig was made to run")
    stiffness: Number = Field(300.0, gt=0.0, description="N m/rad")
    damping: Number = Field(6.0, ge=0.0, description="N m s/rad")
    largest_torque: Number = Field(40.0, gt=0.0, description="N m")

    def angle(self, time: float) -> float:
        """Return the wanted angle [rad] at a time [s] since the rig runs."""
        since = max(time - self.start_s, 0.0)
        sweeping = min(since, self.duration_s)
        cycles = 0.5 * self.final_frequency_hz * sweeping * sweeping / self.duration_s
        cycles += self.final_frequency_hz * (since - sweeping)
        return radians(self.amplitude_deg) * sin(2.0 * pi * cycles)

    def torque(self, time: float, angle: float, speed: float) -> float:
        """Return the motor's torque [N m] on a wheel at ``angle`` [rad] and ``speed`` [rad/s]."""
        wanted = self.stiffness * (self.angle(time) - angle) - self.damping * speed
        return min(max(wanted, -self.largest_torque), self.largest_torque)
