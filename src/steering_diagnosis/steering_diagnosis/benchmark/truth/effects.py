"""The catalogue's effects in the truth's own formulas, and what their parameters compare with.

``size`` is the deviation that is drawn; what a diagnosis is judged by is ``equivalent``: the
library's parameter that describes the same thing, taken from the truth. Register an effect here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.specimen import Specimen

Change = Callable[[Specimen, ParameterSet, float], Specimen]
Equivalent = Callable[[float], dict[str, float]]
BOTH, OPEN, CLOSED = ("open_centre", "closed_centre"), ("open_centre",), ("closed_centre",)


@dataclass(frozen=True)
class TrueEffect:
    """A phenomenon as the truth has it.

    typical, largest: sizes [unit of the parameter]; signed: both signs are drawn. equivalent: size
    to the library's parameters that are judged, none where only the name can be. neutral: their
    values without the effect. kinds, loads: manoeuvres and loads on which it can act. formula: in
    words, with what differs from the library. catalogued: False for what it does not have.
    """

    name: str
    formula: str
    change: Change
    typical: float
    largest: float
    equivalent: Equivalent
    neutral: float = 0.0
    signed: bool = False
    systems: tuple[str, ...] = BOTH
    kinds: tuple[str, ...] = ()
    loads: tuple[str, ...] = ()
    catalogued: bool = True


def extra(name: str, scale: float = 1.0, **more: float) -> Change:
    """Return a change that sets one of the extras to ``scale`` times the size."""
    return lambda made, _, size: replace(made, extras={**made.extras, name: scale * size, **more})


def factor_extra(name: str) -> Change:
    """Return a change that makes one of the extras 1 + size."""
    return lambda made, _, size: replace(made, extras={**made.extras, name: 1.0 + size})


def factor(full: str) -> Change:
    """Return a change that makes a data sheet's value (1 + size) times the nominal one."""
    return lambda made, nominal, size: replace(
        made, sheet={**made.sheet, full: nominal[full] * (1.0 + size)}
    )


def more(full: str, sign: float = 1.0) -> Change:
    """Return a change that puts ``sign`` times the size onto the nominal value."""
    return lambda made, nominal, size: replace(
        made, sheet={**made.sheet, full: nominal[full] + sign * size}
    )


def _exact(full: str) -> Change:
    """Return a change that takes away what the specimen differs in one value."""
    return lambda made, nominal, _: replace(made, sheet={**made.sheet, full: nominal[full]})


def sensor(row: int, column: int) -> Change:
    """Return a change of a sensor's gain (column 0) or offset (column 1)."""

    def change(made: Specimen, _: ParameterSet, size: float) -> Specimen:
        sensors = made.sensors.copy()
        sensors[row, column] = size + (1.0 if column == 0 else 0.0)
        return replace(made, sensors=sensors)

    return change


def aged(rows: tuple[int, ...], stages: int = 4) -> Change:
    """Return a change that makes measured values old by ``size`` seconds, in so many lags."""

    def change(made: Specimen, _: ParameterSet, size: float) -> Specimen:
        delays = made.delays.copy()
        delays[list(rows)] = size, stages
        return replace(made, delays=delays)

    return change


def several(*changes: Change) -> Change:
    """Return a change that makes several with the same size."""

    def change(made: Specimen, nominal: ParameterSet, size: float) -> Specimen:
        for one in changes:
            made = one(made, nominal, size)
        return made

    return change


def _same(parameter: str, neutral: float = 0.0) -> Equivalent:
    return lambda size: {parameter: neutral + size}


