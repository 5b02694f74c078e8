"""Phenomena that the catalogue does not have. Add one here."""

from __future__ import annotations

from dataclasses import replace

from steering_diagnosis.benchmark.truth.changes import (
    TrueEffect,
    extra,
    name_only,
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
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "worn_pinion_tooth",
        "the gear ratio ripples with the teeth",
        extra("tooth"),
        5e-3,
        2e-2,
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "torsion_bar_hysteresis",
        "rate-independent loss in the torsion bar",
        extra("bar_hysteresis"),
        0.15,
        0.6,
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "torsion_bar_stiffening",
        "torque grows with the twist's third power",
        extra("bar_cubic"),
        80.0,
        400.0,
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "hose_relaxation",
        "hoses expand with a time constant of their own",
        extra("hose", hose_time=0.08),
        1.5e-12,
        1e-11,
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "warming_oil",
        "viscosity and flow coefficients drift over the record",
        extra("warming"),
        8e-3,
        3e-2,
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "pressure_crosstalk",
        "the right pressure leaks into the left sensor's signal",
        extra("crosstalk"),
        0.05,
        0.25,
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "rack_bending",
        "a mass on the elastic rack, near 24 Hz",
        extra("bending_mass", bending_rate=150.0),
        6.0,
        20.0,
        name_only,
        catalogued=False,
    ),
    TrueEffect(
        "motor_cogging",
        "torque ripple over the steering wheel's angle",
        extra("cogging", cogs=24.0),
        0.2,
        0.8,
        name_only,
        catalogued=False,
    ),
)
