"""The one schema of scenarios and node sets: what their YAML files may say.

``steer schema`` writes it as JSON Schema, so that an editor checks the files while they are typed.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from annotated_types import MinLen
from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from driver_model.manoeuvres import MANOEUVRES, make_manoeuvre
from steering_bringup.choices import Choice, choice_of
from steering_bringup.named_values import EffectValues, ParameterValues
from steering_core.parameters import ParameterSet, load_parameters
from steering_core.strict import Number, Strict
from steering_lockstep.topics import LOAD_COMMAND
from vehicle_model.loads import LOADS, make_load

LONGEST_RUN_S = 86_400.0

if TYPE_CHECKING:
    ManoeuvreChoice = Choice
    LoadChoice = Choice
else:
    ManoeuvreChoice = choice_of("manoeuvre", MANOEUVRES, make_manoeuvre)
    LoadChoice = choice_of("load", LOADS, make_load)

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Ticks = Annotated[int, Field(strict=True, ge=0, le=1000)]
Period = Annotated[int, Field(strict=True, ge=1, le=1000)]


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


def _beside(name: str, info: ValidationInfo) -> str:
    """Return a file's path as seen from the scenario's folder; a plain name stays one."""
    is_file = Path(name).suffix != ""
    return str(Path((info.context or {}).get("folder", "."), name)) if is_file else name


class BoostCurve(Strict):
    """Points of a measured boost curve; in a scenario also the name of a CSV file with them."""

    torsion_bar_torque_Nm: tuple[Number, ...] = Field(description="rising")  # noqa: N815
    load_pressure_Pa: tuple[Number, ...] = Field(description="never falling")  # noqa: N815

    @model_validator(mode="after")
    def _can_be_made(self) -> BoostCurve:
        from steering_plant.measured_boost_curve import boost_table  # its kernels take a second

        boost_table(self.model_dump())
        return self


def _read_curve(value: Any, info: ValidationInfo) -> Any:
    """Replace a file by its numbers, so that neither a bag nor a node needs the file."""
    from steering_plant.measured_boost_curve import read_boost_curve

    return read_boost_curve(_beside(value, info)) if isinstance(value, str) else value


Curve = Annotated[
    BoostCurve | None,
    BeforeValidator(_read_curve, json_schema_input_type=BoostCurve | str | None),
]


NodeSetNames = Annotated[
    tuple[str, ...],
    Field(min_length=1),
    BeforeValidator(_as_list, json_schema_input_type=str | Annotated[list[str], MinLen(1)]),
]


def _name_is_optional(schema: dict[str, Any]) -> None:
    """A scenario without a name takes its file's."""
    schema["required"].remove("name")


class Scenario(Strict):
    """What is driven, on what, for how long, and with which parameters."""

    model_config = ConfigDict(json_schema_extra=_name_is_optional)

    schema_version: Literal[1] = Field(1, alias="schema", description="version of this schema")
    name: Name
    description: str = Field("", description="one sentence for `steer list`")
    node_set: NodeSetNames = Field(
        ("closed_centre",),
        description="node set by name or file; several are run one after the other and compared",
    )
    duration: Number = Field(20.0, gt=0.0, le=LONGEST_RUN_S, description="s, simulated")
    manoeuvre: ManoeuvreChoice = Field(description="what the driver does")
    load: LoadChoice = Field(
        {"kind": "bicycle"}, validate_default=True, description="what the road puts on the rack"
    )
    parameter_set: str = Field("nominal", description="parameter set by name or YAML file")
    parameters: ParameterValues = Field({}, description="values that differ from the set, SI")
    boost_curve: Curve = Field(
        None, description="measured boost curve in place of the formula: CSV file or points"
    )
    effects: EffectValues = Field({}, description="effects that are on, with their parameters")
    delays: dict[str, Ticks] = Field(
        {}, description="extra ticks on a connection, written TOPIC->NODE"
    )
    record: bool = Field(True, description="record a bag")
    truth: bool = Field(True, description="publish and record the plant's true states")

    @field_validator("duration")
    @classmethod
    def _whole_ticks(cls, duration: float) -> float:
        if abs(round(duration * 1000.0) - duration * 1000.0) > 1e-6 or duration < 0.0005:
            raise ValueError(f"must be a whole number of milliseconds, got {duration * 1e3:g} ms")
        return round(duration * 1000.0) / 1000.0

    @field_validator("node_set")
    @classmethod
    def _node_set_files(cls, names: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        return tuple(_beside(name, info) for name in names)

    @field_validator("parameter_set")
    @classmethod
    def _known_set(cls, name: str, info: ValidationInfo) -> str:
        path = _beside(name, info)
        load_parameters(path)
        return path

    @property
    def ticks(self) -> int:
        """Number of 1 ms ticks."""
        return round(self.duration * 1000.0)

    def parameter_values(self) -> ParameterSet:
        """Return the parameter set with the scenario's values applied."""
        return load_parameters(self.parameter_set).with_values(self.parameters)


class NodeEntry(Strict):
    """One node of a node set."""

    kind: str = Field(description="kind of node, or MODULE:FUNCTION of one's own")
    inputs: dict[str, Ticks] = Field(
        {}, description="topic: delay in ticks, in the order in which the node takes them"
    )
    outputs: tuple[str, ...] = Field((), description="topics that it publishes")
    truth: tuple[str, ...] = Field((), description="topics that it publishes when truth is wanted")
    period: Period = Field(1, description="ticks from one of its steps to the next")
    parameters: dict[str, bool | int | float | str] = Field(
        {}, description="ROS parameters of its own beside the scenario's"
    )


class NodeSet(Strict):
    """Which nodes run and how they are connected."""

    schema_version: Literal[1] = Field(1, alias="schema", description="version of this schema")
    name: Name
    description: str = Field("", description="one sentence for `steer list`")
    valve_system: Literal["open_centre", "closed_centre", "servo_valve"]
    processes: Literal["one", "each"] = Field("one", description="all in one process, or one each")
    nodes: dict[Name, NodeEntry]

    @property
    def load_cylinder(self) -> bool:
        """Whether the rig's load cylinder stands in for the ideal rack force."""
        return any(LOAD_COMMAND in entry.inputs for entry in self.nodes.values())
