"""A record: measured channels on one uniform grid of 1 ms, as the diagnosis takes them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np

from steering_core.parameters import ParameterSet, load_parameters

PERIOD_S = 1e-3
RATE_HZ = 1.0 / PERIOD_S

READ_AS = "read as: "
"""Begins the note that says how a file was read."""


@dataclass(frozen=True, repr=False)
class Record:
    """Channels of one experiment.

    channels: name (data.channels) to (n,) float64, SI; NaN where there is no measurement. A channel
    that was not measured at all is not there. nominal: the parameters that the nominal model is
    taken with, before any effect (a bag's own settings of controller and vehicle included).
    boost_table: of a measured boost curve, None for the formula. notes: what reading and aligning
    found or changed, a sentence each. excluded: (n,) bool, samples not to be judged (saturated,
    bridged gaps); None: all count. sha256: of the file or bag. vehicle_load: kind of the simulated
    load on the rack (vehicle_model.loads), "" where that is not known. units: name to the unit in
    which a channel was read, where that is not SI. rates: name to the rate [Hz] at which a channel
    was sampled, where that is below the grid's.
    """

    valve_system: Literal["open_centre", "closed_centre", "servo_valve"]
    channels: Mapping[str, np.ndarray]
    nominal: ParameterSet = field(default_factory=load_parameters)
    boost_table: np.ndarray | None = None
    excluded: np.ndarray | None = None
    notes: tuple[str, ...] = ()
    name: str = "record"
    path: Path | None = None
    sha256: str = ""
    vehicle_load: str = ""
    units: Mapping[str, str] = field(default_factory=dict)
    rates: Mapping[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(next(iter(self.channels.values()))) if self.channels else 0

    def __contains__(self, channel: str) -> bool:
        return channel in self.channels

    def __getitem__(self, channel: str) -> np.ndarray:
        return self.channels[channel]

    def rate(self, channel: str) -> float:
        """Return the rate [Hz] at which a channel tells anything: at most the grid's."""
        return self.rates.get(channel, RATE_HZ)

    @property
    def time(self) -> np.ndarray:
        """Seconds from the record's beginning, (n,)."""
        return np.arange(len(self)) * PERIOD_S
