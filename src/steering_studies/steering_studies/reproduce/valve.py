"""The pressure control valve's design: figures 6.4 to 6.7."""

from __future__ import annotations

import numpy as np

from pressure_control.valve_design.front import complex_front, distance_to
from pressure_control.valve_design.problem import DesignProblem
from steering_core.parameters import load_parameters
from steering_studies.linear import valve_study
from steering_studies.linear.bode import Family
from steering_studies.pages.valve_design import characteristic_figure, front_figure, step_figure
from steering_studies.reproduce.bode import bode
from steering_studies.reproduce.row import Number, Row
from steering_studies.valve_design import (
    characteristics,
    chosen_design,
    nominal_design,
    steps,
)

BAR = 1e-5
SEED = 1


def front() -> Row:
    """Return fig 6.4, by the method that the source names."""
    parameters = load_parameters()
    made, problem = complex_front(parameters, SEED), DesignProblem(parameters)
    found, sheet = (
        problem.evaluate(chosen_design(made)),
        problem.evaluate(nominal_design(parameters)),
    )
    inside = distance_to(made, sheet.step_time, sheet.force)
    quick = made.step_times <= sheet.step_time
    cut = float(made.step_times[made.forces <= 70.0].min(initial=np.inf))
    least = f"{made.forces[quick].min():.0f} N" if quick.any() else "no force"
    return Row(
        "6.4",
        "Pareto front of solenoid force against step time",
        [
            Number("least force of the front", "N", 10.0, float(made.forces.min()), "force"),
            Number("largest force of the front", "N", 70.0, float(made.forces.max()), "force"),
            Number("step time of the data sheet's valve", "ms", 5.0, sheet.step_time * 1e3, "time",
                   "at most"),
            Number("factor by which it could be better in both (1: on the front)", "1", 1.0,
                   inside),
        ],
        [front_figure([made], found, sheet)],
        because="the source's bounds are not printed, and the quick end of the front depends on "
        f"them: the last {1e3 * (cut - float(made.step_times.min())):.2f} ms take what is above "
        f"70 N. The data sheet's valve comes from an earlier search and lies "
        f"inside this front: its {sheet.step_time * 1e3:.1f} ms take {sheet.force:.0f} N, the "
        f"front's best takes {least}. The red point is the front's own choice",
    )  # fmt: skip


def characteristic() -> Row:
    """Return fig 6.5."""
    made = characteristics(load_parameters())
    droop = {c.reference: float((c.pressure.max() - c.pressure.min()) * BAR) for c in made}
    low, high = min(droop), max(droop)
    return Row(
        "6.5",
        "Static characteristic of the valve",
        [
            Number("span over +-5 l/min at 5 bar", "bar", None, droop[low]),
            Number("span over +-5 l/min at 100 bar", "bar", None, droop[high]),
        ],
        [characteristic_figure(made)],
        words="Steep at low pressure, as the source says of its own; at high pressure the spring "
        "and the flow force keep the slope, so the source's 'better at high pressure' is seen "
        "only against the open-centre valve.",
    )


def step_responses() -> Row:
    """Return fig 6.7."""
    large, small, back = steps(load_parameters())
    return Row(
        "6.7",
        "Step responses of the valve",
        [
            Number("90 % of 100 bar", "ms", 5.0, large.time_to(0.9) * 1e3, "time", "at most"),
            Number("overshoot", "bar", 5.0, large.overshoot * BAR, "pressure", "at most"),
            Number("small step up, final value", "ms", 6.0, small.time_to(0.95) * 1e3, "time",
                   "at most"),
            Number("small step down, 90 %", "ms", None, back.time_to(0.9) * 1e3, "time"),
        ],
        [step_figure([large, small, back])],
        because="round holes have no gain at null. Tried: 30 um of underlap (6.6 ms to 90 %, but "
        "72 W of standby power in place of 5), a lead of 1 ms on the solenoid (6.6 ms, but the "
        "large step overshoots by 24 bar), a larger damping orifice (8.8 ms)",
    )  # fmt: skip


def loop_gain() -> Row:
    """Return fig 6.6."""
    parameters = load_parameters()
    whole, simple = (valve_study.loop_gain(parameters, general) for general in (True, False))
    found, simplified = whole.margins()[0], simple.margins()[0]
    both = Family(
        "6.6",
        "loop gain of the valve at its highest",
        whole.frequency,
        np.concatenate([whole.torque, simple.torque]),
        np.concatenate([whole.response, simple.response]),
        True,
    )
    drawn = bode(both, (0.1, 1000.0), (-100.0, 50.0), (-150.0, 0.0),
                 "far from any stability limit; the phase margin would set it",
        names=("with everything (fig 5.2)", "simplified (5.30)"),)  # fmt: skip
    return Row(
        "6.6",
        "Loop gain of the valve at its highest gain",
        [
            Number("phase margin, simplified (5.30)", "deg", None, simplified.phase, "angle"),
            Number("phase margin, with everything (fig 5.2)", "deg", None, found.phase, "angle"),
            Number("gain margin, with everything", "dB", None, float(20 * np.log10(found.gain))),
            Number("crossover", "Hz", None, found.crossover),
        ],
        [drawn],
        words="Far from any stability limit, as the source says. Its highest gain is at "
        f"{whole.torque[0] * BAR:.0f} bar with the spool in the middle.",
    )


ROWS = (front, characteristic, loop_gain, step_responses)
