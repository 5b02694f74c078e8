"""Does a second stage hold the pressure under flow, as the source's outlook expects? Its price.

The valve and its loop gain are in two_stage_valve.py; here it is compared with the single stage.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pressure_control.linear_valve import linearise
from pressure_control.valve_gains import edge_areas, valve_record
from pressure_control.valve_static import pressure_under_flow
from steering_bringup.pages import Axes, Curve, Figure
from steering_core.parameters import ParameterSet, load_parameters
from steering_plant.orifice import orifice_flow
from steering_studies.beyond.drawing import COLOURS
from steering_studies.beyond.study import Answer, Study, Table
from steering_studies.beyond.two_stage_valve import (
    HEAVY_VEHICLE,
    STEP_H,
    MainStage,
    TwoStageValve,
)
from steering_studies.linear.bode import Margins, grid, margins
from steering_studies.linear.valve_study import loop_gain, valve_step

BAR, LITRE_PER_MINUTE = 1e5, 1e-3 / 60.0
SETTLE_S = 0.35
"""Time in which the load flow has come in and the pilot has trimmed the pressure."""

QUIET_PA = 0.1e5
"""A pressure that moves by more at the end of a run is not at rest."""


NOTES = (
    (
        "Sizes were chosen from the loop gain (two_stage_valve.py). Margins are the least of all "
        "points of the static characteristic, every lag included; the single stage's are those "
        "at its highest gain."
    ),
    (
        "The pilot's pressure has to lie up to 70 bar above the load's. From about 130 bar on, at "
        "a supply of 200 bar and full flow, the main spool opens no further: the pressure gives "
        "way."
    ),
    (
        "A pressure controller trims the single stage's error as well, as far as its solenoid "
        "goes; two stages need neither sensor nor controller for that."
    ),
)


@dataclass(frozen=True)
class Held:
    """Pressures [Pa] over load flow [m3/s] (n,) at one reference [Pa], without a controller.

    dipped [Pa]: largest error of the two stages while the flow comes in. margins: of two stages.
    """

    reference: float
    flow: np.ndarray
    single: np.ndarray
    double: np.ndarray
    dipped: float
    margins: list[Margins]

    def worst(self, pressures: np.ndarray) -> float:
        """Return the largest error to the reference [Pa]."""
        return float(np.max(np.abs(pressures - self.reference)))


def held(parameters: ParameterSet, reference: float, flows: np.ndarray, main: MainStage) -> Held:
    """Return both valves' static characteristic at one reference [Pa]; NaN where it swings."""
    valve, hertz = TwoStageValve(parameters, main), grid(0.1, 3000.0)
    double, found, dips = [], [], []
    for flow in flows:
        start = valve.run(valve.rest(reference), reference, 0.0, SETTLE_S)[1]
        pressure, y = valve.run(start, reference, float(flow), SETTLE_S)
        tail = pressure[-len(pressure) // 8 :]
        double.append(float(tail.mean()) if np.ptp(tail) < QUIET_PA else np.nan)
        dips.append(float(np.abs(pressure - reference).max()))
        found.append(margins(hertz, valve.loop_gain(y, reference, float(flow), hertz)))
    single = pressure_under_flow(parameters, reference, flows)
    return Held(reference, flows, single, np.array(double), max(dips), found)


@dataclass(frozen=True)
class Stepped:
    """Two stages' pressure [Pa] over time [s] (n,) after a step; first passing of 90 % [s]."""

    time: np.ndarray
    pressure: np.ndarray
    quick: float
    overshoot: float


def stepped(valve: TwoStageValve, low: float, high: float, time: float = 0.06) -> Stepped:
    """Step the pilot's solenoid from ``low`` to ``high`` [Pa] without load flow."""
    start = valve.run(valve.rest(low), low, 0.0, SETTLE_S)[1]
    pressure, _ = valve.run(start, high, 0.0, time)
    done = (pressure - low) / (high - low)
    quick = float(np.argmax(done >= 0.9)) * STEP_H if done.max() >= 0.9 else float("nan")
    over = max(float((done.max() - 1.0) * abs(high - low)), 0.0)
    return Stepped(np.arange(len(pressure)) * STEP_H, pressure, quick, over)


def standby(parameters: ParameterSet, pressure: float = 5.0 * BAR) -> tuple[float, float]:
    """Return the power [W] that two valves take at rest: single stage, two stages."""
    supply = parameters["closed_centre.supply_pressure"]
    p, rest = valve_record(parameters)[0], linearise(parameters, pressure, flow=0.0)
    area = edge_areas(p, rest.displacement)[0]
    leak = orifice_flow(
        float(p["orifice_constant"]) * area,
        supply - pressure,
        float(p["laminar_transition_pressure"]),
    )
    valve = TwoStageValve(parameters)
    y = valve.run(valve.rest(pressure), pressure, 0.0, SETTLE_S)[1]
    return 2.0 * float(leak) * supply, 2.0 * valve.drawn(y, pressure) * supply


def answer(parameters: dict[str, float]) -> Answer:
    """Compare static characteristic, steps and margins; then the heavy vehicle's valve."""
    sheet = load_parameters().with_values(parameters)
    truck = load_parameters("heavy_vehicle").with_values(parameters)
    car = [
        held(sheet, bar * BAR, np.linspace(-12.0, 12.0, 25) * LITRE_PER_MINUTE, MainStage())
        for bar in (20.0, 60.0, 100.0)
    ]
    heavy = [
        held(truck, bar * BAR, np.linspace(-20.0, 20.0, 21) * LITRE_PER_MINUTE, HEAVY_VEHICLE)
        for bar in (20.0, 100.0, 150.0)
    ]
    valve = TwoStageValve(sheet)
    large, small = stepped(valve, 5e5, 100e5), stepped(valve, 5e5, 15e5)
    one_large, one_small = valve_step(sheet, 5e5, 100e5), valve_step(sheet, 5e5, 15e5)
    one_stage = loop_gain(sheet).margins()[0]
    one_watt, two_watt = standby(sheet)
    phase, gain = _least(car)
    truck_phase, truck_gain = _least(heavy)
    errors = max(h.worst(h.single) for h in car), max(h.worst(h.double) for h in car)
    dip, quick = max(h.dipped for h in car), one_large.first_reaches(0.9)
    numbers: dict[str, Any] = {
        "single_stage_error_Pa": errors[0],
        "two_stage_error_Pa": errors[1],
        "two_stage_error_while_flow_comes_Pa": dip,
        "heavy_vehicle_single_stage_error_Pa": max(h.worst(h.single) for h in heavy),
        "heavy_vehicle_two_stage_error_Pa": max(h.worst(h.double) for h in heavy),
        "large_step_s": {"single": quick, "two_stage": large.quick},
        "small_step_s": {"single": one_small.first_reaches(0.9), "two_stage": small.quick},
        "large_step_overshoot_Pa": {"single": one_large.overshoot, "two_stage": large.overshoot},
        "phase_margin_deg": {"single": one_stage.phase, "two_stage": phase},
        "gain_margin": {"single": one_stage.gain, "two_stage": gain},
        "heavy_vehicle_margins": {"phase_deg": truck_phase, "gain": truck_gain},
        "standby_W": {"single": one_watt, "two_stage": two_watt},
    }
    return Answer(
        f"Up to 12 l/min two stages hold 20 to 100 bar within {errors[1] / BAR:.1f} bar at rest "
        f"where one stage is off by up to {errors[0] / BAR:.0f} bar, and within {dip / BAR:.0f} "
        f"bar while the flow comes in. The large step takes {large.quick * 1e3:.1f} ms in place of "
        f"{quick * 1e3:.1f} ms, the phase margin falls from {one_stage.phase:.0f} to {phase:.0f} "
        f"deg, standby power rises from {one_watt:.0f} to {two_watt:.0f} W.",
        numbers,
        [
            _static_figure("Static characteristic, passenger car, no controller", car),
            _static_figure("Static characteristic, heavy vehicle, no controller", heavy),
            Figure(
                "Steps from 5 bar",
                [
                    [
                        _step_axes(large, one_large.time, one_large.pressure),
                        _step_axes(small, one_small.time, one_small.pressure),
                    ]
                ],
            ),
        ],
        [_error_table(car, heavy), _comparison(numbers)],
        NOTES,
    )


def _least(found: list[Held]) -> tuple[float, float]:
    every = [m for one in found for m in one.margins]
    return min(m.phase for m in every), min(m.gain for m in every)


def _static_figure(title: str, found: list[Held]) -> Figure:
    curves = [
        Curve(
            one.flow / LITRE_PER_MINUTE,
            values / BAR,
            f"{one.reference / BAR:.0f} bar, {name}",
            COLOURS[k],
            dash=dash,
            over_time=False,
        )
        for k, one in enumerate(found)
        for values, name, dash in (
            (one.single, "single stage", "dot"),
            (one.double, "two stages", "solid"),
        )
    ]
    axes = Axes("load flow [l/min]", "pressure [bar]", curves)
    return Figure(title, [[axes]], height=380)


def _step_axes(made: Stepped, time: np.ndarray, pressure: np.ndarray) -> Axes:
    curves = [
        Curve(time * 1e3, pressure / BAR, "single stage", COLOURS[1], dash="dot"),
        Curve(made.time * 1e3, made.pressure / BAR, "two stages", COLOURS[2]),
    ]
    return Axes("time [ms]", "pressure [bar]", curves)


def _error_table(car: list[Held], heavy: list[Held]) -> Table:
    rows = [
        (
            name,
            f"{one.reference / BAR:.0f}",
            f"{one.flow[-1] / LITRE_PER_MINUTE:.0f}",
            f"{one.worst(one.single) / BAR:.1f}",
            f"{one.worst(one.double) / BAR:.1f}",
            f"{one.dipped / BAR:.1f}",
        )
        for name, found in (("passenger car", car), ("heavy vehicle", heavy))
        for one in found
    ]
    head = ("Vehicle", "Reference [bar]", "Flow up to [l/min]", "Error, one stage [bar]",
            "Error, two stages [bar]", "Two stages, while the flow comes in [bar]")  # fmt: skip
    return Table(head, rows)


def _comparison(numbers: dict[str, Any]) -> Table:
    lines = (
        ("5 to 100 bar, 90 % [ms]", "large_step_s", 1e3, ".1f"),
        ("5 to 15 bar, 90 % [ms]", "small_step_s", 1e3, ".1f"),
        ("overshoot of the large step [bar]", "large_step_overshoot_Pa", 1e-5, ".1f"),
        ("least phase margin [deg]", "phase_margin_deg", 1.0, ".0f"),
        ("least gain margin [factor]", "gain_margin", 1.0, ".1f"),
        ("standby power of both chambers' valves [W]", "standby_W", 1.0, ".1f"),
    )
    rows = [
        (text, *(format(numbers[key][stage] * scale, form) for stage in ("single", "two_stage")))
        for text, key, scale, form in lines
    ]
    return Table(("Passenger car", "Single stage", "Two stages"), rows)


STUDY = Study(
    "two_stage", "How well does a two-stage valve hold its pressure, and what does it cost?", answer
)
