"""What the data sheet's tolerances do to stability and feel: Monte Carlo, in parallel.

Every parameter with a tolerance is drawn from a normal distribution (the tolerance is two standard
deviations) cut at three; the controllers keep the data sheet's values of gear, oil and valve, as
on a real specimen.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from pressure_control.controller import ValveController
from pressure_control.linear_assistance import Manner, closed_centre_assistance
from pressure_control.stability import largest_stable_resonance, operating_points
from steering_core.parameters import ParameterError, ParameterSet
from steering_plant.linear.gear import linear_gear
from steering_plant.linear.open_centre import open_centre_point
from steering_studies.linear.bode import margins
from steering_studies.linear.chattering import growth
from steering_studies.linear.steering_study import small_signal_point
from steering_studies.linear.systems import drive, ripple
from steering_studies.parallel import pool

FIGURES = (
    "restrictor_ratio",
    "gain_margin",
    "phase_margin_deg",
    "largest_resonance",
    "open_centre_damping",
    "torque_difference_Nm",
    "ripple_Pa",
)
"""Figures of merit of a specimen, in order: closed-centre steering loop at 2 N m (margins), largest
stable resonance [rad/s], damping ratio of the open-centre gear's oil mode at 3 N m (negative:
chatters, hands off and without friction), and of a simulated second of steering at 2 Hz: torque
difference to the open-centre gear of the same specimen, and ripple."""

SIMULATED = 9500
"""Ticks of the on-centre sweep that are driven."""


@dataclass(frozen=True)
class Spread:
    """Specimens' parameters and figures: values (n, m) by ``names`` (m,), figures (n, 7)."""

    names: tuple[str, ...]
    values: np.ndarray
    figures: np.ndarray
    nominal: np.ndarray

    def column(self, figure: str) -> np.ndarray:
        """Return one figure of merit of all specimens, (n,)."""
        return self.figures[:, FIGURES.index(figure)]

    def most_influential(self, figure: str, count: int = 5) -> list[tuple[str, float]]:
        """Return the parameters with the largest rank correlation to a figure, and it."""
        from scipy.stats import spearmanr

        target = self.column(figure)
        found = [
            (name, float(spearmanr(self.values[:, k], target).statistic))
            for k, name in enumerate(self.names)
        ]
        known = [(name, r) for name, r in found if np.isfinite(r)]
        return sorted(known, key=lambda item: -abs(item[1]))[:count]


def specimens(parameters: ParameterSet, count: int, seed: int) -> list[dict[str, float]]:
    """Return ``count`` sets of toleranced parameters, the same for the same seed."""
    names = [name for name in parameters if parameters.info(name).tolerance > 0.0]
    rng = np.random.default_rng(seed)
    drawn = np.clip(rng.standard_normal((count, len(names))), -3.0, 3.0)
    tolerance = np.array([parameters.info(name).tolerance for name in names])
    nominal = np.array([parameters[name] for name in names])
    rows = nominal * (1.0 + 0.5 * tolerance * drawn)
    return [dict(zip(names, row.tolist(), strict=True)) for row in rows]


def monte_carlo(
    parameters: ParameterSet,
    count: int = 200,
    seed: int = 1,
    *,
    executor: Executor | None = None,
    on_progress: Callable[[int], None] | None = None,
) -> Spread:
    """Return the figures of ``count`` specimens; executor: any concurrent.futures.Executor.

    By default a pool of processes. Dask's ``Client.get_executor()`` is one for many computers.
    """
    drawn = specimens(parameters, count, seed)
    if executor is None:
        with pool(os.cpu_count() or 1) as made:
            rows = _told(_rows(parameters, drawn, made), on_progress)
    else:
        rows = _told(_rows(parameters, drawn, executor), on_progress)
    names = tuple(drawn[0])
    values = np.array([[specimen[name] for name in names] for specimen in drawn])
    return Spread(names, values, np.array(rows), np.array(figures_of(parameters, {})))


def _rows(
    parameters: ParameterSet, drawn: Sequence[Mapping[str, float]], executor: Executor | None
) -> Iterable[list[float]]:
    """Yield the figures of each specimen; without an executor in this process."""
    if executor is None:
        return (figures_of(parameters, specimen) for specimen in drawn)
    waiting = [executor.submit(figures_of, parameters, specimen) for specimen in drawn]
    return (future.result() for future in waiting)


def _told(
    rows: Iterable[list[float]], on_progress: Callable[[int], None] | None
) -> list[list[float]]:
    found = []
    for row in rows:
        found.append(row)
        if on_progress is not None:
            on_progress(len(found))
    return found


def figures_of(parameters: ParameterSet, specimen: Mapping[str, float]) -> list[float]:
    """Return the FIGURES of a specimen; nan where it has none."""
    actual = parameters.with_values(specimen)
    try:
        point = small_signal_point(actual, 2.0)
    except ParameterError:
        return [float("nan")] * len(FIGURES)
    p = actual.group("valve_controller")
    hertz = np.logspace(0.0, np.log10(490.0), 300)
    manner = Manner(p["resonance"], p["damping"])
    responses = closed_centre_assistance(point, manner, 2.0 * np.pi * hertz)
    loop = margins(hertz, linear_gear(actual).loop_gain(responses))
    largest = largest_stable_resonance(operating_points(actual), 4000.0, p["damping"])
    pole = growth(open_centre_point(actual, 3.0), actual)
    damping = -pole.real / abs(pole)
    ratio = point.chambers[0].valve.restrictor_ratio
    return [ratio, loop.gain, loop.phase, largest, damping, *_simulated(parameters, actual)]


def _simulated(nominal: ParameterSet, actual: ParameterSet) -> tuple[float, float]:
    """Return torque difference [N m] and ripple [Pa]; the controllers know the data sheet only."""
    sides = [ValveController(nominal, side) for side in ("left", "right")]
    opened = drive(actual, "open_centre", ticks=SIMULATED)
    closed = drive(actual, "closed_centre", ticks=SIMULATED, controllers=sides)
    difference = np.abs(closed.driver[:, 0] - opened.driver[:, 0])
    return float(difference.max()), ripple(closed)