def _name_only(_: float) -> dict[str, float]:
    return {}


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
        _same("air_fraction"),
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
        _same("leakage"),
    ),
    TrueEffect(
        "external_leakage_left",
        "gap that turns turbulent at high pressure",
        extra("left_leak"),
        1e-12,
        8e-12,
        _same("leakage"),
    ),
    TrueEffect(
        "external_leakage_right",
        "gap that turns turbulent at high pressure",
        extra("right_leak"),
        1e-12,
        8e-12,
        _same("leakage"),
    ),
    TrueEffect(
        "rack_friction_level",
        "Dahl bristle, exactly solved",
        factor("mechanics.rack_friction"),
        1.0,
        4.0,
        _same("factor", 1.0),
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
        _same("coulomb"),
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
        _same("factor", 1.0),
        1.0,
    ),
    TrueEffect(
        "rack_viscous_damping",
        "linear with a share that grows with speed",
        extra("more_damping"),
        3000.0,
        20000.0,
        _same("added"),
    ),
    TrueEffect("rack_mass", "rigid", more("mechanics.rack_mass"), 12.0, 120.0, _same("added")),
    TrueEffect(
        "rack_backlash",
        "dead zone with rounded flanks",
        extra("half_gap", 0.5),
        0.01,
        0.05,
        _same("gap"),
    ),
    TrueEffect(
        "rack_end_stop",
        "Hunt and Crossley contact, exponent 1.2; the stiffness is not comparable",
        _soft_stop,
        0.045,
        0.06,
        _same("earlier"),
        kinds=("large",),
    ),
    TrueEffect(
        "column_friction",
        "Dahl bristle, exactly solved",
        factor("mechanics.column_friction"),
        1.0,
        6.0,
        _same("factor", 1.0),
        1.0,
    ),
    TrueEffect(
        "torsion_bar_stiffness",
        "linear",
        factor("mechanics.torsion_bar_stiffness"),
        0.2,
        0.6,
        _same("factor", 1.0),
        1.0,
        signed=True,
    ),
    TrueEffect(
        "boost_curve_offset",
        "shift of the areas' torque",
        extra("boost_offset"),
        0.15,
        0.8,
        _same("offset"),
        signed=True,
        systems=OPEN,
    ),
    TrueEffect(
        "torque_sensor_gain",
        "gain",
        sensor(s.TORQUE_OUT, 0),
        0.05,
        0.3,
        _same("gain", 1.0),
        1.0,
        signed=True,
    ),
    TrueEffect(
        "torque_sensor_offset",
        "offset",
        sensor(s.TORQUE_OUT, 1),
        0.1,
        0.6,
        _same("offset"),
        signed=True,
    ),
    TrueEffect(
        "torque_sensor_delay",
        "chain of four lags",
        aged((s.TORQUE_OUT,)),
        4e-3,
        2e-2,
        _same("delay"),
        systems=OPEN,
    ),
    TrueEffect(
        "angle_sensor_delay",
        "chain of four lags",
        aged((s.ANGLE_OUT, s.SPEED_OUT)),
        4e-3,
        3e-2,
        _same("delay"),
    ),
    TrueEffect(
        "rack_force_sensor_gain",
        "gain",
        sensor(s.FORCE_OUT, 0),
        0.08,
        0.4,
        _same("gain", 1.0),
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
        _same("offset"),
        signed=True,
    ),
    TrueEffect(
        "pressure_sensor_offset_left",
        "offset",
        sensor(s.LEFT_OUT, 1),
        1e5,
        8e5,
        _same("offset"),
        signed=True,
    ),
    TrueEffect(
        "pressure_sensor_offset_right",
        "offset",
        sensor(s.RIGHT_OUT, 1),
        1e5,
        8e5,
        _same("offset"),
        signed=True,
    ),
    TrueEffect(
        "pressure_sensor_lag",
        "two equal lags",
        aged((s.LEFT_OUT, s.RIGHT_OUT), 2),
        5e-3,
        3e-2,
        _same("time_constant"),
        systems=OPEN,
    ),
    TrueEffect(
        "valve_overlap",
        "dead zone at both edges of the holes",
        more("pressure_control_valve.underlap", -1.0),
        3e-5,
        1e-4,
        _same("overlap"),
        systems=CLOSED,
    ),
    TrueEffect(
        "valve_overlap",
        "areas of an earlier torque",
        extra("lap_torque"),
        0.4,
        1.0,
        _same("torque"),
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
        _same("time_constant"),
        systems=CLOSED,
    ),
    TrueEffect(
        "solenoid_hysteresis",
        "four plays side by side (Prandtl and Ishlinskii)",
        extra("magnet_width"),
        1.0,
        4.0,
        _same("width"),
        systems=CLOSED,
    ),
    TrueEffect(
        "supply_pressure_droop",
        "line and accumulator whose gas stiffens",
        extra("droop"),
        3e10,
        2e11,
        _same("resistance"),
        systems=CLOSED,
    ),
    TrueEffect(
        "pump_flow_level",
        "factor",
        factor("open_centre.pump_flow"),
        -0.12,
        -0.4,
        _same("factor", 1.0),
        1.0,
        systems=OPEN,
    ),
    TrueEffect(
        "pump_flow_ripple",
        "sine with a second harmonic of 15 %",
        extra("ripple", ripple_frequency=137.0, ripple_phase=0.7),
        0.03,
        0.2,
        _same("amplitude"),
        systems=OPEN,
    ),
    TrueEffect(
        "orifice_flow_coefficient",
        "factor on every orifice: edges, their jets, damping",
        several(factor_extra("discharge"), _exact("oil.flow_coefficient")),
        -0.15,
        -0.4,
        _same("factor", 1.0),
        1.0,
        signed=False,
    ),
    TrueEffect(
        "chamber_volume_imbalance",
        "half to each side",
        extra("left_more_volume", 0.5),
        3e-5,
        5.5e-5,
        _same("difference"),
        signed=True,
    ),
    TrueEffect(
        "load_cylinder_friction",
        "Dahl bristle, exactly solved",
        extra("load_friction"),
        100.0,
        600.0,
        _same("level"),
        loads=("table", "none"),
    ),
    TrueEffect(
        "tyre_relaxation",
        "force relaxes, and with it a share of its stiffness",
        extra("relaxation"),
        0.4,
        1.8,
        _same("relaxation_length"),
        loads=TYRES,
    ),
)

