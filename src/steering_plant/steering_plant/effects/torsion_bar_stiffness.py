"""Torsion bar and column are softer or stiffer than the data sheet says."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="torsion_bar_stiffness",
    summary="torsion bar and column are softer or stiffer",
    sees="torque against twist has another slope; the wheel turns more at the same torque",
    equation="T = factor K_T (theta_sw - R_T x)",
    source="equation 4.1 of the source",
    balance="torsion bar",
    excitation="torsion-bar torque above 1 N m in both directions",
    separating="turn the wheel against a blocked rack; compare torque with twist and with pressure",
    parameters={"factor": Parameter("over the data sheet's", "1", 1, 0.3, 3, 0.85)},
    sets={"factor": factor_of("mechanics.torsion_bar_stiffness")},
)
