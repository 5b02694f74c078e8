"""One specimen: every parameter and sensor a little off, as its tolerance allows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from steering_core.parameters import ParameterSet, record
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.data.channels import MEASURED

GROUPS = ("mechanics", "oil", "open_centre", "closed_centre", "pressure_control_valve")

SENSOR_OF = (0, 0, 1, 2, 3, 4, 5, 5, 6)
"""The sensor of each measured channel; a sensor's speed has its gain, but no offset."""

RATES = (s.SPEED_OUT, s.RACK_SPEED_OUT)

NEUTRAL: Mapping[str, float] = {
    "air": 0.0,
    "air_exponent": 1.3,
    "half_gap": 0.0,
    "tooth": 0.0,
    "teeth": 7.0,
    "bar_cubic": 0.0,
    "bar_hysteresis": 0.0,
    "stop_earlier": 0.0,
    "stop_soft": 0.0,
    "friction_left": 1.0,
    "friction_right": 1.0,
    "breakaway": 0.0,
    "stribeck_speed": 3e-3,
    "bent": 0.0,
    "bent_at": 0.0,
    "bent_width": 1e-3,
    "coulomb_difference": 0.0,
    "viscous_difference": 0.0,
    "more_damping": 0.0,
    "damping_growth": 1.0,
    "discharge": 1.0,
    "warming": 0.0,
    "magnet_lag": 0.0,
    "magnet_width": 0.0,
    "piston_leak": 0.0,
    "piston_drag": 0.0,
    "left_leak": 0.0,
    "right_leak": 0.0,
    "hose": 0.0,
    "hose_time": 0.05,
    "left_more_volume": 0.0,
    "boost_offset": 0.0,
    "lap_torque": 0.0,
    "ripple": 0.0,
    "ripple_frequency": 150.0,
    "ripple_phase": 0.0,
    "droop": 0.0,
    "droop_time": 0.02,
    "stiction": 0.0,
    "stiction_displacement": 2e-6,
    "load_friction": 0.0,
    "bending_mass": 0.0,
    "bending_rate": 150.0,
    "cogging": 0.0,
    "cogs": 24.0,
    "crosstalk": 0.0,
    "relaxation": 0.0,
}
"""Constants of the phenomena that the data sheet does not have, where they are absent."""


@dataclass(frozen=True, repr=False)
class Specimen:
    """What is really on the bench.

    sheet: full names to values. extras: of NEUTRAL. sensors: (9, 2), gain and offset. delays:
    (9, 2), age of each measured value [s] and the number of lags that make it.
    """

    sheet: Mapping[str, float]
    extras: Mapping[str, float]
    sensors: np.ndarray
    delays: np.ndarray

    def par(self, closed: bool, clamped: bool, pressed: bool = False) -> np.ndarray:
        """Return the record, shape (1,), that the kernels read."""
        values = {
            n.partition(".")[2]: v for n, v in self.sheet.items() if n.split(".")[0] in GROUPS
        }
        flags = {"closed": float(closed), "clamped": float(clamped), "pressed": float(pressed)}
        return record(values | dict(self.extras) | flags)


def nominal_specimen(nominal: ParameterSet) -> Specimen:
    """Return a specimen exactly as its data sheet says, with ideal sensors."""
    sensors = np.column_stack([np.ones(s.CHANNELS), np.zeros(s.CHANNELS)])
    return Specimen(nominal.flat(), NEUTRAL, sensors, np.zeros((s.CHANNELS, 2)))


def draw_specimen(nominal: ParameterSet, random: np.random.Generator) -> Specimen:
    """Return a specimen within tolerance: normal, cut off at two standard deviations."""
    sheet = {}
    for name, value in nominal.flat().items():
        tolerance = nominal.info(name).tolerance if name.split(".")[0] in GROUPS else 0.0
        sheet[name] = value * (1.0 + tolerance * _share(random)) if tolerance else value
    gains, offsets = np.ones(s.CHANNELS), np.zeros(s.CHANNELS)
    of_sensor = [_share(random) for _ in range(max(SENSOR_OF) + 1)]
    for row, channel in enumerate(MEASURED.values()):
        gains[row] += channel.gain * of_sensor[SENSOR_OF[row]]
        offsets[row] = channel.offset * _share(random)
    return Specimen(sheet, NEUTRAL, np.column_stack([gains, offsets]), np.zeros((s.CHANNELS, 2)))


def _share(random: np.random.Generator) -> float:
    """Return a normal number with standard deviation 1/2, between -1 and 1."""
    while True:
        value = 0.5 * float(random.standard_normal())
        if abs(value) <= 1.0:
            return value
