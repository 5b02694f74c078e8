"""The plant with every effect in one compiled module, and the kernel that replays it."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import ModuleType

import numpy as np

from steering_core.parameters import ParameterSet
from steering_core.specialise import specialised_module
from steering_diagnosis.engine.model import Effects
from steering_diagnosis.steering.kernels import simulate as nominal_kernel
from steering_plant.effects import EFFECTS
from steering_plant.effects.models import plant_model


class FullModel:
    """Every effect of the plant, neutral unless it is given.

    kernel: module with ``simulate``. rests, tolerances: of the states that the effects add.
    """

    def __init__(self, valve_system: str) -> None:
        self.valve_system = valve_system
        self.neutral = {n: e.neutral() for n, e in EFFECTS.items() if e.acts_in == "plant"}
        step, added = plant_model(self.neutral)
        self.rests = added.rests
        self.tolerances = [1e-4] * len(added.rests)
        self.kernel = kernel_for(step)
        self._positions = {}
        for name in self.neutral:
            for parameter in EFFECTS[name].parameters if EFFECTS[name].slots else ():
                self._positions[name, parameter] = len(self._positions)
        self._values = added.values

    def values(self, effects: Effects) -> np.ndarray:
        """Return the vector of the effects' parameters that the kernels take."""
        values = self._values.copy()
        for name, given in effects.items():
            for parameter, value in given.items():
                if (name, parameter) in self._positions:
                    values[self._positions[name, parameter]] = value
        return values

    def changed(self, parameters: ParameterSet, effects: Effects) -> ParameterSet:
        """Return the data sheet as the effects change it."""
        changes = {
            full: effects[name][parameter]
            for name in effects
            for parameter, full in EFFECTS[name].sets.items()
            if parameter in effects[name]
        }
        return parameters.with_values(changes) if changes else parameters


@cache
def full_model(valve_system: str) -> FullModel:
    """Return the model of a valve system; compiled once a process."""
    return FullModel(valve_system)


def kernel_for(step: ModuleType) -> ModuleType:
    """Return the replay's kernel for a plant's step module, effects or not."""
    package = step.__name__.rpartition(".")[0]
    imports: Mapping[str, str] = {"steering_plant.model.": f"{package}."}
    nominal = "steering_plant.model"
    return nominal_kernel if package == nominal else specialised_module(nominal_kernel, imports)
