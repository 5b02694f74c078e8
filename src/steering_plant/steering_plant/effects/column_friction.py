"""The column's friction is higher or lower than the data sheet says."""

from __future__ import annotations

from steering_plant.effects.base import Effect, Parameter, factor_of

EFFECT = Effect(
    name="column_friction",
    summary="the column's friction is higher or lower",
    sees="driver torque minus torsion-bar torque jumps more at reversals",
    equation="T_lim = factor T_0",
    source="P. Pfeffer and M. Harrer, Steering Handbook (2017), chapter on steering feel",
    balance="column torque",
    excitation="reversals of the steering wheel, and the driver's torque measured",
    separating="slow triangles of angle with the driver's torque measured",
    parameters={"factor": Parameter("over the data sheet's", "1", 1, 0.05, 10, 2)},
    sets={"factor": factor_of("mechanics.column_friction")},
)
