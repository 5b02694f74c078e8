"""What measurements and commands must agree on: linear relations and pairs of value and rate."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from steering_core.strict import Number, Strict

Positive = Annotated[Number, Field(gt=0.0)]
Ticks = Annotated[int, Field(strict=True, ge=1, le=1000)]


class Relation(Strict):
    """``|constant + sum of factor x signal| <= tolerance``, or the signals disagree.

    Signals are measured or commanded ones, or ``load_reference``, the load that the commands ask
    for at the measured position: load_force + load_stiffness (rack_position - load_position).
    Commands pass a lag of first order before they are compared, as the rig takes time to follow.
    """

    factors: Annotated[dict[str, Number], Field(min_length=1)]
    constant: Number = 0.0
    tolerance: Positive
    lag: Annotated[Number, Field(ge=0.0)] = Field(0.0, description="s, on the commands")
    ticks: Ticks = Field(3, description="ticks in a row that are a disagreement")


class RatePair(Strict):
    """A value and its rate, measured apart: the value's change over ``window`` must be the rate."""

    value: str
    rate: str
    tolerance: Positive = Field(description="in the unit of the rate")
    window: Ticks = Field(3, description="ticks over which the change is taken")
