"""The comparison of two runs: one function, one result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from steering_bringup.bags import BagError, Trace, first_difference
from steering_bringup.comparison.align import SECONDS_PER_TICK, common_ticks, range_note, rows_at
from steering_bringup.comparison.difference import Difference, difference
from steering_bringup.comparison.energy import TRUTH, Energy, energy
from steering_bringup.comparison.growth import Growth, bands, growth
from steering_bringup.comparison.labels import is_finite, missing_notes, names_of
from steering_bringup.comparison.metadata import differing
from steering_bringup.comparison.signals import Signal, considered, has, is_run, valve_system

GROWTH_KEYS = ("steering_wheel_torque", "assistance_pressure")


@dataclass(frozen=True)
class Comparison:
    """Two runs beside each other. Everything is SI and second minus first.

    names: labels of the runs; systems: see signals.valve_system; time: (n,) s; kinds: key -> Signal
    of what both have, in the order shown; signals: key -> (first, second), each (n,); differences:
    key -> Difference; growths: key -> Growth, None where it cannot be judged; bands: key -> [(from
    Hz, to Hz, rms)]; energies and supply_energy (n,) of each run; changed: metadata that differ;
    notes: what a reader must know.
    """

    traces: tuple[Trace, Trace]
    names: tuple[str, str]
    systems: tuple[str, str]
    time: np.ndarray
    kinds: dict[str, Signal]
    signals: dict[str, tuple[np.ndarray, np.ndarray]]
    differences: dict[str, Difference]
    growths: dict[str, Growth | None]
    bands: dict[str, list[tuple[float, float, float]]]
    energies: tuple[Energy, Energy]
    supply_energy: tuple[np.ndarray | None, np.ndarray | None]
    changed: list[tuple[str, Any, Any]]
    identical: bool
    notes: list[str] = field(default_factory=list)

    @property
    def duration(self) -> float:
        """Compared time [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def of_runs(self) -> bool:
        """Whether both are runs of the bench, not measured data or bags of other tools."""
        return all(is_run(trace) for trace in self.traces)

    def error(self, key: str) -> np.ndarray:
        """Second minus first of a signal, (n,)."""
        first, second = self.signals[key]
        return second - first

    def to_dict(self) -> dict[str, Any]:
        """Numbers for machines, SI, without the signals themselves."""
        return {
            "schema": 1,
            "runs": [
                {"name": n, "system": s, "path": str(t.path), "complete": t.complete}
                | {"mean_power_w": e.mean_power, **_energy_dict(e)}
                for n, s, t, e in zip(
                    self.names, self.systems, self.traces, self.energies, strict=True
                )
            ],
            "duration_s": self.duration,
            "ticks": len(self.time),
            "identical": self.identical,
            "differences": {key: asdict(d) for key, d in self.differences.items()},
            "growth": {key: _growth_dict(g) for key, g in self.growths.items()},
            "bands": {
                key: [{"from_hz": a, "to_hz": b, "rms": r} for a, b, r in rows]
                for key, rows in self.bands.items()
            },
            "changed": [{"name": n, "first": a, "second": b} for n, a, b in self.changed],
            "notes": self.notes,
        }


def compare(first: Trace, second: Trace) -> Comparison:
    """Compare two traces, signal by signal, on their common ticks.

    Raises BagError if they share no signal or no tick.
    """
    traces = (first, second)
    notes = [f"{trace.name}: {note}" for trace in traces for note in trace.notes]
    kinds = considered(traces)
    wanted = [s for s in kinds if has(first, s) and has(second, s)]
    notes += missing_notes(traces, kinds)
    if not wanted:
        raise BagError(f"{first.name} and {second.name} share no signal to compare")
    topics = list(dict.fromkeys(s.topic for s in wanted))
    ticks = common_ticks(traces, topics)
    if note := range_note(traces, topics[0], ticks):
        notes.append(note)
    time = ticks * SECONDS_PER_TICK
    named = {s.key: s for s in wanted}
    signals = {
        s.key: (
            s.take(rows_at(first, s.topic, ticks)),
            s.take(rows_at(second, s.topic, ticks)),
        )
        for s in wanted
    }
    signals = {k: pair for k, pair in signals.items() if is_finite(named[k], pair, traces, notes)}
    supplied = tuple(_supply_energy(trace, ticks, notes) for trace in traces)
    angle = signals.get("steering_wheel_angle")
    keys = [key for key in GROWTH_KEYS if key in signals]
    errors = {key: signals[key][1] - signals[key][0] for key in keys}
    return Comparison(
        traces=traces,
        names=names_of(traces),
        systems=(valve_system(first), valve_system(second)),
        time=time,
        kinds=named,
        signals=signals,
        differences={k: difference(time, a, b, named[k].unit) for k, (a, b) in signals.items()},
        growths={k: growth(time, angle[0], e) if angle else None for k, e in errors.items()},
        bands={k: bands(e, SECONDS_PER_TICK) for k, e in errors.items()},
        energies=(
            _energy(time, signals, supplied[0], 0),
            _energy(time, signals, supplied[1], 1),
        ),
        supply_energy=(supplied[0], supplied[1]),
        changed=differing(first, second),
        identical=all(t.payloads.keys() == t.topics.keys() for t in traces)
        and first_difference(first, second) is None,
        notes=notes,
    )


def _supply_energy(trace: Trace, ticks: np.ndarray, notes: list[str]) -> np.ndarray | None:
    if TRUTH not in trace or "supply_energy" not in (trace[TRUTH].dtype.names or ()):
        if is_run(trace):
            notes.append(f"{trace.name} holds no {TRUTH}: its supply's energy is not known")
        return None
    own = trace[TRUTH]["tick"].astype(np.int64)
    if not np.isin(ticks, own).all():
        notes.append(f"{trace.name}: {TRUTH} lacks ticks: its supply's energy is not known")
        return None
    return np.asarray(rows_at(trace, TRUTH, ticks)["supply_energy"], float)


def _energy(
    time: np.ndarray,
    signals: Mapping[str, tuple[np.ndarray, np.ndarray]],
    supplied: np.ndarray | None,
    side: int,
) -> Energy:
    torque, speed = signals.get("steering_wheel_torque"), signals.get("steering_wheel_speed")
    return energy(
        time,
        supplied,
        torque[side] if torque else None,
        speed[side] if speed else None,
    )


def _energy_dict(item: Energy) -> dict[str, float | None]:
    return {"supply_energy_j": item.supply, "driver_work_j": item.driver_work}


def _growth_dict(item: Growth | None) -> dict[str, Any] | None:
    if item is None:
        return None
    return {
        "frequency_hz": item.frequency.tolist(),
        "peak": item.peak.tolist(),
        "rank_correlation": item.rank,
        "static_share": item.static_share,
        "with_frequency_only": item.with_frequency_only,
    }
