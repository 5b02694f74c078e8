"""Energy over cycles: open-centre, closed-centre and electric power steering."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.pages import Axes, Curve, Figure
from steering_bringup.scenario_files import load_node_set
from steering_bringup.schema import Scenario
from steering_studies.beyond.study import Answer, Study, Table

PARTS: dict[str, tuple[float, dict[str, Any]]] = {
    "straight ahead": (0.70, {"duration": 5.0, "manoeuvre": {"kind": "hold"}}),
    "lane changes": (
        0.20,
        {
            "duration": 10.0,
            "manoeuvre": {"kind": "weave", "amplitude_deg": 10.0, "frequency_hz": 0.3},
        },
    ),
    "curves": (
        0.08,
        {
            "duration": 20.0,
            "manoeuvre": {"kind": "weave", "amplitude_deg": 60.0, "frequency_hz": 0.1},
            "parameters": {"vehicle.speed": 12.0},
        },
    ),
    "parking": (
        0.02,
        {
            "duration": 10.0,
            "manoeuvre": {"kind": "weave", "amplitude_deg": 28.0, "frequency_hz": 0.25},
            "load": {"kind": "dry_park"},
        },
    ),
}
"""Part of a car's day: share of its time (chosen), and the scenario that stands for it."""


@dataclass(frozen=True)
class Drives:
    """From hydraulic or mechanical power to the engine's shaft; values chosen, typical of cars.

    pump_efficiency: of either pump. over_delivery: a belt-driven pump's flow over what its flow
    control passes on, mean over engine speeds; the surplus is throttled at the same pressure.
    charging_loss: share lost in accumulator and charging valve. motor_efficiency: of an electric
    assistance in motion, gear included. holding_loss: electric power at rest per square of the
    assistance force [W/N2]. standby [W]: electric, always. alternator: efficiency to the shaft.
    """

    pump_efficiency: float = 0.85
    over_delivery: float = 1.8
    charging_loss: float = 0.10
    motor_efficiency: float = 0.70
    holding_loss: float = 150.0 / 6000.0**2
    standby: float = 10.0
    alternator: float = 0.60


@dataclass(frozen=True)
class Power:
    """Mean power in one part of the cycle [W]: at the steering gear, and at the engine's shaft."""

    gear: float
    engine: float


def powers(part: str, parameters: dict[str, float], drives: Drives) -> dict[str, Power]:
    """Return system to mean power in one part of the cycle."""
    document = PARTS[part][1]
    hydraulic = {
        system: mean_power(document, system, parameters)
        for system in ("open_centre", "closed_centre")
    }
    force, speed = _assistance(document, parameters)
    motion = float(np.mean(np.maximum(force * speed, 0.0)))
    holding = float(np.mean(drives.holding_loss * force**2))
    electric = motion / drives.motor_efficiency + holding + drives.standby
    open_engine = hydraulic["open_centre"] * drives.over_delivery / drives.pump_efficiency
    stored = 1.0 - drives.charging_loss
    closed_engine = hydraulic["closed_centre"] / (stored * drives.pump_efficiency)
    return {
        "open centre": Power(hydraulic["open_centre"], open_engine),
        "closed centre": Power(hydraulic["closed_centre"], closed_engine),
        "electric": Power(electric, electric / drives.alternator),
    }


def _scenario(document: dict[str, Any], system: str, parameters: dict[str, float]) -> Scenario:
    given = {**document.get("parameters", {}), **parameters}
    return Scenario.model_validate(
        {"schema": 1, "name": "energy", "truth": False, **document,
         "node_set": system, "parameters": given}
    )  # fmt: skip


def mean_power(document: dict[str, Any], system: str, parameters: dict[str, float]) -> float:
    """Return the mean hydraulic power [W] that a valve system takes from its supply."""
    scenario = _scenario(document, system, parameters)
    cores = build_cores(scenario, load_node_set(system))
    run(cores, scenario.ticks)
    return cores.plant.energy() / ((scenario.ticks - 1) * 1e-3)


