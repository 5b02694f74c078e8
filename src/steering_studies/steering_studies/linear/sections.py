"""What ``steer linear`` shows of each study: curves, a table, numbers for machines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from steering_bringup.pages import Axes, Curve, Figure
from steering_core.parameters import ParameterSet
from steering_studies.linear import (
    chattering,
    lag,
    latency,
    open_centre_study,
    source_figures,
    steering_study,
    tolerance,
    valve_study,
)
from steering_studies.linear.bode import Family
from steering_studies.linear.steps import torque_step
from steering_studies.linear.systems import Comparison

COLOURS = ("#3b6fb6", "#2a9d8f", "#8ab17d", "#e9a23b", "#c8443b")
"""From low to high torque."""


@dataclass
class Section:
    """One study's part of page, printout and JSON. tables: title, head and rows of text."""

    name: str
    title: str
    figures: list[Figure] = field(default_factory=list)
    tables: list[tuple[str, list[str], list[list[str]]]] = field(default_factory=list)
    numbers: dict[str, Any] = field(default_factory=dict)

    def add_family(self, family: Family, source: str, unit: str = "N m") -> None:
        """Add a Bode plot with what the source's figure shows, and its margins."""
        self.figures.append(bode_figure(family, source, unit))
        self.numbers[f"figure_{family.figure}"] = family.numbers()
        if family.is_loop:
            self.tables.append(margin_table(family, unit))

    def add_table(self, title: str, head: list[str], rows: list[list[str]]) -> None:
        """Add a table."""
        self.tables.append((title, head, rows))


@dataclass(frozen=True)
class Wish:
    """What the studies need beside parameters: size and seed of the Monte Carlo, its progress."""

    count: int = 100
    seed: int = 1
    on_progress: Callable[[int], None] | None = None


