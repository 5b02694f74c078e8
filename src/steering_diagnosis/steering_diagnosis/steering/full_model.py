"""The plant with every effect in one compiled module, and the kernel that replays it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import ModuleType

import numpy as np

from steering_core.parameters import ParameterSet
from steering_core.specialise import specialised_module
from steering_diagnosis.engine.model import Effects
from steering_diagnosis.steering.kernels import simulate as nominal_kernel
from steering_plant.effects import EFFECTS
from steering_plant.effects.models import all_effects, plant_model

NOMINAL = "steering_plant.model"


class FullModel:
    """Every effect of the plant, neutral unless it is given.

    kernel: module with ``simulate``. rests, tolerances: of the states that the effects add.
    """

    def __init__(self, valve_system: str) -> None:
        self.valve_system = valve_system
        step, self._added = plant_model(all_effects(valve_system), valve_system)
        self.rests = self._added.rests
        self.tolerances = self._added.tolerances
        self.kernel = kernel_for(step)

    def values(self, effects: Effects) -> np.ndarray:
        """Return the vector of the effects' parameters that the kernels take."""
        values = self._added.values.copy()
        for name, given in effects.items():
            for parameter, value in given.items():
                position = self._added.positions.get((name, parameter))
                if position is not None:
                    values[position] = value
        return values

    def changed(self, parameters: ParameterSet, effects: Effects) -> ParameterSet:
        """Return the data sheet as the effects change it."""
        if not effects:
            return parameters
        chosen = {name: EFFECTS[name].neutral() | dict(given) for name, given in effects.items()}
        return replace(self._added, chosen=chosen).changed(parameters, self.valve_system)


@cache
def full_model(valve_system: str) -> FullModel:
    """Return the model of a valve system; compiled once a process."""
    return FullModel(valve_system)


def kernel_for(step: ModuleType) -> ModuleType:
    """Return the replay's kernel for a plant's step module, effects or not."""
    package = step.__name__.rpartition(".")[0]
    if package == NOMINAL:
        return nominal_kernel
    return specialised_module(nominal_kernel, {f"{NOMINAL}.": f"{package}."})
