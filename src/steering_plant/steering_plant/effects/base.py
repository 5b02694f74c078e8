"""What an effect is: a phenomenon that the nominal model leaves out, or a sensor's defect."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from steering_core.naming import unknown

Kernel = Callable[..., Any]

VALVE_SYSTEMS = ("open_centre", "closed_centre", "servo_valve")

BALANCES = (
    "column torque",
    "torsion bar",
    "rack force",
    "left chamber continuity",
    "right chamber continuity",
    "valve flow",
    "valve spool",
    "supply",
    "load",
    "angle sensor",
    "torque sensor",
    "pressure sensors",
    "rack position sensor",
    "rack force sensor",
)
"""The balances and sensors at which the error of a simulation can enter."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect, in SI units.

    neutral: the value at which the model is exactly the nominal one. low, high: bounds. typical:
    what is taken where the effect is switched on without a value. shape: it has no meaning at the
    neutral values (a gap, a delay, a Stribeck speed), so a fit must scan it. valve_systems: in
    which it acts, where the effect acts in more; empty means in all of the effect's.
    """

    meaning: str
    unit: str
    neutral: float
    low: float
    high: float
    typical: float
    shape: bool = False
    valve_systems: tuple[str, ...] = ()

    def checked(self, name: str, value: Any) -> float:
        """Return ``value`` as a float; ValueError where it is no number or out of bounds."""
        number = float(value)
        if not math.isfinite(number) or not self.low <= number <= self.high:
            raise ValueError(
                f"{name} must be between {self.low:g} and {self.high:g} {self.unit}, got {value}"
            )
        return number


@dataclass(frozen=True)
class SheetChange:
    """Data sheet parameters that a parameter of an effect multiplies, or is added to.

    factor: whether it multiplies. sign: of what is added.
    """

    names: tuple[str, ...]
    factor: bool
    sign: float = 1.0

    @property
    def neutral(self) -> float:
        """The value that changes nothing."""
        return 1.0 if self.factor else 0.0

    def applied(self, value: float, parameter: float) -> float:
        """Return the data sheet's ``value`` as the effect's ``parameter`` changes it."""
        return value * parameter if self.factor else value + self.sign * parameter


def factor_of(*names: str) -> SheetChange:
    """Return the change that multiplies data sheet parameters (``mechanics.rack_friction``)."""
    return SheetChange(names, factor=True)


def added_to(*names: str) -> SheetChange:
    """Return the change that is added to data sheet parameters."""
    return SheetChange(names, factor=False)


def taken_from(*names: str) -> SheetChange:
    """Return the change that is subtracted from data sheet parameters."""
    return SheetChange(names, factor=False, sign=-1.0)


@dataclass(frozen=True)
class State:
    """A state that an effect adds.

    rest: its value at rest, a number or the name of what it equals there (a state of the plant,
    ``left_solenoid`` or ``right_solenoid``). rate: kernel of the time derivative (plant), or of
    the value at the next tick (vehicle). sampled: in the plant, ``rate`` is the value for the
    coming tick instead, from that tick's commands. Arguments as for slots. tolerance: local error
    allowed in one inner step, in the state's unit.
    """

    rest: float | str
    rate: Kernel
    sampled: bool = False
    tolerance: float = 1e-4


@dataclass(frozen=True)
class Effect:
    """One effect; each is a file of this folder and is registered in its ``__init__``.

    summary: what it is, in a few words. sees: what one sees of it on the rig. equation, source.
    balance: the balance that it acts on, one of BALANCES; also: others that it acts on.
    excitation: what a record needs to show it. separating: the experiment that tells it from what
    looks alike. valve_systems: in which it acts. competes: data sheet parameters whose change
    looks much the same, beside those that the effect itself changes (``sheet_parameters``).
    acts_in: the model that it changes. slots: kernels by the name of the slot (model/slots.py of
    that model); an argument is the slot's own, a parameter or a state of the effect, or a state
    of the plant, by name. sets: changes of the data sheet, by the effect's parameter.
    adds_energy: whether it is a source of energy.
    """

    name: str
    summary: str
    sees: str
    equation: str
    source: str
    balance: str
    excitation: str
    parameters: Mapping[str, Parameter]
    separating: str = ""
    also: tuple[str, ...] = ()
    valve_systems: tuple[str, ...] = VALVE_SYSTEMS
    competes: tuple[str, ...] = ()
    acts_in: Literal["plant", "vehicle"] = "plant"
    slots: Mapping[str, Kernel] = field(default_factory=dict)
    states: Mapping[str, State] = field(default_factory=dict)
    sets: Mapping[str, SheetChange] = field(default_factory=dict)
    adds_energy: bool = False

    def acting(self, valve_system: str) -> dict[str, Parameter]:
        """Return the parameters that change something in ``valve_system``."""
        systems = self.valve_systems
        return {
            name: p
            for name, p in self.parameters.items()
            if valve_system in systems and valve_system in (p.valve_systems or systems)
        }

    @property
    def balances(self) -> tuple[str, ...]:
        """All balances that it acts on."""
        return (self.balance, *self.also)

    @property
    def sheet_parameters(self) -> tuple[str, ...]:
        """Data sheet parameters that it changes; a wrong value of one is the same thing."""
        return tuple(name for change in self.sets.values() for name in change.names)

    def values(self, given: Mapping[str, Any]) -> dict[str, float]:
        """Return all parameters, in order: ``given`` ones checked, the others typical.

        Raises ValueError for an unknown name or a value out of bounds.
        """
        for name in given:
            if name not in self.parameters:
                what = f"parameter of {self.name}"
                raise ValueError(unknown(what, name, self.parameters))
        return {
            name: p.checked(f"{self.name}.{name}", given.get(name, p.typical))
            for name, p in self.parameters.items()
        }

    def neutral(self) -> dict[str, float]:
        """Return the parameters that leave the model exactly nominal."""
        return {name: p.neutral for name, p in self.parameters.items()}

    @property
    def info(self) -> dict[str, str]:
        """Return a line about each parameter."""
        units = {name: "" if p.unit == "1" else f" {p.unit}" for name, p in self.parameters.items()}
        return {
            name: f"{p.typical:g}{units[name]} ({p.low:g} to {p.high:g}, neutral {p.neutral:g}): "
            f"{p.meaning}"
            for name, p in self.parameters.items()
        }


def description(name: str, effects: Mapping[str, Effect]) -> str:
    """Return what the ROS parameter ``effects.EFFECT.PARAMETER`` is, its unit at the end."""
    _, effect, parameter = name.split(".") if name.count(".") == 2 else ("", "", "")
    found = effects[effect].parameters.get(parameter) if effect in effects else None
    return "" if found is None else f"{effects[effect].summary}: {found.meaning} [{found.unit}]"


def arguments(kernel: Kernel) -> list[str]:
    """Return the names of a compiled kernel's arguments."""
    return list(inspect.signature(getattr(kernel, "py_func", kernel)).parameters)
