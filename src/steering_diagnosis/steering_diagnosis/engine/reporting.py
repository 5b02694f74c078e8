"""From the engine's findings to ``report.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from steering_diagnosis.engine.findings import Findings, NamedCause, Region
from steering_diagnosis.report import (
    Cause,
    Estimate,
    Refitted,
    Report,
    Rival,
    Signal,
    Source,
    Unexplained,
)

AT_THE_NOISE = 1.1
"""Error over noise up to which both look the same in a table of three digits' use."""


def to_report(
    findings: Findings,
    bag: Source,
    software: str,
    holdout: Source | None = None,
    undecidable: Mapping[str, str] | None = None,
    suspicions: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> Report:
    """Return the report. undecidable: what the model says of the record, beside the engine's."""
    return Report(
        schema=1,
        bag=bag,
        holdout=holdout,
        software=software,
        verdict=findings.verdict,
        sentence=sentence(findings),
        causes=[_cause(c) for c in findings.causes],
        unexplained=[_unexplained(r) for r in findings.unexplained],
        undecidable={**findings.undecidable, **(undecidable or {})},
        rivals=[
            Rival(effect=r.hypothesis, score=r.score, why_not=r.why_not) for r in findings.losers
        ],
        nuisance={
            n.name: Refitted(
                nominal=n.nominal,
                refitted=findings.nuisances.get(n.name, n.nominal),
                tolerance=n.tolerance,
            )
            for n in findings.catalogue
        },
        signals=_signals(findings),
        suspicions=list(suspicions),
        notes=[*notes, *findings.notes],
    )


def sentence(findings: Findings) -> str:
    """Return the verdict in one sentence."""
    names = " and ".join(_named(c) for c in findings.causes)
    left = "; ".join(dict.fromkeys(r.balance for r in findings.unexplained))
    if findings.causes:
        rest = f"; structure without a name remains in {left}" if left else ""
        return f"Named: {names}, {findings.explained:.0%} of the error above the noise{rest}."
    if findings.verdict == "unexplained":
        return f"The model errs in {left}, and no hypothesis explains it."
    if findings.verdict == "insufficient_excitation":
        return "The record excites nothing that a hypothesis could be judged by."
    return (
        f"Clean: the nominal model within its tolerances explains the record {_down_to(findings)}."
    )


def _down_to(findings: Findings) -> str:
    """Return how far a clean record is explained, by the signal that is furthest from its noise."""
    ratios = {
        output.name: error.refitted / error.noise
        for output in findings.outputs
        if (error := findings.fitted[output.name]).noise > 0.0
    }
    worst = max(ratios, key=lambda name: ratios[name], default="")
    if not worst or ratios[worst] < AT_THE_NOISE:
        return "down to the noise"
    return (
        f"but for {ratios[worst]:.2g} times the noise in {worst}, in which nothing stands out that "
        "could be judged"
    )


def _named(cause: NamedCause) -> str:
    name = cause.hypothesis.name
    return f"{name} (or {', '.join(cause.ambiguous_with)})" if cause.ambiguous_with else name


def _cause(cause: NamedCause) -> Cause:
    return Cause(
        effect=cause.hypothesis.name,
        ambiguous_with=list(cause.ambiguous_with),
        separating_experiment=cause.separating,
        balance=cause.hypothesis.balance,
        parameters={
            n: Estimate(value=v.value, low=v.low, high=v.high, unit=v.unit)
            for n, v in cause.parameters.items()
        },
        p_value=cause.evidence.p_value,
        delta_bic=cause.evidence.delta_bic,
        gain=dict(cause.gain),
    )


def _unexplained(r: Region) -> Unexplained:
    text = f"{r.output}: {r.region} ({r.where})"
    return Unexplained(balance=r.balance, band_hz=r.band_hz, region=text, share=r.share)


def _signals(findings: Findings) -> dict[str, Signal]:
    found = {}
    for output in findings.outputs:
        fit, held = findings.fitted[output.name], findings.held_out[output.name]
        found[output.name] = Signal(
            unit=output.unit,
            noise=fit.noise,
            rmse_nominal=fit.nominal,
            rmse_refitted=fit.refitted,
            rmse_extended=fit.extended,
            noise_holdout=held.noise,
            rmse_nominal_holdout=held.nominal,
            rmse_refitted_holdout=held.refitted,
            rmse_extended_holdout=held.extended,
        )
    return found
