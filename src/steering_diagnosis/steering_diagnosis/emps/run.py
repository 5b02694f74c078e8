"""Diagnose the EMPS axis: fitted on the estimation record, proved on the one with pulses."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from steering_diagnosis.emps.balance import AxisReplay, nominal
from steering_diagnosis.emps.record import BANDWIDTH_HZ, ESTIMATION, PULSES, load
from steering_diagnosis.engine.diagnose import Progress, diagnose
from steering_diagnosis.engine.findings import Findings
from steering_diagnosis.engine.settings import Settings

SETTINGS = Settings(bandwidth_hz=BANDWIDTH_HZ)


@dataclass(frozen=True)
class ForceErrors:
    """Root mean square error over that of the motor's force, of the refitted and extended model."""

    refitted: float
    extended: float
    refitted_held_out: float
    extended_held_out: float


def diagnose_axis(
    folder: Path, executor: Executor | None = None, progress: Progress | None = None
) -> tuple[Findings, ForceErrors]:
    """Diagnose the records in a folder. BenchError where they are missing."""
    first, second = load(folder / ESTIMATION), load(folder / PULSES)
    known = nominal(first)
    fit, holdout = AxisReplay(first, known), AxisReplay(second, known)
    found = diagnose(fit, holdout, executor=executor, progress=progress, settings=SETTINGS)
    return found, ForceErrors(*(_errors(fit, found)), *(_errors(holdout, found)))


def _errors(replay: AxisReplay, found: Findings) -> tuple[float, float]:
    """Return the relative force errors of the refitted and the extended model, standstill too."""
    force = replay.axis.force
    refitted = replay.error(found.refitted, {})
    extended = replay.error(found.nuisances, found.effects)
    judged = np.isfinite(refitted)
    size = np.linalg.norm(force[judged])
    return (
        float(np.linalg.norm(refitted[judged]) / size),
        float(np.linalg.norm(extended[judged]) / size),
    )
