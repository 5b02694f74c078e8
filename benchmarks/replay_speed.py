"""Speed of the replay that the diagnosis calls some hundred times: 15 s of a record.

Run with the bench's environment: python benchmarks/replay_speed.py [SECONDS]
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from bench_records import NOISE, bench_record

from steering_diagnosis.steering.replay import SteeringReplay

CALLS = 20


def best(call) -> float:  # type: ignore[no-untyped-def]
    """Return the shortest of some calls [s]."""
    times = []
    for index in range(CALLS):
        started = time.perf_counter()
        call(index)
        times.append(time.perf_counter() - started)
    return min(times)


def main(seconds: float) -> None:
    """Print the time of a call with a new simulation, and of one that needs none."""
    for system in ("open_centre", "closed_centre"):
        replay = SteeringReplay(bench_record(system, duration=seconds, noise=NOISE))
        replay.residuals({}, {})
        simulated = best(lambda k, r=replay: r.residuals({"mechanics.rack_mass": 24.1 + k}, {}))
        sensors = best(lambda k, r=replay: r.residuals({"torque_sensor.offset": 0.01 * k}, {}))
        print(
            f"{system}: {seconds:g} s in {simulated * 1e3:.0f} ms "
            f"({seconds / simulated:.0f} times real time); sensors alone {sensors * 1e3:.1f} ms; "
            f"{len(replay.outputs)} outputs, {len(replay.nuisances)} nuisances, "
            f"{len(replay.hypotheses)} hypotheses"
        )


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 15.0)
