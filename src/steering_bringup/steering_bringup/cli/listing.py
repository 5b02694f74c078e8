"""``steer list``: what there is to choose from."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

from steering_bringup.errors import BenchError
from steering_bringup.outputs import write_json

EXAMPLES = """examples:
  steer list
  steer list parameters
  steer list parameters 'valve*'
  steer list manoeuvres chirp"""

APART = ("effects", "parameters")
"""Left out of the overview: one is long, the other imports the compiled kernels."""

Entry = dict[str, Any]


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "list",
        nargs="?",
        choices=list(LISTS),
        help="one of the lists (default: an overview)",
    )
    parser.add_argument(
        "pattern", metavar="PATTERN", nargs="?", help="part of a name, or a pattern such as 'oil.*'"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the lists to a JSON file")


def execute(options: argparse.Namespace) -> int:
    """Print the lists."""
    chosen = [options.list] if options.list else [name for name in LISTS if name not in APART]
    tables = {name: _matching(LISTS[name](), options.pattern) for name in chosen}
    if options.pattern and not any(tables.values()):
        raise BenchError(f"no {options.list[:-1]} matches '{options.pattern}'")
    for index, (name, entries) in enumerate(tables.items()):
        print(f"{chr(10) if index else ''}{name.capitalize()}")
        _print(entries)
    if options.list is None:
        print("\nAlso: steer list effects, steer list parameters")
    if options.json:
        write_json(options.json, tables)
    return 0


def _matching(entries: list[Entry], pattern: str | None) -> list[Entry]:
    if not pattern:
        return entries
    wanted = pattern if any(sign in pattern for sign in "*?[") else f"*{pattern}*"
    return [entry for entry in entries if fnmatch(entry["name"], wanted)]


def _print(entries: list[Entry]) -> None:
    width = max((len(entry["name"]) for entry in entries), default=0)
    for entry in entries:
        print(f"  {entry['name']:<{width}}  {entry['text']}")
        for line in entry.get("more", ()):
            print(f"  {'':<{width}}    {line}")


def _files(what: str) -> Callable[[], list[Entry]]:
    def entries() -> list[Entry]:
        from steering_bringup.shipped import descriptions

        return [{"name": name, "text": text} for name, text in descriptions(what).items()]

    return entries


def _manoeuvres() -> list[Entry]:
    from driver_model.manoeuvres import MANOEUVRES

    return [_kind(name, made) for name, made in MANOEUVRES.items()]


def _loads() -> list[Entry]:
    from vehicle_model.loads import LOADS

    return [_kind(name, made) for name, made in LOADS.items()]


def _kind(name: str, made: Any) -> Entry:
    """Return one kind of a registry; its fields carry their units in their names."""
    given = (
        f"{f.name}" + ("" if f.default is MISSING else f" = {f.default}") for f in fields(made)
    )
    values = ["file = FILE.csv"] if name == "table" else [", ".join(given)]
    return {"name": name, "text": _first_sentence(made), "more": [v for v in values if v]}


def _effects() -> list[Entry]:
    from steering_plant.effects import EFFECTS

    return [
        {
            "name": name,
            "text": effect.summary,
            "more": [
                *(f"{parameter} = {line}" for parameter, line in effect.info.items()),
                f"balance: {', '.join(effect.balances)}; in {', '.join(effect.valve_systems)}",
                f"needs: {effect.excitation}",
            ],
            "balances": list(effect.balances),
            "valve_systems": list(effect.valve_systems),
            "excitation": effect.excitation,
        }
        for name, effect in EFFECTS.items()
    ]


def _parameters() -> list[Entry]:
    from steering_core.parameters import load_parameters

    sheet = load_parameters()
    values = {name: f"{sheet[name]:g} {sheet.info(name).unit}" for name in sheet}
    width = max(len(value) for value in values.values())
    return [
        {
            "name": name,
            "text": f"{values[name]:<{width}}  {sheet.info(name).source}",
            "value": sheet[name],
            "unit": sheet.info(name).unit,
            "tolerance": sheet.info(name).tolerance,
            "source": sheet.info(name).source,
        }
        for name in sheet
    ]


def _first_sentence(made: Any) -> str:
    return " ".join((made.__doc__ or "").split("\n\n")[0].split()).replace("``", "")


def _rigs() -> list[Entry]:
    from rig_bridge.shipped import description, shipped_rigs

    return [{"name": name, "text": description(path)} for name, path in shipped_rigs().items()]


LISTS: Mapping[str, Callable[[], list[Entry]]] = {
    "scenarios": _files("scenario"),
    "nodesets": _files("node set"),
    "rigs": _rigs,
    "manoeuvres": _manoeuvres,
    "loads": _loads,
    "effects": _effects,
    "parameters": _parameters,
}
