"""From the runs of the rig tests to one parameter set: every test that is there is used."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from steering_bringup.errors import BenchError
from steering_core.parameters import ParameterSet, load_parameters
from steering_studies.channels import Channels
from steering_studies.identification.column import column_friction, inertia, stiffness
from steering_studies.identification.estimate import Estimate
from steering_studies.identification.opening_areas import (
    BoostCurve,
    boost_parameters,
    opening_areas,
)
from steering_studies.identification.rack_friction import loop_friction, rack_friction

Runs = Mapping[str, Channels]
"""Run's name (rig_tests.tests) to its channels."""

PASSES = 2
"""Inertia needs the column's friction, and that needs the inertia a little: twice is enough."""


@dataclass(frozen=True)
class Identified:
    """What the rig tests tell of a gear.

    estimates: full parameter name to estimate. boost_curve: None without its test. friction: run to
    half its loop's height [N]. missing: parameters that no test was there for, with the test.
    """

    estimates: Mapping[str, Estimate]
    boost_curve: BoostCurve | None = None
    friction: Mapping[str, float] = field(default_factory=dict)
    missing: tuple[str, ...] = ()

    def values(self) -> dict[str, float]:
        """Return the estimates' values by full name."""
        return {name: estimate.value for name, estimate in self.estimates.items()}


def identify(runs: Runs, nominal: ParameterSet | None = None) -> Identified:
    """Return what ``runs`` tell; BenchError where none of them is a rig test.

    nominal: what no test of this list measures (mass, piston area, pump flow, oil, gear ratio).
    """
    known = nominal or load_parameters()
    found: dict[str, Estimate] = {}
    missing = []
    if "stiffness" in runs:
        found |= stiffness(runs["stiffness"], known)
    else:
        missing.append("stiffness")
    known = _with(known, found)
    for _ in range(PASSES if "inertia" in runs else 1):
        if "column_friction" in runs:
            found |= column_friction(runs["column_friction"], known)
        if "inertia" in runs and "column_friction" in runs:
            found |= inertia(runs["inertia"], known, found)
        known = _with(known, found)
    missing += [name for name in ("column_friction", "inertia") if name not in runs]
    loops = {name: c for name, c in runs.items() if name.startswith("rack_friction")}
    friction = {name: loop_friction(channels, known) for name, channels in loops.items()}
    if loops:
        found |= rack_friction(loops.values(), known)
    else:
        missing.append("rack_friction")
    curve = None
    if "boost_curve" in runs:
        curve = opening_areas(runs["boost_curve"], known)
        found |= boost_parameters(curve, known)
    else:
        missing.append("boost_curve")
    if not found:
        raise BenchError(
            "none of these runs is a rig test: they are called "
            "boost_curve, rack_friction_5_bar, column_friction, stiffness, inertia"
        )
    return Identified(found, curve, friction, tuple(missing))


def _with(known: ParameterSet, found: Mapping[str, Estimate]) -> ParameterSet:
    return known.with_values({name: estimate.value for name, estimate in found.items()})