OUTSIDE = (
    TrueEffect(
        "bent_rack",
        "friction rises where the rack is bent",
        lambda m, _, size: replace(
            m, extras={**m.extras, "bent": size, "bent_at": 1.2e-3, "bent_width": 8e-4}
        ),
        200.0,
        600.0,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "worn_pinion_tooth",
        "the gear ratio ripples with the teeth",
        extra("tooth"),
        5e-3,
        2e-2,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "torsion_bar_hysteresis",
        "rate-independent loss in the torsion bar",
        extra("bar_hysteresis"),
        0.15,
        0.6,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "torsion_bar_stiffening",
        "torque grows with the twist's third power",
        extra("bar_cubic"),
        80.0,
        400.0,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "hose_relaxation",
        "hoses expand with a time constant of their own",
        extra("hose", hose_time=0.08),
        1.5e-12,
        1e-11,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "warming_oil",
        "viscosity and flow coefficients drift over the record",
        extra("warming"),
        8e-3,
        3e-2,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "pressure_crosstalk",
        "the right pressure leaks into the left sensor's signal",
        extra("crosstalk"),
        0.05,
        0.25,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "rack_bending",
        "a mass on the elastic rack, near 24 Hz",
        extra("bending_mass", bending_rate=150.0),
        6.0,
        20.0,
        _name_only,
        catalogued=False,
    ),
    TrueEffect(
        "motor_cogging",
        "torque ripple over the steering wheel's angle",
        extra("cogging", cogs=24.0),
        0.2,
        0.8,
        _name_only,
        catalogued=False,
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


def _register() -> dict[str, dict[str, TrueEffect]]:
    table: dict[str, dict[str, TrueEffect]] = {name: {} for name in BOTH}
    for effect in LISTED + OUTSIDE:
        for system in effect.systems:
            table[system][effect.name] = effect
    return table


TRUE_EFFECTS: Mapping[str, Mapping[str, TrueEffect]] = _register()
"""By valve system, then by name."""


def changed(
    specimen: Specimen, nominal: ParameterSet, system: str, sizes: Mapping[str, float]
) -> Specimen:
    """Return the specimen with effects of given sizes."""
    for name, size in sizes.items():
        specimen = TRUE_EFFECTS[system][name].change(specimen, nominal, size)
    return specimen


def equivalents(system: str, sizes: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """Return the library's parameters that are judged, by effect."""
    return {n: TRUE_EFFECTS[system][n].equivalent(float(size)) for n, size in sizes.items()}


def neutral(system: str, name: str) -> float:
    """Return the value of an effect's judged parameter where it is absent."""
    return TRUE_EFFECTS[system][name].neutral


def signs(effect: TrueEffect, random: np.random.Generator) -> float:
    """Return the sign of an effect's size."""
    return float(random.choice([-1.0, 1.0])) if effect.signed else 1.0
