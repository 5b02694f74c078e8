"""A rig's file: its channel table, links, and how it is watched."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from rig_bridge.channels import Channel
from rig_bridge.relations import RatePair, Relation
from rig_bridge.signals import COMMANDED, MEASURED, UNITS
from rig_bridge.transport.settings import Links
from rig_bridge.watching import Watching
from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_core.strict import Number, Strict, check_keys, fault
from steering_core.validation import explain
from steering_core.yaml_lines import read_yaml

LOAD_REFERENCE = "load_reference"


class RigFile(Strict):
    """Everything that the bridge knows about a rig."""

    schema_version: Literal[1] = Field(1, alias="schema", description="version of this schema")
    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
    description: str = ""
    valve_system: Literal["open_centre", "closed_centre", "servo_valve"] = Field(
        "closed_centre", description="node sets of this valve system fit the rig"
    )
    dbc: str | None = Field(None, description="DBC file of the CAN link, beside this file")
    link: Literal["udp", "can"] = Field("udp", description="link that is used unless told other")
    links: Links = Field({}, validate_default=True, description="where the rig is on each link")
    authentication: Literal["key", "none"] = Field(
        "key", description="'none': the rig checks no key, and whoever reaches its link can move it"
    )
    key: str | None = Field(
        None,
        description="file of the key, beside this one (steer rig-key); an emulated rig has one of "
        "its own where none is named",
    )
    emulator: str | None = Field(
        None,
        description="file of the emulated rig, beside this one: a run starts it on this machine; "
        "without it the rig is hardware",
    )
    delay: Annotated[int, Field(strict=True, ge=0, le=20)] = Field(
        0, description="ticks by which a command acts later than in simulation"
    )
    parameters: dict[str, Number] = Field(
        {}, description="data-sheet values for the bench's nodes where the scenario gives none"
    )
    watching: Watching = Field({}, validate_default=True, description="when the rig is made safe")
    channels: dict[str, Channel]
    relations: dict[str, Relation] = Field({}, description="what signals must agree on")
    rates: dict[str, RatePair] = Field({}, description="pairs of value and rate")

    @model_validator(mode="after")
    def _complete(self) -> RigFile:
        check_keys("signal", self.channels, UNITS)
        for name, channel in self.channels.items():
            _check_channel(name, channel)
        if self.authentication == "none" and self.key is not None:
            raise fault("key", "a key is named, but authentication is none: leave one out")
        absent = [name for name in MEASURED if name not in self.channels]
        if absent:
            raise fault("channels", f"channel '{absent[0]}' is missing: the bench needs it")
        _check_sides(self.channels)
        self._check_relations()
        return self

    def _check_relations(self) -> None:
        known = [*self.channels, LOAD_REFERENCE]
        for relation in self.relations.values():
            check_keys("signal", relation.factors, known)
        for pair in self.rates.values():
            for name in (pair.value, pair.rate):
                if name not in self.measured:
                    raise fault("rates", unknown("measured signal", name, self.measured))

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of the measured channels, in the order of the bench's messages."""
        return tuple(MEASURED)

    @property
    def commanded(self) -> tuple[str, ...]:
        """Names of the commanded channels, in the order of the bench's messages."""
        return tuple(name for name in COMMANDED if name in self.channels)

    def settings(self, kind: str) -> Any:
        """Return the settings of a link of this kind: a mapping, of CAN a list of one for a bus."""
        return self.links.model_dump(exclude_none=True)[kind]

    def rows(self, names: Iterable[str]) -> list[Channel]:
        """Return the channels called ``names``."""
        return [self.channels[name] for name in names]


def _check_channel(name: str, channel: Channel) -> None:
    direction = "measured" if name in MEASURED else "commanded"
    if channel.direction != direction:
        raise fault("channels", f"{name}: direction must be {direction}, got {channel.direction}")
    if channel.unit != UNITS[name]:
        raise fault("channels", f"{name}: unit must be {UNITS[name]}, got {channel.unit}")


def _check_sides(channels: dict[str, Channel]) -> None:
    """A rig takes the same kind of command for both chambers, or none for either."""
    kinds = [
        {
            name.removeprefix(side)
            for name in channels
            if name in COMMANDED and name.startswith(side)
        }
        for side in ("left_", "right_")
    ]
    if kinds[0] != kinds[1]:
        raise fault("channels", "left_* and right_* commands must be the same kinds")


def load_rig(path: str | Path) -> RigFile:
    """Read a rig's file; BenchError names file, line and key of what is wrong."""
    document = read_yaml(Path(path))
    data: Any = document.data
    if not isinstance(data, dict):
        raise BenchError(f"{path}: a rig's file is a mapping")
    try:
        return RigFile.model_validate(data)
    except ValidationError as error:
        raise BenchError(explain(error, document)) from None
