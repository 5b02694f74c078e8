"""The mapping file: which channel of a foreign file is which channel of the bench."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from steering_bringup.named_values import ParameterValues
from steering_core.errors import BenchError
from steering_core.strict import Number, Strict, check_keys, fault
from steering_core.validation import explain
from steering_core.yaml_lines import Document, read_yaml
from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.units import FACTORS, spelled

LONGEST_DELAY_S = 1.0
"""s; no sensor or filter lags by more."""

Text = Annotated[str, Field(min_length=1)]


def several(value: Any) -> Any:
    """Let a single value stand for a list of one."""
    return value if isinstance(value, list | tuple) else (value,)


def separator(value: Any) -> Any:
    """Let through one sign that is no part of a number or a name, or the name of one."""
    if value == "\\t":
        return "tab"
    if value in ("semicolon", "tab", "comma", "pipe", "space", "none"):
        return value
    if not isinstance(value, str) or len(value) != 1 or value.isalnum() or value in "\"'.+-\n\r":
        raise ValueError(f"must be one sign, or 'tab', 'space' or 'none', got '{value}'")
    return value


def encoding(value: Any) -> Any:
    """Let through what Python knows as an encoding of texts."""
    try:
        "x".encode(value)
    except (LookupError, TypeError):
        raise ValueError(f"'{value}' is no known encoding, such as 'cp1252'") from None
    return value


def sign(value: Any) -> Any:
    """Let through 1 and -1."""
    if isinstance(value, bool) or value not in (1, -1, "1", "-1", "+1"):
        raise ValueError(f"must be 1 or -1, got {value!r}")
    return int(value)


def no_value(value: Any) -> Any:
    """Let through a text or a number that stands for no value."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        shown = str(value).lower() if isinstance(value, bool) else repr(value)
        raise ValueError(f"must be texts or numbers, got {shown}: put a text in quotes")
    return value


Separator = Annotated[str, BeforeValidator(separator)]
Encoding = Annotated[str, BeforeValidator(encoding)]
Sign = Annotated[int, BeforeValidator(sign)]
NoValue = Annotated[str | float, BeforeValidator(no_value)]


class MappedChannel(Strict):
    """One channel: value = sign x (scale x raw x unit + offset), in SI."""

    source: Text = Field(alias="from", description="name of the channel or column in the file")
    unit: str = Field("", description="unit of the numbers, after `scale`; none: the file's own")
    sign: Sign = Field(1, description="1, or -1 where the file's positive is the bench's negative")
    scale: Number = Field(1.0, description="factor from the file's numbers to `unit`")
    offset: Number = Field(0.0, description="added after `scale`, in `unit`")
    delay: Number = Field(0.0, description="s by which the file's channel is known to lag")
    group: Annotated[int, Field(ge=0)] | str | None = Field(
        None, description="MDF group by number, name or comment, where a name occurs twice"
    )
    origin: str = Field("", alias="source", description="name or path of an MDF channel's source")
    index: int | None = Field(None, ge=0, description="index of an MDF channel within its group")
    column: int | None = Field(
        None, ge=1, description="CSV column, from 1, where a name occurs twice"
    )
    clock: str = Field("", description="name of the clock, where it is not the file's first")
    time: str = Field("", description="MATLAB: vector with the time of this channel alone")

    @model_validator(mode="before")
    @classmethod
    def _is_named(cls, data: Any) -> Any:
        if isinstance(data, dict) and "column" in data and "from" not in data:
            raise fault(
                "column",
                "column alone is not enough: it says which one, where the name `from` occurs twice",
            )
        return data

    @model_validator(mode="after")
    def _is_physical(self) -> MappedChannel:
        if self.scale == 0.0:
            raise fault("scale", "scale must not be 0: all values would be the same")
        if abs(self.delay) > LONGEST_DELAY_S:
            raise fault(
                "delay",
                f"delay must be within {LONGEST_DELAY_S:g} s, got {self.delay:g}: it is in "
                "seconds; for a logger with a clock of its own use 'clocks'",
            )
        return self

    @property
    def place(self) -> tuple[Any, ...]:
        """What says where in the file it is."""
        return (self.source, self.group, self.origin, self.index, self.column)


