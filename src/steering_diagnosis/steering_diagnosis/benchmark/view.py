"""What a record shows of what is hidden in it, through all its channels or through some of them.

With fewer channels less is seen. A channel that is not measured is no output. Without the load's
command the load cell alone drives the replay: its noise shakes the rack, and nobody knows how late
it is. Without the valves' commands both chambers' pressures drive it, and what valves do, and what
the supply gives, is known to nobody.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from steering_core.errors import BenchError
from steering_diagnosis.benchmark.doors.channel_sets import LACKABLE, lacking_in
from steering_diagnosis.benchmark.doors.door import BAG, Door
from steering_diagnosis.benchmark.doors.logger import rounded
from steering_diagnosis.benchmark.doors.rig_names import in_rig_units
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.changes import TrueEffect
from steering_diagnosis.benchmark.truth.disturbance import COLOURED, WHITE
from steering_diagnosis.benchmark.truth.run import Signals
from steering_diagnosis.benchmark.visibility import (
    COLUMNS,
    LOAD_NOISE,
    OUTSTANDING,
    TYRE,
    Probe,
    Sensitivity,
    sensitivity,
)
from steering_diagnosis.data.channels import MEASURED

NO_SPEED = 6.0
"""The wheel's acceleration is so many times noisier where its speed is not measured."""

CELL_LATE_S = 2e-3
"""How late a load cell may be that nothing else tells of: an amplifier's and a converter's time."""

CHAMBERS = ("left_pressure", "right_pressure")


@dataclass(frozen=True, repr=False)
class View:
    """Clamped runs of a record, and what they show.

    found: the difference that each hidden effect makes beside the others. hidden: those effects.
    rivals: the catalogue's that can act on this record.
    """

    kind: str
    probe: Probe
    seen: Sensitivity
    found: Mapping[str, np.ndarray]
    hidden: Mapping[str, TrueEffect]
    rivals: Mapping[str, TrueEffect]
    sizes: Mapping[str, float]


def seen_as(
    kind: str, probe: Probe, seen: Sensitivity, sizes: Mapping[str, float]
) -> Mapping[str, np.ndarray]:
    """Return the difference that each effect makes, at its size and beside the others.

    What is too small to be seen is linear; a lag may be too short for these runs' step.
    """
    if kind != "invisible":
        return probe.beside(sizes)
    return {name: seen.effects[name] * (size / seen.sizes[name]) for name, size in sizes.items()}


def is_visible(effect: TrueEffect, seen: Sensitivity, difference: np.ndarray) -> bool:
    """Return whether an effect's difference is visible; without a template it has to stand out."""
    if not seen.visible(difference):
        return False
    return effect.catalogued or seen.outstanding(effect.name, difference) >= OUTSTANDING


def told(view: View) -> dict[str, Any]:
    """Return what the sealed truth says of a view: what is mistaken, ratios, what is unseen."""
    seen, found = view.seen, view.found
    mistaken = {n: [r for r in seen.mistaken(n, d) if r in view.rivals] for n, d in found.items()}
    if view.kind == "invisible":
        mistaken = {n: [] for n in found}
    lost = [n for n, e in view.hidden.items() if not is_visible(e, seen, found[n])]
    return {
        "mistaken": mistaken,
        "ratios": {name: seen.strength(difference) for name, difference in found.items()},
        "unseen": lost if view.kind != "invisible" else [],
    }


def through(view: View, door: Door, signals: Signals) -> View:
    """Return what a case shows through its door. signals: as they were recorded."""
    lacking = lacking_in(view.probe.system, door.lacking)
    if "valve_commands" in lacking:
        view = _pressed(view)
    if "load_command" in lacking:
        view = _late(view)
    view = _weighed(view, _weights(view, lacking, door, signals))
    return view if door.kind == BAG else _without_tyres(view)


def _pressed(view: View) -> View:
    """Return the view with the chambers' pressures given."""
    own = view.probe
    probe = Probe(own.specimen, own.nominal, own.system, own.course, own.given, pressed=True)
    seen = sensitivity(probe, {**view.rivals, **view.hidden})
    try:
        found = seen_as(view.kind, probe, seen, view.sizes)
    except (BenchError, KeyError):
        found = {name: np.zeros_like(probe.base) for name in view.sizes}
    return replace(view, probe=probe, seen=seen, found=found)


