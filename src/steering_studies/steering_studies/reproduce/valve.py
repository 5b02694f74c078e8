"""The pressure control valve's design: figures 6.4, 6.5 and 6.7."""

from __future__ import annotations

from pressure_control.valve_design.front import complex_front
from pressure_control.valve_design.problem import DesignProblem
from steering_core.parameters import load_parameters
from steering_studies.pages.valve_design import characteristic_figure, front_figure, step_figure
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
    return Row(
        "6.4",
        "Pareto front of solenoid force against step time",
        [
            Number("least force of the front", "N", 10.0, float(made.forces.min()), "force"),
            Number("largest force of the front", "N", 70.0, float(made.forces.max()), "force"),
            Number("step time of the data sheet's valve", "ms", 5.0, sheet.step_time * 1e3, "time",
                   "at most"),
        ],
        [front_figure([made], found, sheet)],
        because="the source's bounds are not printed: the quick end of the front depends on them",
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
            Number("small step down, final value", "ms", None, back.time_to(0.95) * 1e3, "time"),
        ],
        [step_figure([large, small, back])],
        because="round holes have no gain at null: 30 um of underlap gives 6 ms, at the price of "
        "72 W of standby power",
    )  # fmt: skip


ROWS = (front, characteristic, step_responses)
