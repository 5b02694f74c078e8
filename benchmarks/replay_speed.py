"""Speed of the replay that the diagnosis calls some hundred times, against the run itself.

    steer bench replay_speed
    steer python benchmarks/replay_speed.py --seconds 60

The run is the direct runner's of the same length, with all effects as the replay has them. "Sensors
alone" is a call in which nothing has to be integrated anew. All in turns.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from bench_records import NOISE, bench_record

from steering_bringup.benchmarking.program import Measured, main
from steering_bringup.benchmarking.timing import in_turns, ratio, seconds
from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import run
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_diagnosis.steering.replay import SteeringReplay
from steering_plant.effects.models import all_effects

SYSTEMS = ("open_centre", "closed_centre")


def the_run(system: str, duration: float) -> Callable[[], float]:
    """Return what measures a direct run of ``duration`` [s] with all effects, in seconds."""
    update = {"duration": duration, "effects": all_effects(system)}
    scenario = load_scenario("on_centre").model_copy(update=update)

    def call() -> float:
        cores = build_cores(scenario, load_node_set(system))
        return seconds(lambda: run(cores, scenario.ticks))

    return call


def compared(system: str, duration: float, calls: int) -> dict[str, list[float]]:
    """Return the times of a run, of a replay, and of one that integrates nothing [s]."""
    replay = SteeringReplay(bench_record(system, duration=duration, noise=NOISE))
    replay.residuals({}, {})
    count = itertools.count(1)

    def simulated() -> float:
        mass = 24.1 + next(count)
        return seconds(lambda: replay.residuals({"mechanics.rack_mass": mass}, {}))

    def sensors() -> float:
        offset = 0.01 * next(count)
        return seconds(lambda: replay.residuals({"torque_sensor.offset": offset}, {}))

    turns = {"run": the_run(system, duration), "replay": simulated, "sensors": sensors}
    for call in turns.values():
        call()
    return in_turns(turns, calls)


def measure(options: argparse.Namespace) -> Measured:
    """Compare for each valve system."""
    values: dict[str, float | None] = {}
    details = {}
    for system in options.systems:
        times = details[system] = compared(system, options.seconds, options.calls)
        values[f"{system}_to_run"] = ratio(times["replay"], times["run"])
        values[f"{system}_sensors"] = ratio(times["replay"], times["sensors"])
        values[f"{system}_real_time"] = options.seconds / statistics.median(times["replay"])
    return Measured(values, details)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the size."""
    parser.add_argument("--seconds", type=float, default=15.0, help="of the record (default: 15)")
    parser.add_argument("--calls", type=int, default=20)
    parser.add_argument("--systems", nargs="+", choices=SYSTEMS, default=list(SYSTEMS))


if __name__ == "__main__":
    sys.exit(main("replay_speed", measure, arguments, __doc__))
