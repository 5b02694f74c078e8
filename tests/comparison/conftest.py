"""Two synthetic runs of an on-centre sweep whose differences are known."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from steering_bringup.bags import BagWriter, Trace, read_bag
from steering_bringup.bags.encode import encode

TYPES = {
    "/steering/torque": "SteeringTorque",
    "/steering/pressure": "ChamberPressure",
    "/steering/rack": "RackState",
    "/driver/torque": "DriverTorque",
    "/truth/plant": "PlantTruth",
    "/valve/left/command": "ValveCommand",
}
Fields = dict[str, dict[str, np.ndarray]]


def sweep(ticks: np.ndarray, duration: float, final_hz: float = 2.0) -> tuple[np.ndarray, ...]:
    """Phase [rad] and frequency [Hz] of a sine whose frequency rises linearly from zero."""
    time = ticks * 1e-3
    return np.pi * final_hz / duration * time**2, final_hz * time / duration


def signals(ticks: np.ndarray, duration: float, closed: bool) -> Fields:
    """A run's fields. The closed-centre one differs by 0.04 N m and 0.2 bar a hertz."""
    phase, frequency = sweep(ticks, duration)
    extra = frequency * np.cos(phase) if closed else np.zeros(len(ticks))
    load = 20e5 * np.sin(phase) + 0.2e5 * extra
    angle = np.radians(30.0) * np.sin(phase)
    speed = np.radians(30.0) * 2 * np.pi * frequency * np.cos(phase)
    power = 150.0 if closed else 240.0
    fields: Fields = {
        "/steering/torque": {
            "steering_wheel_angle": angle,
            "steering_wheel_speed": speed,
            "torsion_bar_torque": 3.0 * np.sin(phase),
        },
        "/steering/pressure": {
            "left": 5e5 + np.maximum(-load, 0.0),
            "right": 5e5 + np.maximum(load, 0.0),
            "supply": np.full(len(ticks), 200e5 if closed else 36e5),
        },
        "/steering/rack": {"position": angle / 130.9, "speed": speed / 130.9},
        "/driver/torque": {"torque": 3.0 * np.sin(phase) + 0.04 * extra},
        "/truth/plant": {"supply_energy": power * ticks * 1e-3},
    }
    if closed:
        fields["/valve/left/command"] = {"solenoid_force": np.zeros(len(ticks))}
    return fields


def write(path: Path, ticks: np.ndarray, fields: Fields, run: Mapping[str, Any]) -> Trace:
    """Write a bag and read it back."""
    stamps = ticks.astype(np.int64) * 1_000_000
    types = {topic: f"steering_msgs/msg/{TYPES[topic]}" for topic in fields}
    with BagWriter(path, types, run) as writer:
        writer.write_block(
            stamps,
            {t: encode(types[t], stamps, {"tick": ticks, **f}) for t, f in fields.items()},
        )
    return read_bag(path)


Make = Callable[..., Trace]


@pytest.fixture
def make_run(tmp_path: Path) -> Make:
    """A synthetic run: `closed` or not, ticks from `start`, without the topics of `without`."""

    def make(
        name: str,
        closed: bool = False,
        duration: float = 10.0,
        start: int = 0,
        without: tuple[str, ...] = (),
        change: Callable[[Fields, np.ndarray], None] | None = None,
        kind: str = "on_centre",
        load: str = "bicycle",
        parameters: Mapping[str, float] | None = None,
    ) -> Trace:
        ticks = np.arange(start, round(duration * 1000), dtype=np.uint64)
        fields = signals(ticks, 10.0, closed)
        if change:
            change(fields, ticks)
        run = {
            "scenario": {"name": kind, "manoeuvre": {"kind": kind}, "load": {"kind": load}},
            "parameters": dict(parameters or {"mechanics.rack_mass": 24.0}),
        }
        kept = {t: f for t, f in fields.items() if t not in without}
        return write(tmp_path / name, ticks, kept, run)

    return make


@pytest.fixture
def pair(make_run: Make) -> tuple[Trace, Trace]:
    """The open-centre and the closed-centre run."""
    return make_run("open"), make_run("closed", closed=True)