def bode_figure(family: Family, source: str, unit: str = "N m") -> Figure:
    """Return amplitude and phase of a family over frequency, low to high torque."""
    scale = 1.0 if unit == "N m" else 1e-5
    names = [f"{value * scale:g} {unit}" for value in family.torque]
    colours = [COLOURS[k * (len(COLOURS) - 1) // max(len(names) - 1, 1)] for k in range(len(names))]

    def curves(rows: np.ndarray) -> list[Curve]:
        return [
            Curve(family.frequency, row, name, colour)
            for row, name, colour in zip(rows, names, colours, strict=True)
        ]

    x = "frequency [Hz]"
    amplitude = Axes(x, "amplitude [dB]", curves(family.decibel), link="f", log_x=True)
    phase = Axes(x, "phase [deg]", curves(family.degrees), link="f", log_x=True)
    title = f"Fig {family.figure}: {family.title}"
    return Figure(title, [[amplitude], [phase]], f"Source: {source}", height=240)


def margin_table(family: Family, unit: str) -> tuple[str, list[str], list[list[str]]]:
    """Return the margins as a table."""
    scale = 1.0 if unit == "N m" else 1e-5
    rows = [
        [
            f"{v * scale:g} {unit}",
            _text(m.gain, ".2f"),
            _text(m.gain_frequency, ".0f"),
            _text(m.phase, ".1f"),
            _text(m.crossover, ".1f"),
        ]
        for v, m in zip(family.torque, family.margins(), strict=True)
    ]
    head = ["at", "gain margin", "at Hz", "phase margin deg", "crossover Hz"]
    return f"fig {family.figure}, {family.title}", head, rows


def open_centre(parameters: ParameterSet, wish: Wish) -> Section:
    """Figs 4.3, 4.5, 4.6, 4.7 and where the source's form parts from the whole linearisation."""
    section = Section("open-centre", "Open-centre valve and gear")
    curves = open_centre_study.static_characteristic(parameters)
    section.figures.append(_static_figure("4.3", curves, "N m", 1.0, "0-5 l/min, up to 250 bar"))
    section.numbers["figure_4.3"] = {
        "bar_at_-5_0_5_l_min_4_Nm": (curves.load_pressure[-1][[0, 25, 50]] / 1e5).tolist()
    }
    section.add_family(
        open_centre_study.pressure_response(parameters),
        "100-140 dB (pressure in Pa); fast at low torque, slow at high",
    )
    section.add_family(
        open_centre_study.loop_gain(parameters), "axes -20..20 dB, 0 to -200 deg; no numbers"
    )
    section.add_family(
        open_centre_study.closed_loop(parameters), "axes -20..0 dB, to 100 Hz; no numbers"
    )
    parts = open_centre_study.parting(parameters)
    rows = [
        [
            f"{t:g} N m",
            _text(leaves, ".1f"),
            f"{d:.2f} dB at {df:.0f} Hz",
            f"{p:.1f} at {pf:.0f} Hz",
        ]
        for t, leaves, d, df, p, pf in zip(
            parts.torque,
            parts.leaves,
            parts.decibel,
            parts.decibel_frequency,
            parts.degrees,
            parts.degrees_frequency,
            strict=True,
        )
    ]
    head = ["at", "beyond 1 dB or 5 deg from Hz", "largest", "largest, deg"]
    section.add_table("the source's (4.15) against all three volumes, to 100 Hz", head, rows)
    section.numbers["source_form_parts"] = plain(asdict(parts))
    return section


def valve(parameters: ParameterSet, wish: Wish) -> Section:
    """Figs 6.5, 6.6, 6.7 and the restrictor criterion."""
    section = Section("valve", "Pressure control valve")
    curves = valve_study.static_characteristic(parameters)
    section.figures.append(
        _static_figure(
            "6.5", curves, "bar", 1e-5, "0-5 l/min, 0-120 bar; steep at low pressure, flat at high"
        )
    )
    section.add_family(
        valve_study.loop_gain(parameters), "far from any limit; the phase margin limits", "bar"
    )
    steps = source_figures.figure_6_7(parameters)
    large, small = steps["large"], steps["small"]
    shown = [
        Curve(step.time * 1e3, step.pressure / 1e5, name, colour)
        for (name, step), colour in zip(steps.items(), COLOURS[::4], strict=True)
    ]
    axes = Axes("time [ms]", "pressure [bar]", shown)
    caption = "Source: 100 bar in 5 ms to 90 %, overshoot below 5 bar; small step in 6 ms"
    section.figures.append(Figure("Fig 6.7: steps of the valve", [[axes]], caption))
    section.numbers["figure_6.7"] = {
        "large_90_percent_ms": large.first_reaches(0.9) * 1e3,
        "large_overshoot_bar": large.overshoot / 1e5,
        "small_90_percent_ms": small.reaches(0.9) * 1e3,
    }
    tries = valve_study.small_step_tries(parameters)
    rows = [
        [
            t.name,
            f"{t.reaches * 1e3:.1f}",
            f"{t.back * 1e3:.1f}",
            f"{t.standby:.0f}",
            f"{t.ratio:.2f}",
            f"{t.large * 1e3:.1f}",
            f"{t.large_overshoot / 1e5:.1f}",
        ]
        for t in tries
    ]
    head = ["try", "5-15 bar ms", "15-5 bar ms", "standby W", "restrictor ratio"]
    head += ["100 bar ms", "overshoot bar"]
    section.add_table("small step against the source's 6 ms", head, rows)
    section.numbers["small_step_tries"] = [plain(asdict(t)) for t in tries]
    found = valve_study.restrictor_validity(parameters)
    linear, simulated = valve_study.restrictor_onset(parameters)
    rows = [
        [
            f"{v.ratio:.2f}",
            f"{v.decibel:.2f}",
            f"{v.degrees:.1f}",
            _text(v.leaves, ".0f"),
            f"{v.margins.gain:.2f}",
            f"{v.damping:.3f}",
            f"{v.growth:.0f}",
            f"{v.ripple / 1e5:.2f}",
        ]
        for v in found
    ]
    head = ["K_1/limit (5.28)", "dB to 100 Hz", "deg", "parts at Hz", "gain margin", "damping"]
    head += ["growth 1/s at 2 l/min", "ripple bar"]
    section.add_table("simplified against general diagram, and the restrictor", head, rows)
    section.add_table(
        "restrictor ratio at which the valve goes into a limit cycle",
        ["linear", "simulated"],
        [[f"{linear:.2f}", f"{simulated:.2f}"]],
    )
    section.numbers["restrictor"] = {
        "onset_linear": linear,
        "onset_simulated": simulated,
        "validity": [plain(asdict(v)) for v in found],
    }
    return section


def steering(parameters: ParameterSet, wish: Wish) -> Section:
    """Figs 6.11, 6.12, 7.6, 7.7, 8.1 to 8.6."""
    section = Section("steering", "Steering loop with pressure control and servo valves")
    section.add_family(
        steering_study.valve_loop_gain(parameters), "no figure; loop w_k^2/(s(s + k w_k^2)) (6.7)"
    )
    more = "more phase lag at low torque, less gain margin at high"
    section.add_family(steering_study.closed_centre_loop_gain(parameters), more)
    section.add_family(steering_study.closed_centre_closed_loop(parameters), more)
    servo = "more lag than with control valves, slight overshoot; (7.15) without feed-forward"
    section.add_family(source_figures.figure_7_6(parameters), servo)
    section.add_family(source_figures.figure_7_7(parameters), servo)
    step = torque_step(parameters)
    shown = [
        Curve(step.time * 1e3, step.opened / 1e5, "open-centre", COLOURS[0], dash="dash"),
        Curve(step.time * 1e3, step.closed / 1e5, "closed-centre", COLOURS[4]),
    ]
    axes = Axes("time [ms]", "right chamber [bar]", shown)
    caption = "Source: 4.5 to 15 bar, as fast as the open-centre valve"
    section.figures.append(Figure("Fig 8.1: step of 2 N m", [[axes]], caption))
    section.numbers["figure_8.1"] = {
        "from_bar": step.closed[0] / 1e5,
        "to_bar": step.closed[-1] / 1e5,
        "closed_90_percent_ms": step.rise(step.closed) * 1e3,
        "open_90_percent_ms": step.rise(step.opened) * 1e3,
    }
    runs = {
        "on-centre (8.2 to 8.5)": source_figures.on_centre(parameters),
        "dry park (8.6)": source_figures.dry_park(parameters),
        "dry park, 175 rad/s constant": source_figures.dry_park_lower_gain(parameters),
    }
    section.add_table(
        "closed-centre against open-centre, largest differences",
        ["manoeuvre", "driver N m", "torsion bar N m", "assistance bar", "chamber bar", "peak bar"],
        [[name, *_compared(run)] for name, run in runs.items()],
    )
    section.numbers["runs"] = {name: run.numbers() for name, run in runs.items()}
    return section


def chatter(parameters: ParameterSet, wish: Wish) -> Section:
    """Onset of chattering, predicted and simulated."""
    section = Section("chattering", "Chattering: the loop's gain too high")
    found = [
        onset(parameters, torque)
        for torque in (2.0, 3.0, 3.5)
        for onset in (chattering.gain_onset, chattering.motion_onset)
    ]
    rows = [
        [
            f"{o.name}, {o.torque:g} N m",
            f"{o.predicted:.4g}",
            f"{o.simulated:.4g}",
            o.unit,
            f"{o.frequency:.0f}",
        ]
        for o in found
    ]
    section.add_table("onset", ["cause", "linear", "simulated", "unit", "Hz"], rows)
    section.numbers["onsets"] = [asdict(o) for o in found]
    return section


def hydraulic_lag(parameters: ParameterSet, wish: Wish) -> Section:
    """Static and dynamic lag, predicted and simulated."""
    section = Section("lag", "Hydraulic lag")
    static = lag.catch_up(parameters)
    shown = [
        Curve(static.speed, static.predicted, "static map", COLOURS[0], dash="dash"),
        Curve(static.speed, static.simulated, "simulation", COLOURS[4]),
    ]
    axes = Axes("rack speed [m/s]", "torsion-bar torque [N m]", shown)
    caption = f"Wheel turned faster and faster against {static.load:g} N"
    section.figures.append(Figure("Static lag: catch-up", [[axes]], caption))
    dynamic = lag.dynamic_lag(parameters)
    section.add_table(
        "rack speed at which catch-up has cost 1 N m",
        ["static map m/s", "simulated m/s"],
        [[f"{static.onset_predicted:.4f}", f"{static.onset_simulated:.4f}"]],
    )
    rows = [
        [f"{t:g} N m", _text(a, ".1f"), _text(b, ".1f")]
        for t, a, b in zip(dynamic.torque, dynamic.predicted, dynamic.simulated, strict=True)
    ]
    head = ["at", "linear Hz", "simulated Hz"]
    section.add_table("dynamic lag: 45 degrees behind the torque", head, rows)
    section.numbers = {"static": plain(asdict(static)), "dynamic": plain(asdict(dynamic))}
    return section


def late(parameters: ParameterSet, wish: Wish) -> Section:
    """The latency and stability map."""
    section = Section("latency", "Latency and stability")
    maps = latency.latency_map(parameters)
    rows, curves = [], []
    for m, colour in zip(maps, COLOURS[::2], strict=True):
        for delay, a, b in zip(m.delay, m.predicted, m.simulated, strict=True):
            row = [m.node_set, m.way, f"{delay}", f"{a:.0f}", _text(b, ".0f"), m.unit]
            rows.append(row)
        if m.unit == "rad/s":
            curves.append(Curve(m.delay, m.predicted, f"{m.way}, linear", colour))
            curves.append(
                Curve(m.delay, m.simulated, f"{m.way}, simulated", colour, mode="markers")
            )
    axes = Axes("delay, measurement to command [ticks of 1 ms]", "resonance [rad/s]", curves)
    section.figures.append(Figure("Largest stable resonance", [[axes]]))
    head = ["node set", "controller", "delay ticks", "linear", "simulated", "unit"]
    section.add_table("largest stable gain", head, rows)
    section.numbers["maps"] = [plain(asdict(m)) for m in maps]
    return section


def spread(parameters: ParameterSet, wish: Wish) -> Section:
    """Monte Carlo over the data sheet's tolerances."""
    section = Section("tolerance", "Sensitivity to tolerances")
    found = tolerance.monte_carlo(parameters, wish.count, wish.seed, on_progress=wish.on_progress)
    rows, numbers = [], {}
    for k, figure in enumerate(tolerance.FIGURES):
        low, middle, high = np.nanpercentile(found.column(figure), [2.5, 50.0, 97.5])
        causes = found.most_influential(figure, 3)
        named = ", ".join(f"{name} {r:+.2f}" for name, r in causes)
        values = [float(v) for v in (found.nominal[k], low, middle, high)]
        rows.append([figure, *(f"{v:.4g}" for v in values), named])
        numbers[figure] = dict(zip(("nominal", "low", "median", "high"), values, strict=True))
        numbers[figure]["influence"] = dict(causes)  # type: ignore[assignment]
    head = ["figure", "data sheet", "2.5 %", "median", "97.5 %", "most influential (rank corr.)"]
    title = f"{wish.count} specimens, seed {wish.seed}"
    section.add_table(title, head, rows)
    section.numbers = {"count": wish.count, "seed": wish.seed, "figures": numbers}
    return section


SECTIONS: dict[str, Callable[[ParameterSet, Wish], Section]] = {
    "open-centre": open_centre,
    "valve": valve,
    "steering": steering,
    "chattering": chatter,
    "lag": hydraulic_lag,
    "latency": late,
    "tolerance": spread,
}
"""Studies of ``steer linear`` by name, in the order of the page."""


def plain(value: Any) -> Any:
    """Return arrays as lists and numbers that are none as None, for JSON."""
    if isinstance(value, dict):
        return {name: plain(inner) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value


def _static_figure(
    number: str,
    curves: open_centre_study.StaticCurves,
    unit: str,
    scale: float,
    source: str,
) -> Figure:
    flow = curves.load_flow / open_centre_study.LITRE_PER_MINUTE
    shown = [
        Curve(flow, pressure / 1e5, f"{at * scale:g} {unit}", colour)
        for at, pressure, colour in zip(
            curves.torque, curves.load_pressure, COLOURS[1:], strict=True
        )
    ]
    axes = Axes("load flow [l/min]", "pressure [bar]", shown)
    return Figure(f"Fig {number}: static characteristic", [[axes]], f"Source: {source}")


def _compared(run: Comparison) -> list[str]:
    return [
        f"{run.driver_torque:.3f}",
        f"{run.torsion_bar_torque:.3f}",
        f"{run.load_pressure / 1e5:.2f}",
        f"{run.chamber_pressure / 1e5:.2f}",
        f"{run.largest_load_pressure / 1e5:.1f}",
    ]


def _text(value: float, form: str) -> str:
    return format(value, form) if np.isfinite(value) else "none"