def _assistance(
    document: dict[str, Any], parameters: dict[str, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the assistance force [N] that any system has to give, and the rack speed [m/s]."""
    scenario = _scenario(document, "open_centre", parameters)
    trace = run(build_cores(scenario, load_node_set("open_centre")), scenario.ticks)
    area = scenario.parameter_values()["mechanics.piston_area"]
    return (trace.pressure[:, 1] - trace.pressure[:, 0]) * area, trace.rack[:, 1]


def answer(parameters: dict[str, float]) -> Answer:
    """Compare the three systems over the cycle, and the closed one over supply pressures."""
    drives = Drives()
    found = {part: powers(part, parameters, drives) for part in PARTS}
    systems = list(found["parking"])
    mean = {
        name: Power(
            sum(PARTS[p][0] * found[p][name].gear for p in PARTS),
            sum(PARTS[p][0] * found[p][name].engine for p in PARTS),
        )
        for name in systems
    }
    shares = {part: share for part, (share, _) in PARTS.items()} | {"whole cycle": 1.0}
    every = found | {"whole cycle": mean}
    lines = [
        (
            part,
            f"{100.0 * share:.0f} %",
            *(f"{every[part][s].gear:.1f}" for s in systems),
            *(f"{every[part][s].engine:.1f}" for s in systems),
        )
        for part, share in shares.items()
    ]
    places = [(place, s) for place in ("gear", "engine") for s in systems]
    head = ("Part", "Share", *(f"At the {place}, {system} [W]" for place, system in places))
    supplies = [(bar, _over_cycle(bar, parameters)) for bar in (200.0, 150.0, 120.0)]
    ratio = mean["closed centre"].engine / mean["open centre"].engine
    return Answer(
        f"Over the cycle the open centre takes {mean['open centre'].engine:.0f} W of the engine, "
        f"the closed centre {mean['closed centre'].engine:.0f} W ({100.0 * ratio:.0f} %), an "
        f"electric steering {mean['electric'].engine:.0f} W.",
        {
            "cycle": {s: {"gear_W": mean[s].gear, "engine_W": mean[s].engine} for s in systems},
            "parts": {
                p: {
                    s: {"gear_W": found[p][s].gear, "engine_W": found[p][s].engine} for s in systems
                }
                for p in PARTS
            },
            "closed_centre_gear_W_by_supply_bar": dict(supplies),
        },
        [_figure(found, systems)],
        [
            Table(head, lines),
            Table(
                ("Supply pressure [bar]", "Closed centre over the cycle, gear [W]"),
                [(f"{bar:.0f}", f"{power:.1f}") for bar, power in supplies],
            ),
        ],
        [
            "Shares of the cycle and efficiencies of the drives are chosen (Drives).",
            "Computed are the hydraulic power of both systems and the assistance that they give.",
        ],
    )


def _over_cycle(supply_bar: float, parameters: dict[str, float]) -> float:
    changed = {**parameters, "closed_centre.supply_pressure": supply_bar * 1e5}
    return sum(
        share * mean_power(document, "closed_centre", changed) for share, document in PARTS.values()
    )


def _figure(found: dict[str, dict[str, Power]], systems: list[str]) -> Figure:
    colours = ("#b3261e", "#1f5fa8", "#1b7f4b")
    places = np.arange(len(found), dtype=float)
    curves = [
        Curve(
            places,
            np.array([found[part][system].engine for part in found]),
            system,
            colours[k],
            mode="markers",
            over_time=False,
        )
        for k, system in enumerate(systems)
    ]
    axes = Axes("part of the cycle", "power [W]", curves, x_names=tuple(found), log_y=True)
    return Figure("Mean power at the engine's shaft", [[axes]])


STUDY = Study(
    "energy",
    "What does steering cost: open-centre, closed-centre, electric, at the gear and the engine?",
    answer,
)
