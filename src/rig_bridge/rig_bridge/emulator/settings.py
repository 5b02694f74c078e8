"""The emulated rig's own file: what only the rig knows."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

from pydantic import Field, ValidationError, field_validator

from rig_bridge.emulator.hand import Hand
from rig_bridge.emulator.sensors import Sensor
from steering_core.errors import BenchError
from steering_core.strict import Number, Strict
from steering_core.validation import explain
from steering_core.yaml_lines import read_yaml
from steering_plant.effects import EFFECTS
from steering_plant.effects.compose import chosen


class EmulatorSettings(Strict):
    """Plant, effects, wheel, sensors, clock and watchdog of the emulated rig."""

    valve_system: Literal["open_centre", "closed_centre", "servo_valve"] = "closed_centre"
    load_cylinder: bool = Field(False, description="with servo valve and load cell, else ideal")
    parameter_set: str = "nominal"
    parameters: dict[str, Number] = Field({}, description="where the rig differs from the set")
    effects: dict[str, dict[str, Number]] = Field({}, description="what the plant does besides")
    hand: Hand | None = Field(None, description="angle on the wheel, in place of the torque motor")
    sensors: dict[str, Sensor] = Field({}, description="ideal where not given")
    seed: int = Field(1, ge=0)
    clock_drift: Number = Field(
        0.0,
        gt=-0.5,
        lt=100.0,
        description="relative; positive is slow: 3 is a quarter of real time",
    )
    clock_start_ns: int = Field(0, ge=0)
    command_delay: int = Field(0, ge=0, le=20, description="periods")
    stale_ticks: int = Field(5, ge=1, description="periods without commands until it is safe")

    @field_validator("effects")
    @classmethod
    def _known(cls, effects: dict[str, dict[str, float]]) -> dict[str, dict[str, float]]:
        for name in effects:
            if name in EFFECTS and EFFECTS[name].acts_in != "plant":
                raise ValueError(f"{name} acts in the {EFFECTS[name].acts_in}, not on a rig")
        chosen(effects, "plant")
        return effects


def load_settings(path: str | Path) -> EmulatorSettings:
    """Read an emulator's file; BenchError names file, line and key of what is wrong."""
    document = read_yaml(Path(path))
    data: Any = document.data or {}
    try:
        return EmulatorSettings.model_validate(data)
    except ValidationError as error:
        raise BenchError(explain(error, document)) from None
