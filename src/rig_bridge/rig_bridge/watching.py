"""How closely a rig is watched: after how many ticks of what it is made safe."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from steering_core.strict import Number, Strict

Ticks = Annotated[int, Field(strict=True, ge=1, le=100_000)]
Few = Annotated[int, Field(strict=True, ge=1, le=1000)]
Positive = Annotated[Number, Field(gt=0.0)]


class Watching(Strict):
    """Limits of the watchdogs. With the defaults each fault makes the rig safe within 5 ticks."""

    stale_ticks: Few = Field(4, description="ticks without new measurements that are a fault")
    command_stale_ticks: Few = Field(4, description="ticks without new commands that are a fault")
    confirm_ticks: Few = Field(2, description="bad samples of a channel in a row that are a fault")
    bridged_samples: Few = Field(
        2,
        description="bad samples of a channel that are bridged in the window; one more is a fault",
    )
    bridged_window_ticks: Ticks = Field(1000, description="ticks of that window")
    bad_frames: Positive = Field(3.0, description="repeated, late and lost frames that are a fault")
    bad_frames_drain: Positive = Field(0.2, description="of them forgotten in a tick")
    clock_step_s: Positive = Field(2e-4, description="s, jump of the rig's clock")
    clock_drift: Positive = Field(1e-3, description="rig's clock against this one, relative")
    clock_offset_s: Positive = Field(2e-3, description="s, offset beyond that drift")
    check_ticks: Ticks = Field(200, description="good ticks in a row before pressure is raised")
    check_timeout_ticks: Ticks = Field(5000, description="ticks after which the checks have failed")
    entry_ticks: Ticks = Field(500, description="ticks over which the commands come in")