def _late(view: View) -> View:
    """Return the view with the load cell's age among what nobody knows."""
    specimen = view.probe.specimen
    delays = specimen.delays.copy()
    delays[s.FORCE_OUT, 0] += 0.5 * CELL_LATE_S
    late = view.probe.difference(replace(specimen, delays=delays))
    return replace(
        view, seen=replace(view.seen, nuisances=np.column_stack([view.seen.nuisances, late]))
    )


def _weights(view: View, lacking: tuple[str, ...], door: Door, signals: Signals) -> np.ndarray:
    """Return each column's noise with all channels over the one that it has here; 0: no output."""
    more = dict.fromkeys(COLUMNS, 0.0)
    probe, few = view.probe, _rounding(door, signals)
    stiffness = probe.nominal["mechanics.torsion_bar_stiffness"]
    for row, name in enumerate(MEASURED):
        if name in more:
            more[name] += few[row] ** 2
    angle = stiffness * WHITE[s.ANGLE_OUT] / WHITE[s.TORQUE_OUT]
    more["torsion_bar_torque"] += (few[s.ANGLE_OUT] * angle) ** 2 / (1.0 + angle**2)
    more["load_force"] += (_command_rounding(door, signals) / LOAD_NOISE) ** 2
    driving = [s.FORCE_OUT] if "load_command" in lacking else []
    driving += [s.LEFT_OUT, s.RIGHT_OUT] if probe.pressed else []
    for row in driving:
        shaken = probe.shaken(row) * np.hypot(1.0, few[row])
        for name, size in zip(COLUMNS, shaken, strict=True):
            more[name] += size**2
    if "speeds" in lacking:
        more["driver_torque"] += NO_SPEED**2 - 1.0
    gone = {name for group in lacking for name in LACKABLE[group]}
    gone |= {*CHAMBERS, "supply_pressure"} if probe.pressed else set()
    return np.array([0.0 if n in gone else 1.0 / np.sqrt(1.0 + x) for n, x in more.items()])


def _rounding(door: Door, signals: Signals) -> np.ndarray:
    """Return what few digits add to each measured channel, over its noise, (9,)."""
    found = []
    for row, name in enumerate(MEASURED):
        values = signals.measured[:, row]
        error = _written(name, values, door.logger.digits) - values
        found.append(np.std(error) / (WHITE[row] * np.hypot(1.0, COLOURED)))
    return np.array(found)


def _command_rounding(door: Door, signals: Signals) -> float:
    """Return what few digits add to the load's balance, cell and command [N]."""
    position, digits = signals.measured[:, s.RACK_OUT], door.logger.digits
    force, stiffness, at = signals.load.T
    cell = signals.measured[:, s.FORCE_OUT]
    exact = force + stiffness * (position - at) - cell
    force, stiffness, at = (
        _written(name, values, digits)
        for name, values in zip(LACKABLE["load_command"], signals.load.T, strict=True)
    )
    rack, cell = (
        _written("rack_position", position, digits),
        _written("rack_force", cell, digits),
    )
    return float(np.std(force + stiffness * (rack - at) - cell - exact))


def _written(channel: str, values: np.ndarray, digits: int) -> np.ndarray:
    """Return SI values as a file with so many digits has them."""
    if not digits:
        return values
    unit = in_rig_units(channel, np.ones(1))[0]
    return np.asarray(rounded(in_rig_units(channel, values), digits) / unit)


def _weighed(view: View, weights: np.ndarray) -> View:
    """Return the view with the columns that are left, in units of their noise."""
    kept = weights > 0.0

    def weighed(difference: np.ndarray) -> np.ndarray:
        blocks = difference.reshape(len(COLUMNS), -1, *difference.shape[1:])[kept]
        scale = weights[kept].reshape(-1, *[1] * (blocks.ndim - 1))
        return np.asarray((scale * blocks).reshape(-1, *difference.shape[1:]))

    seen = Sensitivity(
        {name: weighed(d) for name, d in view.seen.effects.items()},
        view.seen.sizes,
        weighed(view.seen.nuisances),
        int(kept.sum()),
    )
    return replace(view, seen=seen, found={name: weighed(d) for name, d in view.found.items()})


def _without_tyres(view: View) -> View:
    """Return the view of a record that does not say which law its load follows."""
    seen = view.seen
    effects = {n: d * (n != TYRE) for n, d in seen.effects.items()}
    found = {n: d * (n != TYRE) for n, d in view.found.items()}
    return replace(view, seen=replace(seen, effects=effects), found=found)
