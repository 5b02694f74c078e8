"""The catalogue's effects in the truth's own formulas. Add one here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.changes import (
    CLOSED,
    OPEN,
    TrueEffect,
    aged,
    exact,
    extra,
    factor,
    factor_extra,
    more,
    same,
    sensor,
    several,
)
from steering_diagnosis.benchmark.truth.specimen import Specimen


def _no_breakaway(_: float) -> dict[str, float]:
    """Return nothing: no Gaussian curve stands for the truth's hyperbolic one.

    A bristle has not reached its level yet where the speed is near zero, so what a record shows is
    the curve's flank, where the two differ. The Gaussian that fits it best has 0.4 to 0.75 of the
    truth's height and 1.7 to 2.6 times its speed, as the record and the height may be.
    """
    return {}


def _spool_level(size: float) -> dict[str, float]:
    """Return the friction at which the spools really slide.

    Up to 0.4 N they creep at a tenth of a millimetre per second, where all of the breakaway is
    there; with more they stick and slip, and slide ten times as fast, where it is gone.
    """
    return {"level": size + 0.15 * min(size, 0.4)}


def _soft_stop(made: Specimen, nominal: ParameterSet, size: float) -> Specimen:
    """Return a rubber stop that is met early; as stiff at 2 mm as a tenth of the nominal one."""
    stiffness = 0.1 * nominal["mechanics.rack_stop_stiffness"] * 2e-3 / 2e-3**1.2
    return replace(made, extras={**made.extras, "stop_earlier": size, "stop_soft": stiffness})


PLAIN, TYRES = ("table", "none", "dry_park", "bicycle"), ("bicycle",)
LISTED = (
    TrueEffect(
        "entrained_air",
        "Wylie's mixture with polytropic air",
        extra("air"),
        5e-3,
        4e-2,
        same("air_fraction"),
    ),
    TrueEffect(
        "cross_piston_leakage",
        "gap with pressure and wall-driven (Couette) flow",
        lambda made, _, size: replace(
            made,
            extras={
                **made.extras,
                "piston_leak": size,
                "piston_drag": 2e-6 * min(size / 1e-12, 5.0),
            },
        ),
        1e-12,
        8e-12,
        same("leakage"),
    ),
    TrueEffect(
        "external_leakage_left",
        "gap that turns turbulent at high pressure",
        extra("left_leak"),
        1e-12,
        8e-12,
        same("leakage"),
    ),
    TrueEffect(
        "external_leakage_right",
        "gap that turns turbulent at high pressure",
        extra("right_leak"),
        1e-12,
        8e-12,
        same("leakage"),
    ),
    TrueEffect(
        "rack_friction_level",
        "Dahl bristle, exactly solved",
        factor("mechanics.rack_friction"),
        1.0,
        4.0,
        same("factor", 1.0),
        1.0,
    ),
    TrueEffect(
        "rack_stribeck_friction",
        "LuGre bristle whose level falls as 1/(1 + (v/v_s)^2)",
        extra("breakaway", stribeck_speed=2.5e-3),
        100.0,
        500.0,
        _no_breakaway,
    ),
    TrueEffect(
        "rack_friction_asymmetry",
        "bristle of one stiffness with a level for each direction",
        extra("coulomb_difference"),
        60.0,
        190.0,
        same("coulomb"),
        signed=True,
    ),
    TrueEffect(
        "rack_friction_pressure_slope",
        "each chamber's seal with a slope of its own",
        several(
            factor("mechanics.rack_friction_pressure_slope"),
            lambda m, _, size: replace(
                m, extras={**m.extras, "friction_left": 1.03, "friction_right": 0.97}
            ),
        ),
        0.8,
        4.0,
        same("factor", 1.0),
        1.0,
    ),
    TrueEffect(
        "rack_viscous_damping",
        "linear with a share that grows with speed",
        extra("more_damping"),
        3000.0,
        20000.0,
        same("added"),
    ),
    TrueEffect("rack_mass", "rigid", more("mechanics.rack_mass"), 12.0, 120.0, same("added")),
    TrueEffect(
        "rack_backlash",
        "dead zone with rounded flanks",
        extra("half_gap", 0.5),
        0.01,
        0.05,
        same("gap"),
    ),
    TrueEffect(
        "rack_end_stop",
        "Hunt and Crossley contact, exponent 1.2; the stiffness is not comparable",
        _soft_stop,
        0.045,
        0.06,
        same("earlier"),
        kinds=("large",),
    ),
    TrueEffect(
        "column_friction",
        "Dahl bristle, exactly solved",
        factor("mechanics.column_friction"),
        1.0,
        6.0,
        same("factor", 1.0),
        1.0,
    ),
    TrueEffect(
        "torsion_bar_stiffness",
        "linear",
        factor("mechanics.torsion_bar_stiffness"),
        0.2,
        0.6,
        same("factor", 1.0),
        1.0,
        signed=True,
    ),
    TrueEffect(
        "boost_curve_offset",
        "shift of the areas' torque",
        extra("boost_offset"),
        0.15,
        0.8,
        same("offset"),
        signed=True,
        systems=OPEN,
    ),
    TrueEffect(
        "torque_sensor_gain",
        "gain",
        sensor(s.TORQUE_OUT, 0),
        0.05,
        0.3,
        same("gain", 1.0),
        1.0,
        signed=True,
    ),
    TrueEffect(
        "torque_sensor_offset",
        "offset",
        sensor(s.TORQUE_OUT, 1),
        0.1,
        0.6,
        same("offset"),
        signed=True,
    ),
    TrueEffect(
        "torque_sensor_delay",
        "chain of four lags",
        aged((s.TORQUE_OUT,)),
        4e-3,
        2e-2,
        same("delay"),
        systems=OPEN,
    ),
    TrueEffect(
        "angle_sensor_delay",
        "chain of four lags",
        aged((s.ANGLE_OUT, s.SPEED_OUT)),
        4e-3,
        3e-2,
        same("delay"),
    ),
    TrueEffect(
        "rack_force_sensor_gain",
        "gain",
        sensor(s.FORCE_OUT, 0),
        0.08,
        0.4,
        same("gain", 1.0),
        1.0,
        signed=True,
        loads=("bicycle", "table", "dry_park"),
    ),
    TrueEffect(
        "rack_force_sensor_offset",
        "offset",
        sensor(s.FORCE_OUT, 1),
        100.0,
        800.0,
        same("offset"),
        signed=True,
    ),
    TrueEffect(
        "pressure_sensor_offset_left",
        "offset",
        sensor(s.LEFT_OUT, 1),
        1e5,
        8e5,
        same("offset"),
        signed=True,
    ),
    TrueEffect(
        "pressure_sensor_offset_right",
        "offset",
        sensor(s.RIGHT_OUT, 1),
        1e5,
        8e5,
        same("offset"),
        signed=True,
    ),
    TrueEffect(
        "pressure_sensor_lag",
        "two equal lags",
        aged((s.LEFT_OUT, s.RIGHT_OUT), 2),
        5e-3,
        3e-2,
        same("time_constant"),
        systems=OPEN,
    ),
    TrueEffect(
        "valve_overlap",
        "dead zone at both edges of the holes",
        more("pressure_control_valve.underlap", -1.0),
        3e-5,
        1e-4,
        same("overlap"),
        systems=CLOSED,
    ),
    TrueEffect(
        "valve_overlap",
        "areas of an earlier torque",
        extra("lap_torque"),
        0.4,
        1.0,
        same("torque"),
        systems=OPEN,
    ),
    TrueEffect(
        "valve_spool_stiction",
        "LuGre bristle, 15 % breakaway",
        extra("stiction"),
        0.5,
        3.0,
        _spool_level,
        systems=CLOSED,
    ),
    TrueEffect(
        "solenoid_lag",
        "two lags, 70 % and 30 % of the time",
        extra("magnet_lag"),
        1e-3,
        4e-3,
        same("time_constant"),
        systems=CLOSED,
    ),
    TrueEffect(
        "solenoid_hysteresis",
        "four plays side by side (Prandtl and Ishlinskii)",
        extra("magnet_width"),
        1.0,
        4.0,
        same("width"),
        systems=CLOSED,
    ),
    TrueEffect(
        "supply_pressure_droop",
        "line and accumulator whose gas stiffens",
        extra("droop"),
        3e10,
        2e11,
        same("resistance"),
        systems=CLOSED,
    ),
    TrueEffect(
        "pump_flow_level",
        "factor",
        factor("open_centre.pump_flow"),
        -0.12,
        -0.4,
        same("factor", 1.0),
        1.0,
        systems=OPEN,
    ),
    TrueEffect(
        "pump_flow_ripple",
        "sine with a second harmonic of 15 %",
        extra("ripple", ripple_frequency=137.0, ripple_phase=0.7),
        0.03,
        0.2,
        same("amplitude"),
        systems=OPEN,
    ),
    TrueEffect(
        "orifice_flow_coefficient",
        "factor on every orifice: edges, their jets, damping",
        several(factor_extra("discharge"), exact("oil.flow_coefficient")),
        -0.15,
        -0.4,
        same("factor", 1.0),
        1.0,
        signed=False,
    ),
    TrueEffect(
        "chamber_volume_imbalance",
        "half to each side",
        extra("left_more_volume", 0.5),
        3e-5,
        5.5e-5,
        same("difference"),
        signed=True,
    ),
    TrueEffect(
        "load_cylinder_friction",
        "Dahl bristle, exactly solved",
        extra("load_friction"),
        100.0,
        600.0,
        same("level"),
        loads=("table", "none"),
    ),
    TrueEffect(
        "tyre_relaxation",
        "force relaxes, and with it a share of its stiffness",
        extra("relaxation"),
        0.4,
        1.8,
        same("relaxation_length"),
        loads=TYRES,
    ),
)

LEAST: Mapping[str, float] = {
    "rack_friction_level": 0.3,
    "rack_friction_pressure_slope": 0.3,
    "rack_viscous_damping": 150.0,
    "rack_mass": 1.5,
    "column_friction": 0.4,
    "torsion_bar_stiffness": 0.06,
    "pump_flow_level": 0.06,
    "orifice_flow_coefficient": 0.1,
    "chamber_volume_imbalance": 7e-6,
    "torque_sensor_gain": 0.01,
    "rack_force_sensor_gain": 0.01,
}
"""Twice the tolerance of what an effect competes with: within tolerance nothing is to be named."""
