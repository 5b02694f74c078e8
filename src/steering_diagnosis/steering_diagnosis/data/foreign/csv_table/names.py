"""Names of columns: how a header spells them, and which column a mapping means."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from steering_diagnosis.data.units import is_unit

WITH_UNIT = re.compile(r"(?P<name>.*\S)\s*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>[^()]*)\))")


def plain(name: str) -> str:
    """Return a name without what cannot be seen: composed, one kind of blank, none at the ends."""
    shown = unicodedata.normalize("NFKC", name).replace("\u200b", "").replace("\ufeff", "")
    return " ".join(shown.split()).strip("'\" ")


def split_unit(name: str) -> tuple[str, str]:
    """Return ``angle`` and ``deg`` of ``angle [deg]`` or ``angle (deg)``; else the name and ''."""
    base, behind = _split(name)
    return (base, behind) if is_unit(behind) else (name, "")


def places(wanted: str, names: Sequence[str]) -> list[int]:
    """Return the columns that a mapping's name may mean, counted from 0.

    ``names`` are plain. A whole name comes first; else a name with its unit behind it, and then any
    other that differs from it only in its brackets.
    """
    target = plain(wanted)
    whole = [k for k, name in enumerate(names) if name == target]
    if whole:
        return whole
    found = [k for k, name in enumerate(names) if _split(name)[0] == target]
    return found if any(split_unit(names[k])[1] for k in found) else []


def _split(name: str) -> tuple[str, str]:
    match = WITH_UNIT.fullmatch(name)
    if match is None:
        return name, ""
    return match["name"], (match["square"] if match["round"] is None else match["round"]).strip()
