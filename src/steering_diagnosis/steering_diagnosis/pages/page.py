"""The page: verdict, proof and gain first; then everything that led to them."""

from __future__ import annotations

from pathlib import Path

from steering_bringup.pages import Page, cards, paragraph
from steering_diagnosis.pages import tables
from steering_diagnosis.pages.cards import best_gain, cards_of
from steering_diagnosis.pages.figures import balance_figure, proof, signal_figure
from steering_diagnosis.pages.shown import percent, words
from steering_diagnosis.report import Diagnosis, Report

SCORE = (
    "Score: by how much the squared error, in units of its noise, falls with the rival, alone or "
    "beside what is named (twice the logarithm of the likelihoods' ratio). A high score is no "
    "proof: a rival may imitate the cause."
)
"""What the last column of the rivals' table means."""

GOOD = {"clean": True, "named": True}
"""Verdicts that colour the head of the page green; the others leave it neutral, and
so does a record in which something is suspected."""


def write_page(diagnosis: Diagnosis, path: str | Path) -> Path:
    """Write the page; BenchError naming the path if that fails."""
    return diagnosis_page(diagnosis).write(path)


def diagnosis_page(diagnosis: Diagnosis) -> Page:
    """Return the page of one diagnosis."""
    report = diagnosis.report
    page = Page(
        title=f"Diagnosis of {Path(report.bag.path).name}",
        subtitle=_subtitle(diagnosis),
        lead=report.sentence,
        good=None if report.suspicions else GOOD.get(report.verdict),
        footer=f"Software {report.software}. This page needs no network.",
    )
    shown = _main_signal(diagnosis)
    made = cards_of(report)
    if made:
        page.add(cards(made))
    for text in report.suspicions:
        page.add(paragraph(f"Suspected: {text}", "note"))
    if shown is not None:
        page.add(proof(diagnosis, shown))
    _causes(page, report)
    _remaining(page, diagnosis)
    _where(page, diagnosis)
    _rivals(page, report)
    _signals(page, diagnosis, shown)
    if report.nuisance:
        page.heading("The nominal model")
        if warned := tables.at_their_end(report):
            page.add(paragraph(f"Refitted {warned}.", "note"))
        page.add(tables.nuisance_table(report))
    if report.notes:
        page.heading("The data")
        for note in report.notes:
            page.add(paragraph(note))
    return page


def _subtitle(diagnosis: Diagnosis) -> str:
    report = diagnosis.report
    seconds = f"{diagnosis.time[-1]:.1f} s" if len(diagnosis.time) else "no samples"
    held = Path(report.holdout.path).name if report.holdout else "blocks of the same record"
    return f"{seconds} at 1 kHz · held out: {held} · verdict: {words(report.verdict)}"


def _main_signal(diagnosis: Diagnosis) -> str | None:
    """Return the signal that shows the verdict best."""
    best = best_gain(diagnosis.report)
    if best is not None and best[0] in diagnosis.overlays:
        return best[0]
    signals = diagnosis.report.signals
    known = [name for name in diagnosis.overlays if name in signals and signals[name].noise > 0.0]
    if not known:
        return next(iter(diagnosis.overlays), None)
    return max(known, key=lambda name: signals[name].rmse_refitted / signals[name].noise)


def _causes(page: Page, report: Report) -> None:
    if not report.causes:
        return
    page.heading(
        "Causes", "Estimates with 95 % intervals; the model extended by them is in extension.yaml."
    )
    page.add(tables.causes_table(report))
    for cause in report.causes:
        if cause.ambiguous_with:
            others = ", ".join(words(name) for name in cause.ambiguous_with)
            text = f"{words(cause.effect)} cannot be told apart from {others} on this record."
            if cause.separating_experiment:
                text += f" What would separate them: {cause.separating_experiment}"
            page.add(paragraph(text, "note"))


def _remaining(page: Page, diagnosis: Diagnosis) -> None:
    report = diagnosis.report
    if not report.unexplained:
        return
    page.heading("Unexplained", "Structure in the error that no cause of the catalogue explains.")
    for part in report.unexplained:
        band = f"{part.band_hz[0]:.3g} to {part.band_hz[1]:.3g} Hz"
        text = f"{part.balance}, {band}, {part.region}: {percent(part.share)} of the error's energy"
        page.add(paragraph(text))
    if diagnosis.free_form:
        term = diagnosis.free_form
        taken = f"{percent(term['gain'])} off {words(term['output'])}"
        text = f"a curve over {term['state']} takes {taken}"
        page.add(paragraph(f"A free-form term predicts held-out data better: {text}.", "note"))


def _where(page: Page, diagnosis: Diagnosis) -> None:
    if not diagnosis.balances:
        return
    page.heading(
        "Where the error enters",
        "Each balance evaluated on the measured signals alone; what it lacks is its residual.",
    )
    page.add(tables.balances_table(diagnosis))
    extended = bool(diagnosis.report.causes)
    for error in sorted(diagnosis.balances, key=lambda e: -e.share):
        page.add(balance_figure(error, diagnosis.time, extended))


def _rivals(page: Page, report: Report) -> None:
    if report.rivals:
        page.heading("Rivals", f"Everything else in the catalogue, and why it is not. {SCORE}")
        page.add(tables.rivals_table(report))
    if report.undecidable:
        page.heading("Not decidable from this record")
        page.add(tables.undecidable_table(report))


def _signals(page: Page, diagnosis: Diagnosis, shown: str | None) -> None:
    if diagnosis.report.signals:
        page.heading("Every signal", "Root mean square errors; held out means not used by the fit.")
        page.add(tables.signals_table(diagnosis.report))
    for name in diagnosis.overlays:
        if name != shown:
            page.add(signal_figure(diagnosis, name))
