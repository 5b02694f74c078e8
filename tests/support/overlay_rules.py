"""What an arbiter of overlays must keep, written a second time from the data sheet's numbers."""

from __future__ import annotations

import numpy as np

from steering_core.parameters import ParameterSet, load_parameters

ASKED, APPLIED, PRESSURE, ACCELERATION, HAND, AUTHORITY, SOURCE = range(7)
BY_TORQUE, BY_PRESSURE, BY_ACCELERATION, BY_RATE, BY_JERK, CHANGING, OVERRIDDEN = range(7, 14)
STALE, REFUSED, REFUSALS, SILENCES, OVERRIDES = range(14, 19)
SMALL = 1e-12


def lateral_gain(ps: ParameterSet, speed: float = 20.0) -> float:
    """Steady lateral acceleration per torque [m/s2 per N m] by solving the car's balances."""
    p = ps.group("vehicle")
    arm, a, b = p["steering_arm"], p["front_axle_distance"], p["rear_axle_distance"]
    c_f, c_r = p["front_cornering_stiffness"], p["rear_cornering_stiffness"]
    trail = p["pneumatic_trail"] + p["mechanical_trail"]
    # unknowns: front and rear force, sideslip, curvature, rack displacement; torque 1 N m
    balance = np.array(
        [
            [1.0, 1.0, 0.0, -p["mass"] * speed**2, 0.0],
            [a, -b, 0.0, 0.0, 0.0],
            [1.0, 0.0, c_f, a * c_f, -c_f / arm],
            [0.0, 1.0, c_r, -b * c_r, 0.0],
            [trail / arm, 0.0, 0.0, 0.0, ps["overlay.centring_stiffness"]],
        ]
    )
    solved = np.linalg.solve(balance, [0.0, 0.0, 0.0, 0.0, ps["mechanics.gear_ratio"]])
    return float(solved[3]) * speed**2


class Rules:
    """Limits [N m] and [N m] a tick at one speed [m/s]."""

    def __init__(self, ps: ParameterSet | None = None, speed: float = 20.0) -> None:
        ps = load_parameters() if ps is None else ps
        p, gain = ps.group("overlay"), lateral_gain(ps, speed)
        per_torque = ps["mechanics.gear_ratio"] / ps["mechanics.piston_area"]
        self.levels = (
            p["maximum_torque"],
            p["maximum_pressure"] / per_torque,
            p["maximum_lateral_acceleration"] / gain,
        )
        self.steps = (p["maximum_rate"] / 1000.0, p["maximum_lateral_jerk"] / gain / 1000.0)
        self.level, self.step, self.gain = min(self.levels), min(self.steps), gain
        self.per_torque = per_torque

    def check(self, out: np.ndarray) -> None:
        """Assert that the rows ``out`` (n, 19) of one run from rest keep every limit."""
        applied = out[:, APPLIED]
        assert np.all(np.isfinite(out[:, APPLIED:]))
        assert np.all(np.abs(applied) <= self.level * (1.0 + SMALL))
        steps = np.diff(applied, prepend=0.0)
        assert np.all(np.abs(steps) <= self.step * (1.0 + SMALL) + SMALL)
        assert np.allclose(out[:, PRESSURE], applied * self.per_torque, rtol=1e-9, atol=1e-6)
        assert np.allclose(out[:, ACCELERATION], applied * self.gain, rtol=1e-9, atol=1e-12)
        assert np.all((out[:, AUTHORITY] >= 0.0) & (out[:, AUTHORITY] <= 1.0))
        assert np.isin(out[:, BY_TORQUE : REFUSED + 1], (0.0, 1.0)).all()
