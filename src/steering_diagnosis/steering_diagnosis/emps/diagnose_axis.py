"""The diagnosis of the axis: fitted on the estimation record, held out on the one with pulses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from steering_diagnosis.emps.data import ESTIMATION, PULSES, Axis, read_axis
from steering_diagnosis.emps.replay import PUBLISHED_HZ, AxisReplay
from steering_diagnosis.engine.diagnose import diagnose
from steering_diagnosis.engine.findings import Findings
from steering_diagnosis.engine.settings import Settings

SETTINGS = Settings(bandwidth_hz=40.0, noise_order=2, least_gain=0.2, spoiling=0.1)
"""The pulses shake a mode between 15 and 40 Hz; a long noise model would whiten it away. A real
axis has more small phenomena than one, and one output: less has to be gained, more may remain."""

SYMMETRIC = ("force_offset",)
"""The authors' first model: symmetric friction with an offset."""

PUBLISHED = {
    "symmetric, estimation": 0.0408,
    "symmetric, pulses": 0.0598,
    "by direction, estimation": 0.0311,
}
"""Relative force errors that the benchmark's authors print."""


@dataclass(frozen=True)
class AxisDiagnosis:
    """findings: fitted on the estimation record, held out on the pulses. pulses: of that record
    alone. errors: model and record to the relative force error, see ``relative_errors``."""

    findings: Findings
    pulses: Findings
    errors: dict[str, float]


def diagnose_axis(folder: str | Path) -> AxisDiagnosis:
    """Diagnose both records of a folder. BenchError where one is missing."""
    axes = {name: read_axis(Path(folder) / name) for name in (ESTIMATION, PULSES)}
    fitted, held = (AxisReplay(axes[name]) for name in (ESTIMATION, PULSES))
    findings = diagnose(fitted, held, settings=SETTINGS)
    pulses = diagnose(held, None, settings=SETTINGS)
    named = tuple(sorted(findings.effects))
    return AxisDiagnosis(
        findings, pulses, relative_errors(axes, {"symmetric": SYMMETRIC, "named": named})
    )


def relative_errors(
    axes: Mapping[str, Axis], models: Mapping[str, tuple[str, ...]]
) -> dict[str, float]:
    """Return "model, record" to the relative force error, as the benchmark's authors compute it.

    models: name to the causes beside mass, viscous and Coulomb friction. All are fitted by least
    squares on the estimation record and judged on both, through the common filter at 40 Hz.
    """
    judged = {name: AxisReplay(axis, PUBLISHED_HZ) for name, axis in axes.items()}
    found = {}
    for model, causes in models.items():
        values = judged[ESTIMATION].least_squares(causes)
        for record, label in ((ESTIMATION, "estimation"), (PULSES, "pulses")):
            found[f"{model}, {label}"] = judged[record].relative_error(causes, values)
    return found
