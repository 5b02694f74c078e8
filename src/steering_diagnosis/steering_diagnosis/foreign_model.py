"""The diagnosis of a model of another tool: an FMU, a file of measured data, one YAML."""

from __future__ import annotations

from pathlib import Path

from balance_diagnosis import Diagnosis, diagnose
from balance_diagnosis.fmu import FmuModel
from steering_core.errors import BenchError
from steering_diagnosis.data.any_machine import load_any_mapping, read_any


def diagnose_fmu(
    fmu: Path,
    mapping: Path | None,
    data: Path,
    holdout: Path | None = None,
    part: tuple[float | None, float | None] = (None, None),
) -> tuple[Diagnosis, list[str]]:
    """Return the diagnosis, and what reading the files found. part: of ``data``, from and to [s].

    BenchError or BalanceError names the file and what does not fit.
    """
    if mapping is None:
        raise BenchError(f"'{fmu}' needs a mapping file: --mapping FILE (docs/own_machine.md)")
    model = FmuModel(fmu, mapping)
    places = load_any_mapping(mapping, (*model.binding.inputs, *model.binding.outputs))
    fitted, notes = read_any(data, places, *part)
    held = []
    if holdout is not None:
        record, more = read_any(holdout, places)
        held, notes = [record], notes + more
    return diagnose(model, fit=[fitted], holdout=held), list(dict.fromkeys(notes))


def tell(diagnosis: Diagnosis, page: Path, notes: list[str]) -> list[str]:
    """Return the lines for the terminal."""
    lines = [f"verdict: {diagnosis}"]
    lines += [
        f"{'held out' if gain.held_out else 'fitted'}, {gain.record}: rms error of {gain.output} "
        f"{gain.nominal:.3g}, extended model {gain.extended:.3g}"
        for gain in diagnosis.gains
    ]
    files = [page.with_name(name) for name in ("report.json", "extended_model.yaml")]
    return [
        *lines,
        *(f"note: {note}" for note in notes),
        f"page: {page}",
        *(f"file: {f}" for f in files),
    ]
