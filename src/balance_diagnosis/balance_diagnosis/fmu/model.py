"""An FMU as a model under diagnosis."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from balance_diagnosis.errors import BalanceError
from balance_diagnosis.fmu.binding import SENSOR, Binding, read_binding
from balance_diagnosis.fmu.unit import Unit
from balance_diagnosis.model import Model, Values
from balance_diagnosis.record import Record


class FmuModel(Model):
    """A model from an FMU and the YAML that binds it (docs/own_machine.md has its keys).

    The FMU runs as a part of this process: give only those that you trust. BalanceError names the
    file and what does not fit.
    """

    def __init__(self, fmu: str | Path, binding: str | Path) -> None:
        self.binding = read_binding(Path(binding))
        self.unit = Unit(Path(fmu))
        try:
            _check(self.unit, self.binding)
            super().__init__(
                self._run,
                self.binding.parameters,
                self.binding.causes,
                self.binding.starts,
                tuple(self.binding.outputs),
                self.binding.units,
                self.binding.name,
            )
        except BalanceError as error:
            raise BalanceError(f"'{binding}': {error}") from None

    def _run(self, p: Values, record: Record) -> dict[str, np.ndarray]:
        bound = self.binding
        driven = {
            variable: _meant(record[channel], record.times, self._faults(channel, p))
            for channel, variable in bound.inputs.items()
        }
        made = self.unit.run(
            {variable: p[name] for name, variable in bound.variables.items()},
            record.times,
            driven,
            (*bound.outputs.values(), *bound.states),
            bound.held,
            bound.steps,
        )
        outputs = {
            channel: _shown(made[:, k], record.times, self._faults(channel, p))
            for k, channel in enumerate(bound.outputs)
        }
        count = len(outputs)
        states = {f"state {name}": made[:, count + k] for k, name in enumerate(bound.states)}
        return {**states, **outputs}

    def _faults(self, channel: str, p: Values) -> list[tuple[str, float]]:
        """Return kind and size of what acts on a channel."""
        sensors = self.binding.sensors.items()
        return [(s.kind, p[name]) for name, s in sensors if s.channel == channel]


def _shown(signal: np.ndarray, times: np.ndarray, faults: list[tuple[str, float]]) -> np.ndarray:
    """Return what a sensor with faults shows of a signal: late, then scaled, then shifted."""
    size = {kind: sum(v for k, v in faults if k == kind) for kind in SENSOR}
    if size["delay_of"] != 0.0:
        signal = np.interp(times - size["delay_of"], times, signal)
    return signal * (1.0 + size["gain_of"]) + size["offset_of"]


def _meant(shown: np.ndarray, times: np.ndarray, faults: list[tuple[str, float]]) -> np.ndarray:
    """Return the signal behind what a sensor with faults shows."""
    size = {kind: sum(v for k, v in faults if k == kind) for kind in SENSOR}
    signal = (shown - size["offset_of"]) / (1.0 + size["gain_of"])
    if size["delay_of"] != 0.0:
        signal = np.interp(times + size["delay_of"], times, signal)
    return signal


def _check(unit: Unit, bound: Binding) -> None:
    for variable in bound.variables.values():
        unit.settable(variable)
    for variable in (*bound.inputs.values(), *bound.outputs.values(), *bound.states):
        unit.reference(variable)
    for channel, variable in bound.inputs.items():
        if unit.variables[variable].causality != "input":
            raise BalanceError(f"inputs, '{channel}': variable '{variable}' is no input of the FMU")
