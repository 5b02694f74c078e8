"""Writes the three files of a diagnosis."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from balance_diagnosis.diagnosis import Diagnosis
from balance_diagnosis.errors import BalanceError
from balance_diagnosis.extended import file_text
from balance_diagnosis.plain_yaml import to_text
from balance_diagnosis.report.data import described
from balance_diagnosis.report.page import render


def write(diagnosis: Diagnosis, folder: Path, rates: Any = None, call: str = "") -> Path:
    """Write page.html, report.json and extended_model.yaml; return the page's path."""
    told = described(diagnosis, rates, call)
    texts = {
        "report.json": to_text(told),
        "extended_model.yaml": file_text(diagnosis.model, diagnosis.numbers, told["model"]),
        "page.html": render(diagnosis, told),
    }
    for name, text in texts.items():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8", errors="replace")
        except OSError as error:
            raise BalanceError(f"'{folder / name}' cannot be written: {error.strerror}") from None
    return folder / "page.html"
