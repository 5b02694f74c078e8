"""Errors that name the wrong thing and suggest the nearest right one."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def nearest(name: str, known: Iterable[str]) -> str:
    """Return a hint such as ``; did you mean 'rack_mass'?``, or an empty text.

    Names with dots are compared whole and by their last part, so that a forgotten group
    (``rack_mass`` for ``mechanics.rack_mass``) is found as well.
    """
    names = sorted(known)
    lowered = {known_name.lower(): known_name for known_name in names}
    close = difflib.get_close_matches(name.lower(), lowered, n=1, cutoff=0.6)
    if not close:
        tails = {known_name.rsplit(".", 1)[-1].lower(): known_name for known_name in names}
        close = difflib.get_close_matches(name.rsplit(".", 1)[-1].lower(), tails, n=1, cutoff=0.7)
        lowered = tails
    return f"; did you mean '{lowered[close[0]]}'?" if close else ""


def unknown(what: str, name: str, known: Iterable[str]) -> str:
    """Return the text of an error about an unknown ``name``, with the nearest known one."""
    names = list(dict.fromkeys(known))
    hint = nearest(name, names)
    if not hint and len(names) <= 12:
        hint = f"; known: {', '.join(sorted(names))}"
    return f"unknown {what} '{name}'{hint}"
