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
    match = WITH_UNIT.fullmatch(name)
    if match is None:
        return name, ""
    unit = (match["square"] if match["round"] is None else match["round"]).strip()
    return (match["name"], unit) if is_unit(unit) else (name, "")


def places(wanted: str, names: Sequence[str]) -> list[int]:
    """Return the columns that a mapping's name may mean, counted from 0.

    ``names`` are plain. A whole name comes first; else a name with its unit behind it.
    """
    target = plain(wanted)
    whole = [k for k, name in enumerate(names) if name == target]
    return whole or [k for k, name in enumerate(names) if split_unit(name)[0] == target]