class Clock(Strict):
    """A second clock: its times are t = offset + (1 + drift) x the file's time."""

    offset: Number = Field(0.0, description="s")
    drift: Number = Field(0.0, gt=-0.01, lt=0.01, description="relative, 1e-6 is one ppm")
    estimate: bool = Field(False, description="from channels that move together")


class Mapping(Strict):
    """Where the bench's channels are in a CSV, MATLAB or MDF4 file."""

    schema_version: Literal[1] = Field(1, alias="schema", description="version of this schema")
    valve_system: Literal["open_centre", "closed_centre", "servo_valve"]
    time: str = Field("", description="column or variable with the time; MDF4 has its own")
    time_unit: str = Field("s", description="unit of the time, where the file says none")
    time_format: str | None = Field(
        None, description="CSV: dates or times of day, as '%d.%m.%Y %H:%M:%S.%f' (strptime)"
    )
    time_column: int | None = Field(
        None, ge=1, description="CSV: column of the time, from 1, where its name occurs twice"
    )
    rate: Number | None = Field(None, gt=0.0, description="Hz, where the file has no time")
    parameter_set: str = Field("nominal", description="parameter set by name or YAML file")
    parameters: ParameterValues = Field({}, description="values that differ from the set, SI")
    boost_curve: str | None = Field(None, description="CSV file of the measured boost curve")
    database: str | None = Field(None, description="DBC file that decodes an MDF's CAN frames")
    clocks: dict[str, Clock] = Field({}, description="further clocks, by name")
    channels: dict[str, MappedChannel]
    separator: Separator | None = Field(
        None, description="CSV: what separates cells, one sign or 'tab', 'space', 'none'"
    )
    decimal: Literal[".", ","] | None = Field(None, description="CSV: decimal sign")
    thousands: Literal[".", ",", "'", " "] | None = Field(
        None, description="CSV: sign between thousands"
    )
    encoding: Encoding | None = Field(None, description="CSV: as 'utf-8', 'cp1252', 'utf-16'")
    header_line: int | None = Field(None, ge=1, description="CSV: line of the names, from 1")
    units_line: int | None = Field(None, ge=1, description="CSV: line of the units, from 1")
    comment: Annotated[tuple[Text, ...], BeforeValidator(several)] = Field(
        (), description="CSV: what begins a comment line; without it: #, % and //"
    )
    missing: Annotated[tuple[NoValue, ...], BeforeValidator(several)] = Field(
        (), description="numbers that stand for no value, as -999; in CSV texts as well"
    )

    @model_validator(mode="after")
    def _fits(self) -> Mapping:
        check_keys("channel", self.channels, CHANNELS, ("channels",))
        if spelled(self.time_unit) not in FACTORS["s"]:
            raise fault("time_unit", f"time_unit must be one of {', '.join(FACTORS['s'])}")
        for name, channel in self.channels.items():
            self._check(name, channel)
        if self.decimal is not None and self.decimal == self.thousands:
            raise fault("thousands", "decimal and thousands must differ")
        if not self.channels:
            raise fault("channels", "channels: at least one is needed")
        return self

    def _check(self, name: str, channel: MappedChannel) -> None:
        known = FACTORS[CHANNELS[name].unit]
        where = ("channels", name)
        if channel.unit and spelled(channel.unit) not in known:
            raise fault(where, f"{name}: unit '{channel.unit}' must be one of {', '.join(known)}")
        if channel.clock and channel.clock not in self.clocks:
            raise fault(where, f"{name}: clock '{channel.clock}' is not among 'clocks'")
        if channel.place == (self.time, None, "", None, self.time_column):
            raise fault(where, f"{name}: '{channel.source}' is the time already")


def load_mapping(path: str | Path) -> tuple[Mapping, Document]:
    """Read a mapping file; BenchError names file, line and key of what is wrong."""
    document = read_yaml(Path(path))
    data: Any = document.data
    if not isinstance(data, dict):
        raise BenchError(f"{path}: a mapping file has keys such as 'channels'")
    try:
        mapping = Mapping.model_validate(data)
    except ValidationError as error:
        raise BenchError(explain(error, document)) from None
    if mapping.database:
        beside = str(Path(path).parent / mapping.database)
        mapping = mapping.model_copy(update={"database": beside})
    return mapping, document
