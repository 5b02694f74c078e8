"""The emulated rig's sensors: gain, offset, noise, delay; the link's counts are the resolution."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from random import Random

from pydantic import Field

from rig_bridge.signals import MEASURED
from steering_core.strict import Number, Strict, check_keys


class Sensor(Strict):
    """One sensor: reading = gain x value of ``delay`` ticks ago + offset + noise (SI), rounded."""

    gain: Number = 1.0
    offset: Number = 0.0
    noise: Number = Field(0.0, ge=0.0, description="standard deviation")
    resolution: Number = Field(0.0, ge=0.0, description="of the converter; 0: the link's counts")
    delay: int = Field(0, ge=0, le=100, description="ticks")


class Sensors:
    """All sensors of the rig, in the order of ``MEASURED``; the noise is the seed's."""

    def __init__(self, sensors: Mapping[str, Sensor], seed: int) -> None:
        check_keys("sensor", sensors, MEASURED)
        self.rows = [sensors.get(name, Sensor.model_validate({})) for name in MEASURED]
        self.random = Random(seed)
        self.past: deque[Sequence[float]] = deque(maxlen=1 + max(row.delay for row in self.rows))

    def read(self, true: Sequence[float]) -> tuple[float, ...]:
        """Return what the sensors say of the ``true`` values of this tick."""
        self.past.append(tuple(true))
        newest = len(self.past) - 1
        return tuple(
            _rounded(
                row.gain * self.past[max(newest - row.delay, 0)][index]
                + row.offset
                + row.noise * self.random.gauss(0.0, 1.0),
                row.resolution,
            )
            for index, row in enumerate(self.rows)
        )


def _rounded(value: float, resolution: float) -> float:
    return resolution * round(value / resolution) if resolution > 0.0 else value
