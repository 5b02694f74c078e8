"""What a diagnosis leaves: page, report and extension; and what it says on the terminal."""

from __future__ import annotations

import textwrap
from pathlib import Path

import yaml

from steering_bringup.outputs import write_json, write_text
from steering_core.errors import BenchError
from steering_diagnosis.data.record import READ_AS
from steering_diagnosis.pages import write_page
from steering_diagnosis.pages.cards import best_gain
from steering_diagnosis.pages.shown import number, percent, quantity, words
from steering_diagnosis.pages.tables import at_their_end
from steering_diagnosis.report import Cause, Diagnosis, Report

EXTENSION_HEAD = """\
# What the diagnosis of {name} adds to the model: ./steer run SCENARIO --set-file {file}
"""


def write_all(diagnosis: Diagnosis, folder: Path) -> list[Path]:
    """Write report.html, report.json and, where there are causes, extension.yaml."""
    report = diagnosis.report
    files = [write_page(diagnosis, folder / "report.html"), folder / "report.json"]
    write_json(files[1], report.model_dump(mode="json"))
    if diagnosis.extension:
        files.append(folder / "extension.yaml")
        write_text(files[2], _extension(diagnosis, files[2]))
    return files


def read_report(path: Path) -> Report:
    """Read a report, by its file or folder; BenchError where it is none."""
    file = path / "report.json" if path.is_dir() else path
    try:
        return Report.model_validate_json(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise BenchError(f"'{file}' cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise BenchError(f"'{file}' is no report of a diagnosis: {error}") from None


def _extension(diagnosis: Diagnosis, file: Path) -> str:
    report = diagnosis.report
    head = EXTENSION_HEAD.format(name=Path(report.bag.path).name, file=file.name)
    intervals = "".join(
        f"# {cause.effect}.{name}: 95 % within {e.low:.6g} to {e.high:.6g} {e.unit}\n"
        for cause in report.causes
        for name, e in cause.parameters.items()
    )
    return head + intervals + yaml.safe_dump(dict(diagnosis.extension), sort_keys=False)


def tell(diagnosis: Diagnosis, files: list[Path]) -> list[str]:
    """Return the lines for the terminal."""
    report = diagnosis.report
    but = ", but something in the record is suspected" if report.suspicions else ""
    lines = [f"verdict: {words(report.verdict)}{but}", *textwrap.wrap(report.sentence, 100)]
    for cause in report.causes:
        lines += [f"  {text}" for text in _cause(cause)]
    best = best_gain(report)
    if report.causes and best is not None:
        where = "the hold-out record" if report.holdout else "held-out blocks"
        lines.append(
            f"gain: {percent(best[1])} of the error of {words(best[0])} above its noise is gone, "
            f"on {where}"
        )
    lines += [f"suspected: {text}" for text in report.suspicions]
    lines += [f"unexplained: {_rest(report)}"] if report.unexplained else []
    if warned := at_their_end(report):
        lines.append(f"note: refitted {warned}")
    lines += [text if text.startswith(READ_AS) else f"note: {text}" for text in report.notes]
    return [*lines, f"page: {files[0]}", *(f"file: {file}" for file in files[1:])]


def _cause(cause: Cause) -> list[str]:
    values = ", ".join(
        f"{words(name)} {quantity(e.value, e.unit)} "
        f"({number(e.low, e.unit)} to {number(e.high, e.unit)})"
        for name, e in cause.parameters.items()
    )
    lines = [f"{words(cause.effect)}: {values}"]
    if cause.ambiguous_with:
        others = ", ".join(words(name) for name in cause.ambiguous_with)
        lines.append(f"  not told apart from: {others}; 'steer plan' writes what would")
    return lines


def _rest(report: Report) -> str:
    return "; ".join(
        f"{part.balance}, {part.band_hz[0]:.3g} to {part.band_hz[1]:.3g} Hz, {part.region} "
        f"({percent(part.share)})"
        for part in report.unexplained
    )
