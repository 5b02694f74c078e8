"""The page of all effects, docs/effects.md: ``python -m steering_plant.effects.table``."""

from __future__ import annotations

from steering_plant.effects import EFFECTS
from steering_plant.effects.base import BALANCES, VALVE_SYSTEMS, Effect, Parameter

HEAD = """# Effects

What the nominal model leaves out, and what sensors get wrong: each can be switched on, and each is
a hypothesis of the diagnosis. This page is made from the registry by
`python -m steering_plant.effects.table`.

`./steer run --set effects.NAME.PARAMETER=VALUE`; a parameter that is not given takes its typical
value. At the neutral value the model is the nominal one, bit for bit. An effect does nothing in a
valve system that is not named. Marked parameters (\u2020) have no meaning at the neutral value, so
a fit scans them. SI units.
"""


def page() -> str:
    """Return the page in Markdown."""
    return "\n".join([HEAD, *_overview(), "", *map(_section, EFFECTS.values())])


def _overview() -> list[str]:
    rows = ["| balance | effects |", "|---|---|"]
    for balance in BALANCES:
        names = [f"[{n}](#{n})" for n, effect in EFFECTS.items() if balance in effect.balances]
        if names:
            rows.append(f"| {balance} | {', '.join(names)} |")
    return rows


def _section(effect: Effect) -> str:
    facts = {
        "Seen": effect.sees,
        "Equation": f"`{effect.equation}`",
        "Source": effect.source,
        "Balance": ", ".join(effect.balances),
        "Needs": effect.excitation,
        "Told apart by": effect.separating,
        "Acts in": ", ".join(effect.valve_systems),
        "Changes": ", ".join(f"`{name}`" for name in effect.sheet_parameters),
        "Looks like": ", ".join(f"`{name}`" for name in effect.competes),
    }
    if effect.valve_systems == VALVE_SYSTEMS:
        facts["Acts in"] = "all valve systems"
    lines = [f"## {effect.name}", "", f"{effect.summary[0].upper()}{effect.summary[1:]}.", ""]
    lines += [f"- {name}: {text}" for name, text in facts.items() if text]
    lines += ["", "| parameter | meaning | unit | neutral | typical | from | to |"]
    lines += ["|---|---|---|---|---|---|---|"]
    lines += [_row(name, p) for name, p in effect.parameters.items()]
    return "\n".join([*lines, ""])


def _row(name: str, p: Parameter) -> str:
    where = f" ({', '.join(p.valve_systems)})" if p.valve_systems else ""
    numbers = " | ".join(f"{value:g}" for value in (p.neutral, p.typical, p.low, p.high))
    mark = " \u2020" if p.shape else ""
    return f"| {name}{mark} | {p.meaning}{where} | {p.unit} | {numbers} |"


if __name__ == "__main__":
    print(page(), end="")
