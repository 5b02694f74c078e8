"""Opening areas from the boost curve: the valve's bridge inverted (source 4.7, 4.8, fig 3.5)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import isotonic_regression

from steering_bringup.errors import BenchError
from steering_core.parameters import ParameterSet
from steering_studies.channels import Channels, require
from steering_studies.identification.estimate import (
    PRESSURE_GAIN,
    TORQUE_GAIN,
    Estimate,
    fit,
    smooth,
)

BIN_NM = 0.2
CUT_OFF_HZ = 10.0
SETTLED_S = 2.0
NEAR_CENTRE_NM = 1.2
GAIN = TORQUE_GAIN + PRESSURE_GAIN
FEWEST_IN_BIN = 20


@dataclass(frozen=True)
class BoostCurve:
    """A measured boost curve by torsion-bar torque, all (n,), SI; deviations are standard ones."""

    torque: np.ndarray
    load_pressure: np.ndarray
    supply_pressure: np.ndarray
    load_pressure_deviation: np.ndarray
    area_1: np.ndarray
    area_2: np.ndarray
    area_1_deviation: np.ndarray
    area_2_deviation: np.ndarray


def opening_areas(channels: Channels, parameters: ParameterSet) -> BoostCurve:
    """Return curve and areas of a slow sweep of the torque with the rack clamped.

    A2 = q_p/(2 C_q) sqrt(rho/(p_s + p_L)), A1 = q_p/(2 C_q) sqrt(rho/(p_s - p_L)). Rising and
    falling torque are averaged bin by bin, so a slow lag falls out. Raises BenchError.
    """
    torque, left, right, supply = (
        smooth(v, CUT_OFF_HZ)[round(SETTLED_S * 1e3) :]
        for v in require(
            channels, "torsion_bar_torque", "left_pressure", "right_pressure", "supply_pressure"
        )
    )
    load = right - left
    edges = np.arange(np.floor(torque.min() / BIN_NM), np.ceil(torque.max() / BIN_NM) + 1) * BIN_NM
    bins = [
        _bin(torque[inside], load[inside], supply[inside])
        for low, high in pairwise(edges)
        if np.count_nonzero(inside := (torque >= low) & (torque < high)) >= FEWEST_IN_BIN
    ]
    if len(bins) < 8:
        raise BenchError("boost curve: the torque covers too little; sweep it to about +-4 N m")
    t, p_l, p_l_s, p_s, p_s_s = np.array(bins).T
    half = parameters["open_centre.pump_flow"] / (2.0 * parameters["oil.flow_coefficient"])
    half *= np.sqrt(parameters["oil.density"])
    if np.any(p_s - np.abs(p_l) <= 0.0):
        raise BenchError("boost curve: the load pressure reaches the supply pressure; check signs")
    sums, gaps = p_s + p_l, p_s - p_l
    scatter = np.hypot(p_l_s, p_s_s)
    a1, a2 = half / np.sqrt(gaps), half / np.sqrt(sums)
    return BoostCurve(
        t, p_l, p_s, p_l_s, a1, a2, 0.5 * a1 * scatter / gaps, 0.5 * a2 * scatter / sums
    )


def _bin(torque: np.ndarray, load: np.ndarray, supply: np.ndarray) -> tuple[float, ...]:
    """Return torque, load and supply pressure in a bin's middle, with standard deviations.

    A line is fitted through each, since both change much within a bin at high torque.
    """
    middle = 0.5 * (torque.min() + torque.max())
    columns = np.stack([np.ones_like(torque), torque - middle, (torque - middle) ** 2], axis=1)
    made: list[float] = [float(middle)]
    for values in (load, supply):
        solution, *_ = np.linalg.lstsq(columns, values, rcond=None)
        rest = values - columns @ solution
        # Filtered at 10 Hz, a sample in 50 ms is independent; at least one way up and one down.
        independent = max(len(values) / 50.0, 2.0)
        made += [float(solution[0]), float(np.std(rest) / np.sqrt(independent))]
    return tuple(made)


def boost_points(curve: BoostCurve) -> tuple[np.ndarray, np.ndarray]:
    """Return (torque, load pressure) that never fall, for a scenario's ``boost_curve`` file."""
    return curve.torque, isotonic_regression(curve.load_pressure).x


def boost_parameters(curve: BoostCurve, parameters: ParameterSet) -> dict[str, Estimate]:
    """Return scale and rate of p_L = scale (exp(rate |T|) - 1), and the opening at centre."""
    known = np.abs(curve.torque) <= parameters["open_centre.boost_linear_above"]
    t, p = curve.torque[known], curve.load_pressure[known]
    weight = 1.0 / np.hypot(curve.load_pressure_deviation[known], 0.002 * np.abs(p) + 200.0)

    def residual(values: np.ndarray) -> np.ndarray:
        scale, rate = values
        return weight * (np.sign(t) * scale * np.expm1(rate * np.abs(t)) - p)

    start = (parameters["open_centre.boost_scale"], parameters["open_centre.boost_rate"])
    scale, rate = fit(
        residual, start, ("Pa", "1/(N m)"), lags=2, source="boost curve test", calibration=GAIN
    )
    near = np.abs(curve.torque) < NEAR_CENTRE_NM
    t = np.concatenate([curve.torque[near], -curve.torque[near]])
    areas = np.concatenate([curve.area_1[near], curve.area_2[near]])

    def opening(values: np.ndarray) -> np.ndarray:
        polynomial = np.polyval([*values[3:0:-1] - 1.0, values[0]], t)
        return polynomial - areas / parameters["open_centre.centre_opening"]

    centre, *_ = fit(
        opening,
        (1.0, 1.0, 1.0, 1.0),
        ("1",) * 4,
        lags=2,
        source="boost curve test",
        calibration=GAIN,
    )
    size = parameters["open_centre.centre_opening"]
    return {
        "open_centre.boost_scale": scale,
        "open_centre.boost_rate": rate,
        "open_centre.centre_opening": Estimate(
            size * centre.value, size * centre.low, size * centre.high, "m2", centre.source
        ),
    }
