"""The diagnosis of a record: suspicions, replay, inference, report and its evidence."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from steering_core.errors import BenchError
from steering_core.parameters import ParameterError
from steering_diagnosis.data.record import PERIOD_S, Record
from steering_diagnosis.engine.diagnose import diagnose
from steering_diagnosis.engine.failures import NUMERICAL, reason
from steering_diagnosis.engine.findings import Findings
from steering_diagnosis.engine.model import Effects
from steering_diagnosis.engine.reporting import to_report
from steering_diagnosis.engine.settings import Settings
from steering_diagnosis.report import BalanceError, Diagnosis, Overlay, Report, Source, Verdict
from steering_diagnosis.steering.balance_errors import Balances
from steering_diagnosis.steering.channel_faults import Suspicion
from steering_diagnosis.steering.clean_gains import settings_of
from steering_diagnosis.steering.extension import extension
from steering_diagnosis.steering.learned import learned
from steering_diagnosis.steering.replay import SteeringReplay
from steering_diagnosis.steering.smoothing import bridged, spectrum
from steering_diagnosis.steering.suspicions import left_out, suspicions, without

Progress = Callable[[float, str], None]

ESSENTIAL = "steering_wheel_angle"
LEAST_ANGLE = 5e-3
"""Motion of the wheel [rad, standard deviation] below which nothing is excited."""

INFERENCE = 0.9
"""Share of the time that the inference takes."""


def diagnose_record(
    record: Record,
    holdout: Record | None = None,
    *,
    executor: Executor | None = None,
    progress: Progress | None = None,
    settings: Settings | None = None,
) -> Diagnosis:
    """Diagnose a record; without ``holdout`` blocks spread over the record are held out.

    executor: where replays run (concurrent.futures.Executor, Dask's client has one); None: here.
    progress: called with the share done and what is being done. BenchError: the record cannot be
    replayed, or is too short.
    """
    tell = progress or (lambda share, what: None)
    tell(0.0, "looking at the record")
    found = suspicions(record)
    beside = [] if holdout is None else suspicions(holdout)
    told = [s.text for s in found] + [f"in the hold-out record: {s.text}" for s in beside]
    refusal = _refusal(record, found + beside)
    if refusal is not None:
        return Diagnosis(_report_without(record, holdout, told, *refusal), record.time)
    gone = left_out(found + beside)
    other = None
    try:
        replay = SteeringReplay(without(record, found, gone))
        if holdout is not None:
            other = SteeringReplay(without(holdout, beside, gone), like=replay)
    except BenchError as error:
        if not gone:
            raise
        sentence = f"Not judged: {_suspected(found + beside)}. Without it, {error}: put it right"
        return Diagnosis(
            _report_without(record, holdout, told, "unexplained", sentence), record.time
        )
    findings = diagnose(
        replay,
        other,
        executor=executor,
        progress=lambda share, what: tell(INFERENCE * share, what),
        settings=settings or settings_of(record.valve_system),
    )
    tell(INFERENCE, "balances")
    balances, lost = _balances(replay, findings)
    report = to_report(
        findings,
        _source(record),
        software(),
        None if holdout is None else _source(holdout),
        {u.hypothesis: u.why for u in replay.undecidable},
        told,
        [*record.notes, *_left_out(gone), *lost],
    )
    report.learned = learned(replay, findings)
    if gone:
        report.sentence = (
            f"The record seems to be wrong: {_suspected(found + beside)}. Judged without "
            f"{', '.join(sorted(gone))}. {report.sentence}"
        )
    made = Diagnosis(
        report=report,
        time=record.time,
        overlays=overlays(replay, findings),
        balances=balances,
        held_out=_held_out(findings, len(record)),
        extension=_extension(replay, findings),
        free_form={} if findings.free_form is None else asdict(findings.free_form),
    )
    tell(1.0, "done")
    return made


def _balances(
    replay: SteeringReplay, findings: Findings
) -> tuple[tuple[BalanceError, ...], list[str]]:
    """Return the balances' evidence, none where the plant leaves what is possible in it, and notes.

    Beside the replay every measured state is prescribed: what was found stands without it.
    """
    models: dict[str, tuple[Mapping[str, float], Effects]] = {
        "extended": (findings.nuisances, findings.effects),
        "refitted": (findings.refitted, {}),
    }
    lost: list[str] = []
    for name, model in models.items():
        try:
            return Balances(replay).errors(*model, findings.refitted), lost
        except (*NUMERICAL, BenchError, ParameterError) as error:
            lost.append(f"balances of the {name} model could not be made: {reason(error)}")
    return (), lost


def overlays(replay: SteeringReplay, findings: Findings) -> dict[str, Overlay]:
    """Return measured and predicted curves of every output, (n,) on the record's grid."""
    models: tuple[tuple[Mapping[str, float], Effects], ...] = (
        ({}, {}),
        (findings.refitted, {}),
        (findings.nuisances, findings.effects),
    )
    errors = [replay.errors(nuisances, effects) for nuisances, effects in models]
    found = {}
    for column, output in enumerate(replay.outputs):
        if output.name not in replay.record:
            continue
        measured = replay.record[output.name]
        nominal, refitted, extended = (measured - error[:, column] for error in errors)
        found[output.name] = Overlay(output.unit, measured, nominal, refitted, extended)
    return found


def software() -> str:
    """Return the version of this software."""
    try:
        return version("steering_diagnosis")
    except PackageNotFoundError:
        return "unknown"


def _refusal(record: Record, found: list[Suspicion]) -> tuple[Verdict, str] | None:
    """Return verdict and sentence where a record must not be judged."""
    suspected = [s for s in found if ESSENTIAL in s.channels]
    if suspected:
        return "unexplained", f"Not judged: {suspected[0].text}. It drives the replay; put it right"
    if ESSENTIAL in record:
        angle = bridged(record[ESSENTIAL])
        noise = spectrum(angle, rate_hz=record.rate(ESSENTIAL)).noise
        if len(angle) > 200 and np.std(angle) < max(LEAST_ANGLE, 3.0 * noise):
            still = f"The wheel hardly moves ({np.std(angle):.2g} rad)"
            return "insufficient_excitation", f"{still}: record a manoeuvre, such as weave"
    return None


def _report_without(
    record: Record, holdout: Record | None, told: list[str], verdict: Verdict, sentence: str
) -> Report:
    return Report(
        schema=1,
        bag=_source(record),
        holdout=None if holdout is None else _source(holdout),
        software=software(),
        verdict=verdict,
        sentence=f"{sentence.rstrip('.')}.",
        suspicions=told,
        notes=list(record.notes),
    )


def _left_out(gone: set[str]) -> list[str]:
    return [f"left out, because suspected: {', '.join(sorted(gone))}"] if gone else []


def _suspected(found: list[Suspicion]) -> str:
    """Return what is suspected of channels that are left out."""
    return "; ".join(dict.fromkeys(s.text for s in found if s.channels))


def _extension(replay: SteeringReplay, findings: Findings) -> dict[str, object]:
    if not findings.causes:
        return {}
    return extension(findings.effects, findings.nuisances, replay.nuisances)


def _held_out(findings: Findings, samples: int) -> np.ndarray:
    """Return which samples of the record were held out, (n,) bool."""
    held = findings.held_out_samples
    at = (np.arange(samples) * PERIOD_S / findings.step_s).astype(int)
    return held[np.minimum(at, len(held) - 1)]


def _source(record: Record) -> Source:
    return Source(path=str(record.path or record.name), sha256=record.sha256)
