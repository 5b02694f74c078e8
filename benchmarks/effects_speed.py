"""What the model of all effects costs against the nominal one.

    steer bench effects_speed
    steer python benchmarks/effects_speed.py --repetitions 50

One second of weaving on-centre in the direct runner, for either valve system, nominal and with all
effects neutral, in turns. The first run compiles what is not in the kernels' cache (set
STEER_KERNEL_CACHE to an empty folder to see it all); its time is among the details.
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.benchmarking.timing import in_turns, ratio, seconds
from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_bringup.schema import Scenario
from steering_plant.effects.models import all_effects

TICKS = 1000
SYSTEMS = ("open_centre", "closed_centre")


def run_time(scenario: Scenario, valve_system: str) -> float:
    """Return how long the direct runner takes for TICKS [s]."""
    cores = build_cores(scenario, load_node_set(valve_system))
    return seconds(lambda: run(cores, TICKS))


def compared(valve_system: str, repetitions: int) -> dict[str, Any]:
    """Return the times of both models in turns [s], and those of their first runs."""
    shipped = load_scenario("on_centre").model_copy(update={"duration": 1e-3 * TICKS})
    full = shipped.model_copy(update={"effects": all_effects(valve_system)})
    calls = {
        "nominal": lambda: run_time(shipped, valve_system),
        "all_effects": lambda: run_time(full, valve_system),
    }
    first = {name: seconds(call) for name, call in calls.items()}
    return {"first": first, **in_turns(calls, repetitions)}


def measure(options: argparse.Namespace) -> Measured:
    """Compare both models for each valve system."""
    times = {v: compared(v, options.repetitions) for v in options.systems}
    values = {f"{v}_ratio": ratio(t["all_effects"], t["nominal"]) for v, t in times.items()}
    return Measured(values, times)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    parser.add_argument("--repetitions", type=int, default=100)
    parser.add_argument("--systems", nargs="+", choices=SYSTEMS, default=list(SYSTEMS))


if __name__ == "__main__":
    sys.exit(main("effects_speed", measure, arguments, __doc__))
