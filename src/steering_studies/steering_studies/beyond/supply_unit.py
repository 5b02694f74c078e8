"""A supply unit behind the closed-centre system: pump, accumulator, charging valve."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from steering_plant.model.states import SUPPLY_FLOW
from steering_plant.plant import Plant
from steering_studies.beyond.drawing import over_time
from steering_studies.beyond.loop import closed_loop
from steering_studies.beyond.study import Answer, Study, Table

CYCLES: dict[str, dict[str, Any]] = {
    "on-centre": {
        "duration": 12.0,
        "manoeuvre": {
            "kind": "on_centre",
            "amplitude_deg": 30.0,
            "final_frequency_hz": 2.0,
            "duration_s": 12.0,
        },
    },
    "parking": {
        "duration": 12.0,
        "manoeuvre": {"kind": "weave", "amplitude_deg": 28.0, "frequency_hz": 0.5},
        "load": {"kind": "dry_park"},
    },
    "lock to lock": {
        "duration": 12.0,
        "manoeuvre": {"kind": "weave", "amplitude_deg": 480.0, "frequency_hz": 0.15},
        "load": {"kind": "none"},
    },
}


@dataclass
class SupplyUnit:
    """Pump, charging valve with hysteresis, and a bladder accumulator; SI, gauge pressures.

    The gas follows p V^n = const (absolute). The charging valve sends the pump's flow into the
    accumulator below ``low`` until ``high`` is reached; otherwise the pump idles at ``idle``.
    All sizes are chosen for a passenger car.
    """

    flow: float = 5e-5
    low: float = 1.8e7
    high: float = 2.0e7
    idle: float = 3e5
    gas_volume: float = 0.5e-3
    precharge: float = 1.0e7
    exponent: float = 1.3
    atmosphere: float = 1e5
    pressure: float = 1.95e7
    charging: bool = False
    history: list[tuple[float, bool]] = field(default_factory=list)
    work: float = 0.0

    def gas(self, pressure: float) -> float:
        """Return the gas volume [m3] at a pressure [Pa]."""
        ratio = (self.precharge + self.atmosphere) / (pressure + self.atmosphere)
        return float(self.gas_volume * ratio ** (1.0 / self.exponent))

    def step(self, drawn: float, seconds: float) -> float:
        """Move on by ``seconds`` with ``drawn`` m3/s taken out; return the pressure [Pa]."""
        if self.pressure < self.low:
            self.charging = True
        elif self.pressure > self.high:
            self.charging = False
        net = (self.flow if self.charging else 0.0) - drawn
        volume = min(self.gas(self.pressure) - net * seconds, self.gas_volume)
        ratio = self.gas_volume / volume
        absolute = (self.precharge + self.atmosphere) * ratio**self.exponent
        self.work += self.flow * (self.pressure if self.charging else self.idle) * seconds
        self.pressure = absolute - self.atmosphere
        self.history.append((self.pressure, self.charging))
        return self.pressure


def answer(parameters: dict[str, float]) -> Answer:
    """Drive the cycles on the supply unit and on a constant supply."""
    rows, numbers, curves = [], {}, {}
    for name, document in CYCLES.items():
        unit = SupplyUnit()

        def feed(tick: int, plant: Plant, unit: SupplyUnit = unit) -> None:
            plant.par["supply_pressure"][0] = unit.step(float(plant.flows[SUPPLY_FLOW]), 1e-3)

        whole = {**document, "node_set": "closed_centre"}
        fed, constant = (
            closed_loop(whole, parameters, before=feed),
            closed_loop(whole, parameters),
        )
        torque = float(np.max(np.abs(fed.measured[:, 2] - constant.measured[:, 2])))
        pressures = np.array([pressure for pressure, _ in unit.history])
        charging = float(np.mean([on for _, on in unit.history]))
        power = unit.work / (len(pressures) * 1e-3)
        numbers[name] = {
            "lowest_supply_Pa": float(pressures.min()),
            "share_charging": charging,
            "pump_power_W": power,
            "torque_difference_Nm": torque,
        }
        rows.append(
            (name, f"{pressures.min() * 1e-5:.1f}", f"{100 * charging:.0f} %", f"{power:.0f}",
             f"{torque:.3f}")
        )  # fmt: skip
        curves[name] = (fed.time, pressures * 1e-5)
    worst = max(found["torque_difference_Nm"] for found in numbers.values())
    lowest = min(found["lowest_supply_Pa"] for found in numbers.values())
    return Answer(
        f"With a 3 l/min pump and a 0.5 l accumulator the supply falls no lower than "
        f"{lowest * 1e-5:.1f} bar; the driver feels at most {worst:.2f} N m of it.",
        numbers,
        [over_time("Supply pressure", {"supply pressure [bar]": curves}, 320)],
        [
            Table(
                (
                    "Cycle",
                    "Lowest supply [bar]",
                    "Time charging",
                    "Pump power [W]",
                    "Torque difference [N m]",
                ),
                rows,
            )
        ],
        ("Pump power is hydraulic, with 3 bar of idling; sizes are chosen (SupplyUnit).",),
    )


STUDY = Study(
    "supply_unit", "What do pump, accumulator and charging valve do to the closed centre?", answer
)
