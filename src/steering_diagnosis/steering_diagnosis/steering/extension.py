"""From what was found to ``extension.yaml``: effects and refitted parameters of the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from steering_diagnosis.engine.model import Effects, Nuisance
from steering_diagnosis.steering.drive import SENSORS

MOVED = 0.1
"""Share of the tolerance from which a refitted parameter is written."""

_SENSOR_GROUPS = frozenset(SENSORS.values())


def extension(
    effects: Effects, nuisances: Mapping[str, float], known: Sequence[Nuisance]
) -> dict[str, Any]:
    """Return the part of a scenario that extends the model: ``steer run --set-file``.

    effects: causes with their parameters. nuisances: absolute values of the extended model; those
    of the plant that moved are written, those of sensors belong to the record's own sensors.
    Empty where nothing was named.
    """
    parameters = {
        n.name: float(nuisances[n.name])
        for n in known
        if n.name in nuisances
        and n.name.split(".")[0] not in _SENSOR_GROUPS
        and abs(nuisances[n.name] - n.nominal) > MOVED * n.tolerance
    }
    found: dict[str, Any] = {}
    if effects:
        found["effects"] = {name: dict(given) for name, given in effects.items()}
    if parameters:
        found["parameters"] = parameters
    return found
