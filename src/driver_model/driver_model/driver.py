"""The driver: follows a manoeuvre's steering wheel angle with a limited torque."""

from __future__ import annotations

import numpy as np

from driver_model.lead_lag import OUTPUTS, STATES, driver_step, sampled_lead_lag
from driver_model.manoeuvres import Manoeuvre
from steering_core.parameters import ParameterSet, record
from steering_core.ticks import TICK_PERIOD, tick_times


class Driver:
    """A lead-lag driver, sampled at 1 kHz.

    par: structured (1,), constants of the kernel. state: [lag_output rad, previous_error rad].
    out: [torque N m, reference_angle rad]. reference: angle [rad] of each tick; hands_on: 1 or 0
    for each tick. Both tables cover ticks 0 to ``ticks``; afterwards their last value is kept.
    """

    def __init__(self, parameters: ParameterSet, manoeuvre: Manoeuvre, ticks: int) -> None:
        values = parameters.group("driver")
        constants = sampled_lead_lag(values["gain"], values["lead"], values["lag"], TICK_PERIOD)
        self.par = record({**constants, "maximum_torque": values["maximum_torque"]})
        times = tick_times(ticks + 1)
        self.reference = np.ascontiguousarray(manoeuvre.angle(times), dtype=np.float64)
        self.hands_on = np.where(manoeuvre.released(times), 0.0, 1.0)
        self.state = np.zeros(len(STATES))
        self.out = np.zeros(len(OUTPUTS))

    def step(self, tick: int, angle: float, speed: float, torque: float) -> np.ndarray:
        """Return ``out`` for the measurements of ``tick``, which must be called one after another.

        angle [rad], speed [rad/s]: steering wheel; torque [N m]: torsion bar.
        """
        driver_step(
            self.par,
            self.reference,
            self.hands_on,
            self.state,
            self.out,
            tick,
            angle,
            speed,
            torque,
        )
        return self.out
