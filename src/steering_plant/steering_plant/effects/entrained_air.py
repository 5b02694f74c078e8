"""Free air in the oil: the chambers grow soft at low pressure."""

from __future__ import annotations

from steering_core.compiled import kernel
from steering_plant.effects.base import Effect, Parameter

ATMOSPHERE = 1.0e5


@kernel
def bulk_modulus(value, pressure, air_fraction, polytropic_exponent):
    """Return the modulus of oil and air in series [Pa]; both carry the same pressure."""
    if air_fraction <= 0.0:
        return value
    relative = max(pressure + ATMOSPHERE, 1.0) / ATMOSPHERE
    air = air_fraction / (
        polytropic_exponent * ATMOSPHERE * relative ** (1.0 + 1.0 / polytropic_exponent)
    )
    return value / (1.0 + value * air)


EFFECT = Effect(
    name="entrained_air",
    summary="free air in the oil softens the chambers at low pressure",
    sees="pressure lags torque and rack speed below some 20 bar; the more, the lower the pressure",
    equation="1/beta_e = 1/beta + (a/(n p_0)) (p_0/p)^(1 + 1/n), p and p_0 absolute",
    source="H. E. Merritt, Hydraulic Control Systems (1967), chapter 2, with polytropic air",
    balance="left chamber continuity",
    also=("right chamber continuity",),
    excitation="changes of pressure below 20 bar faster than 1 Hz",
    separating="steps of pressure at 5 and at 50 bar against a blocked rack",
    competes=("oil.bulk_modulus",),
    parameters={
        "air_fraction": Parameter("share of volume at atmospheric pressure", "1", 0, 0, 0.1, 0.01),
        "polytropic_exponent": Parameter(
            "of the air's compression", "1", 1.4, 1, 1.4, 1.4, shape=True
        ),
    },
    slots={"bulk_modulus": bulk_modulus},
)
