"""What the model of all effects costs: time to compile it, and its speed against the nominal one.

    python benchmarks/effects_speed.py [--repetitions 20] [--json FILE]

One second of weaving on-centre in the direct runner, for either valve system, nominal and with all
effects neutral, in turns; the fastest of the repetitions counts. The first run compiles what is not
in the kernels' cache (set STEER_KERNEL_CACHE to an empty folder to see it all).
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_bringup.schema import Scenario
from steering_plant.effects.models import all_effects

TICKS = 1000


def seconds(scenario: Scenario, valve_system: str) -> float:
    """Return how long the direct runner takes for TICKS [s]."""
    cores = build_cores(scenario, load_node_set(valve_system))
    start = time.perf_counter()
    run(cores, TICKS)
    return time.perf_counter() - start


def compared(valve_system: str, repetitions: int) -> dict[str, float]:
    """Return first-run times [s] and the ratio of the fastest later ones."""
    shipped = load_scenario("on_centre").model_copy(update={"duration": 1e-3 * TICKS})
    full = shipped.model_copy(update={"effects": all_effects(valve_system)})
    firsts, fastest = [], [float("inf"), float("inf")]
    for scenario in (shipped, full):
        start = time.perf_counter()
        seconds(scenario, valve_system)
        firsts.append(time.perf_counter() - start)
    for _ in range(repetitions):
        for index, scenario in enumerate((shipped, full)):
            fastest[index] = min(fastest[index], seconds(scenario, valve_system))
    return {
        "first_nominal_s": firsts[0],
        "first_all_effects_s": firsts[1],
        "nominal_s": fastest[0],
        "all_effects_s": fastest[1],
        "ratio": fastest[1] / fastest[0],
    }


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=20)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    results = {v: compared(v, options.repetitions) for v in ("open_centre", "closed_centre")}
    for valve_system, figures in results.items():
        print(valve_system, *(f"{name} {value:.4g}" for name, value in figures.items()))
    if options.json:
        options.json.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
