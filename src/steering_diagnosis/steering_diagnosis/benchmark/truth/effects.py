"""All effects of the truth by valve system and name, and what they do to a specimen."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from steering_core.parameters import ParameterSet
from steering_diagnosis.benchmark.truth.changes import BOTH, TrueEffect
from steering_diagnosis.benchmark.truth.listed import LISTED
from steering_diagnosis.benchmark.truth.outside import OUTSIDE
from steering_diagnosis.benchmark.truth.specimen import Specimen


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
