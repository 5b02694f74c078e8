"""What a single cell is by its looks: something measured, something missing, or a text."""

from __future__ import annotations

import re

GROUPING = " '’\u00a0\u2009\u202f"
"""Signs that stand between thousands and are never a decimal sign."""

_INFINITE = ("inf", "infinity", "∞", "1.#inf", "1.#qnan", "1.#snan", "1.#ind", "1.#j")
_SAID = ("", "nan", "nan(ind)", "n/a", "na", "n.a.", "null", "none", "nil", "-", "--", "---", ".")
_TOLD = ("overflow", "underflow", "sna", "missing", "invalid", "error")
_SHEET = ("n/a", "na", "nv", "n/v", "null!", "div/0!", "value!", "ref!", "num!", "name?")
_SHEET_ABROAD = ("wert!", "bezug!", "zahl!", "valeur!", "nombre!", "nom?")

MISSING = frozenset(
    (
        *_SAID,
        *_TOLD,
        *(sign + word for sign in ("", "+", "-") for word in ("nan", "nan(ind)", *_INFINITE)),
        *(sign + word.replace(".", ",") for sign in ("", "-") for word in _INFINITE),
        *("#" + word for word in (*_SHEET, *_SHEET_ABROAD)),
    )
)
"""How spreadsheets, loggers and compilers write that there is no number, in small letters."""

_NUMBER = re.compile(rf"[+\-−]?(?=[.,]?[0-9])[0-9.,{GROUPING}]*(?:[eEdD][+\-−]?[0-9]+)?", re.ASCII)
_INSTANT = re.compile(
    r"[0-9]{1,4}([-/.])(?:[0-9]{1,2}|[A-Za-z]{3})\1[0-9]{1,4}(?:[T ,].*)?|[0-9]{1,2}:[0-9]{2}\b.*"
)


LONGEST = 30
"""Characters of a cell that a sentence shows."""


def quoted(cell: str) -> str:
    """Return a cell as a sentence shows it."""
    bare = cell.strip()
    return f"'{bare[:LONGEST]}{'...' if len(bare) > LONGEST else ''}'"


def is_missing(cell: str) -> bool:
    """Return whether a cell says that there is no value."""
    return cell.strip().casefold() in MISSING


def looks_numeric(cell: str) -> bool:
    """Return whether a cell looks like a number in some country's spelling."""
    return _NUMBER.fullmatch(cell.strip()) is not None


def looks_instant(cell: str) -> bool:
    """Return whether a cell looks like a date or a time of day."""
    return _INSTANT.fullmatch(cell.strip()) is not None


def looks_measured(cell: str) -> bool:
    """Return whether a cell looks like a number, a date or a time of day."""
    return looks_numeric(cell) or looks_instant(cell)
