"""One row of the channel table: how a signal of the bench is a raw number on the rig's link."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from rig_bridge.conversion import raw_of, si_of
from rig_bridge.raw_types import RAW_TYPES, RawType
from steering_core.strict import Number, Strict, fault

Positive = Annotated[Number, Field(gt=0.0)]
Interval = tuple[Number, Number]


class UdpPlace(Strict):
    """Where a channel is in the UDP frame."""

    slot: Annotated[int, Field(strict=True, ge=0, le=63)] = Field(
        description="place in the frame, counted from 0 for each direction"
    )
    raw: RawType = Field("int32", description="type of the number in the frame")


class CanPlace(Strict):
    """Where a channel is on the CAN bus; the DBC file says the rest."""

    message: str = Field(description="name of the message in the DBC file")
    signal: str = Field(description="name of the signal in the DBC file")


class Channel(Strict):
    """A signal of the bench on the rig's link; limits are in the signal's SI unit.

    SI value = sign x (scale x raw + offset). On CAN the raw number is the physical value of the
    DBC file, so that ``scale`` goes from its unit to SI.
    """

    direction: Literal["measured", "commanded"]
    unit: str = Field(description="SI unit of the signal")
    scale: Positive = Field(1.0, description="SI unit per raw count")
    offset: Number = Field(0.0, description="added after the scale, SI unit")
    sign: Literal[-1, 1] = Field(1, description="-1 where the rig counts the other way")
    range: Interval = Field(description="lowest and highest value that may be")
    rate: Positive = Field(description="fastest change, SI unit per second, noise included")
    jump: Positive | None = Field(
        None,
        description="measured: change in a tick that counts as a bad sample where it is taken back "
        "within 8 ticks, SI unit; default: a quarter of what rate allows in a tick",
    )
    bridged_samples: Annotated[int, Field(strict=True, ge=0, le=1000)] | None = Field(
        None, description="measured: in place of watching.bridged_samples"
    )
    plausible: Interval | None = Field(
        None, description="measured: range before pressure is raised"
    )
    frozen_ticks: Annotated[int, Field(strict=True, ge=0)] = Field(
        0, description="measured: as many exact repetitions are a frozen sensor; 0: not watched"
    )
    safe: Number = Field(0.0, description="commanded: value in the safe state")
    udp: UdpPlace | None = None
    can: CanPlace | None = None

    @model_validator(mode="after")
    def _consistent(self) -> Channel:
        _check_interval("range", self.range)
        if self.plausible is not None:
            _check_interval("plausible", self.plausible)
            if not (self.range[0] <= self.plausible[0] and self.plausible[1] <= self.range[1]):
                raise fault("plausible", "plausible must lie within range")
        if self.direction == "measured" and "safe" in self.model_fields_set:
            raise fault("safe", "safe is for commanded channels only")
        if self.direction == "commanded":
            self._check_commanded()
        if self.udp is not None:
            self._check_representable(self.udp.raw)
        return self

    def _check_commanded(self) -> None:
        for name in ("plausible", "frozen_ticks", "jump", "bridged_samples"):
            if name in self.model_fields_set:
                raise fault(name, f"{name} is for measured channels only")
        if not self.range[0] <= self.safe <= self.range[1]:
            raise fault("safe", f"safe ({self.safe:g}) must lie within range {list(self.range)}")

    def _check_representable(self, raw: RawType) -> None:
        lowest, highest = RAW_TYPES[raw].limits
        for value in self.range:
            if not lowest <= raw_of(self, value) <= highest:
                top = max(abs(si_of(self, float(lowest))), abs(si_of(self, float(highest))))
                text = f"range ({value:g}) is beyond what {raw} holds at this scale (about {top:g})"
                raise fault("range", text)


def _check_interval(name: str, interval: Interval) -> None:
    low, high = interval
    if not low < high:
        raise fault(name, f"{name} must be [lowest, highest], got [{low:g}, {high:g}]")
