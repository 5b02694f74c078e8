"""What a run did, whichever way it was run."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from steering_bringup.bags import Trace


@dataclass
class Outcome:
    """``ticks`` of ``planned`` were done in ``wall_time`` s.

    ``start_time``: s from the start of the run to its first tick; ``since_command``: s from the
    start of the command to that tick, 0 for a run that followed another.

    ``messages``: recorded; ``lost``: gaps {topic: n}; ``peaks``: largest values {name: (value,
    unit)}; ``error``: why it failed; ``stopped_by``: the signal that ended it; ``latency``: s,
    in real time only; ``rig``: report of the rig, where one was the plant.
    """

    scenario: str
    node_set: str
    planned: int
    ticks: int = 0
    wall_time: float = 0.0
    start_time: float = 0.0
    since_command: float = 0.0
    processes: int = 1
    messages: int = 0
    lost: dict[str, int] = field(default_factory=dict)
    peaks: dict[str, tuple[float, str]] = field(default_factory=dict)
    bag: Path | None = None
    error: str | None = None
    stopped_by: str | None = None
    latency: dict[str, float] | None = None
    notes: list[str] = field(default_factory=list)
    rig: dict[str, Any] | None = None

    @property
    def ok(self) -> bool:
        """Every tick was done and nothing was lost."""
        return not self.error and not self.stopped_by and self.ticks == self.planned

    @property
    def real_time_factor(self) -> float:
        """Simulated over wall-clock time, first tick to last."""
        return self.ticks * 1e-3 / self.wall_time if self.wall_time > 0.0 else 0.0

    def as_json(self) -> dict[str, Any]:
        """Return the outcome for machines."""
        data = asdict(self)
        data["bag"] = None if self.bag is None else str(self.bag)
        data["peaks"] = {n: {"value": v, "unit": u} for n, (v, u) in self.peaks.items()}
        return data | {"ok": self.ok, "real_time_factor": self.real_time_factor}


def peaks(
    torque: np.ndarray, pressure: np.ndarray, rack: np.ndarray
) -> dict[str, tuple[float, str]]:
    """Return the largest absolute values of a run from the measured topics' fields, (n, 3) each."""
    if not len(torque):
        return {}
    load = pressure[:, 1] - pressure[:, 0]
    return {
        "steering wheel angle": (float(np.degrees(np.abs(torque[:, 0]).max())), "deg"),
        "steering wheel speed": (float(np.degrees(np.abs(torque[:, 1]).max())), "deg/s"),
        "torsion bar torque": (float(np.abs(torque[:, 2]).max()), "N m"),
        "assistance pressure": (float(np.abs(load).max()) / 1e5, "bar"),
        "chamber pressure": (float(pressure[:, :2].max()) / 1e5, "bar"),
        "supply pressure": (float(pressure[:, 2].max()) / 1e5, "bar"),
        "rack force": (float(np.abs(rack[:, 2]).max()), "N"),
    }


def peaks_of(trace: Trace) -> dict[str, tuple[float, str]]:
    """Return the largest values of a recorded run; nothing where a topic is missing."""
    names = {
        "/steering/torque": ("steering_wheel_angle", "steering_wheel_speed", "torsion_bar_torque"),
        "/steering/pressure": ("left", "right", "supply"),
        "/steering/rack": ("position", "speed", "force"),
    }
    if any(topic not in trace for topic in names):
        return {}
    columns = [
        np.column_stack([trace.column(topic, name) for name in fields])
        for topic, fields in names.items()
    ]
    return peaks(*columns)
