"""How far an experiment sets two causes apart, in standard deviations of the sensors' noise."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.errors import BenchError
from steering_bringup.scenario_files import load_node_set
from steering_bringup.schema import Scenario
from steering_core.parameters import load_parameters
from steering_diagnosis.data.channels import MEASURED
from steering_plant.plant import PlantError

Effects = Mapping[str, Mapping[str, float]]

GROUPS = ("mechanics", "oil", "open_centre", "closed_centre", "pressure_control_valve")
EVERY = 4
"""Ticks between two samples that are compared: 250 Hz."""

NOISE: dict[str, float] = {
    "steering_wheel_angle": 2e-4,
    "steering_wheel_speed": 1e-2,
    "torsion_bar_torque": 5e-3,
    "left_pressure": 3e3,
    "right_pressure": 3e3,
    "supply_pressure": 3e3,
    "rack_position": 5e-6,
    "rack_speed": 5e-4,
    "rack_force": 5.0,
}
"""Standard deviation of a usual sensor, SI, where the report does not know it."""


def separations(
    document: Mapping[str, Any], causes: Sequence[Effects], noise: Mapping[str, float]
) -> list[float]:
    """Return how far each pair of ``causes`` is apart, in a list in the order of the pairs.

    document: scenario as data. noise: channel to standard deviation. A cause's change of all
    channels is judged after the best multiple of the other's and of every nominal parameter's
    within tolerance is taken off. Raises BenchError where the experiment cannot be simulated.
    """
    rest = responses(document, {}, {}, noise)
    changes = [responses(document, cause, {}, noise) - rest for cause in causes]
    nuisances = np.stack(
        [responses(document, {}, change, noise) - rest for change in _tolerances(document)], axis=1
    )
    return [
        apart(changes[i], changes[j], nuisances)
        for i in range(len(causes))
        for j in range(i + 1, len(causes))
    ]


def visibility(document: Mapping[str, Any], cause: Effects, noise: Mapping[str, float]) -> float:
    """Return how far a cause's change stands above the noise (root mean square)."""
    change = responses(document, cause, {}, noise) - responses(document, {}, {}, noise)
    return float(np.sqrt(np.mean(change**2)))


def apart(first: np.ndarray, second: np.ndarray, nuisances: np.ndarray) -> float:
    """Return the root mean square of what tells two changes apart, both (n,) in noise units.

    The smaller of both ways round. nuisances: (n, k), change by half a tolerance each, which is
    one standard deviation of a specimen: they are taken off by ridge regression with that prior.
    """
    return min(_left(first, second, nuisances), _left(second, first, nuisances))


def _left(change: np.ndarray, other: np.ndarray, nuisances: np.ndarray) -> float:
    # The other cause may have any size: its prior is as wide as the change is large.
    columns = np.concatenate([100.0 * other[:, None], nuisances], axis=1)
    ridge = np.eye(columns.shape[1])
    size = np.linalg.solve(columns.T @ columns + ridge, columns.T @ change)
    rest = change - columns @ size
    return float(np.sqrt(np.mean(rest**2)))


def responses(
    document: Mapping[str, Any],
    effects: Effects,
    parameters: Mapping[str, float],
    noise: Mapping[str, float],
) -> np.ndarray:
    """Return all measured channels in units of their noise, one after the other, (n,)."""
    changed = {**document.get("parameters", {}), **parameters}
    given = {**document, "parameters": changed, "effects": effects, "truth": False}
    scenario = Scenario.model_validate(given)
    cores = build_cores(scenario, load_node_set(scenario.node_set[0]))
    try:
        trace = run(cores, scenario.ticks)
    except PlantError as error:
        raise BenchError(f"experiment '{scenario.name}' cannot be simulated: {error}") from None
    columns = np.concatenate([trace.torque, trace.pressure, trace.rack], axis=1)[::EVERY]
    scales = np.array([noise.get(name, NOISE[name]) for name in MEASURED])
    return (columns / scales).T.ravel()


def _tolerances(document: Mapping[str, Any]) -> Iterator[dict[str, float]]:
    """Yield each toleranced parameter, changed by half of its tolerance."""
    sheet = load_parameters(document.get("parameter_set", "nominal"))
    given = document.get("parameters", {})
    for name in sheet:
        info = sheet.info(name)
        if info.tolerance and name.split(".", 1)[0] in GROUPS:
            value = given.get(name, info.value)
            yield {name: value * (1.0 + 0.5 * info.tolerance)}
