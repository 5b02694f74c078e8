"""What an effect is: a phenomenon that the nominal model leaves out, or a sensor's defect."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from steering_core.naming import unknown

Kernel = Callable[..., Any]


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect, in SI units.

    neutral: the value at which the model is exactly the nominal one. low, high: bounds. typical:
    what is taken where the effect is switched on without a value.
    """

    meaning: str
    unit: str
    neutral: float
    low: float
    high: float
    typical: float

    def checked(self, name: str, value: Any) -> float:
        """Return ``value`` as a float; ValueError where it is no number or out of bounds."""
        number = float(value)
        if not math.isfinite(number) or not self.low <= number <= self.high:
            raise ValueError(
                f"{name} must be between {self.low:g} and {self.high:g} {self.unit}, got {value}"
            )
        return number


@dataclass(frozen=True)
class State:
    """A state that an effect adds.

    rest: its value at rest, a number or the name of what it equals there (a state of the plant,
    ``left_solenoid`` or ``right_solenoid``). rate: kernel of the time derivative (plant), or of
    the value at the next tick (vehicle). Arguments as for slots.
    """

    rest: float | str
    rate: Kernel


@dataclass(frozen=True)
class Effect:
    """One effect; each is a file of this folder and is registered in its ``__init__``.

    summary: what it is, in a few words. sees: what one sees of it on the rig. equation, source.
    balance: the balance that it acts on. excitation: what a record needs to show it.
    acts_in: the model that it changes. slots: kernels by the name of the slot (model/slots.py of
    that model); an argument is the slot's own, a parameter or a state of the effect, or a state
    of the plant, by name. sets: data sheet parameters that take the effect's parameter instead.
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
    acts_in: Literal["plant", "vehicle"] = "plant"
    slots: Mapping[str, Kernel] = field(default_factory=dict)
    states: Mapping[str, State] = field(default_factory=dict)
    sets: Mapping[str, str] = field(default_factory=dict)
    adds_energy: bool = False

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
        return {
            name: f"{p.typical:g} {p.unit} ({p.low:g} to {p.high:g}, neutral {p.neutral:g}): "
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
