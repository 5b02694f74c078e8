"""From a bag's metadata back to the plan of the run that it records."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from steering_bringup.errors import BenchError
from steering_bringup.plans import Manner, Plan, make_plan
from steering_bringup.scenario_files import restore
from steering_bringup.schema import NodeSet, Scenario

if TYPE_CHECKING:
    from steering_bringup.bags import Trace


def plan_from_bag(trace: Trace, bag: Path, *, runner: Any = None, processes: Any = None) -> Plan:
    """Return the plan of a recorded run, to be recorded to ``bag``.

    ``runner`` and ``processes`` replace the recorded ones. BenchError where the metadata lack what
    a run needs.
    """
    run = trace.run
    for key in ("scenario", "node_set", "parameters"):
        if not run.get(key):
            raise BenchError(f"bag '{trace.path}' does not say with which {key} it was made")
    if run.get("rig"):
        raise BenchError(
            f"bag '{trace.path}' is a run with a rig, which no two times does the same: replay its "
            "measurements with steer run --from-bag plant=BAG --no-truth"
        )
    # The values themselves count, not the name of a set that may have changed since.
    data = {**run["scenario"], "parameter_set": "nominal", "parameters": run["parameters"]}
    scenario = restore(Scenario, data, f"bag '{trace.path}', scenario")
    node_set = restore(NodeSet, run["node_set"], f"bag '{trace.path}', node set")
    manner = Manner(runner or run["runner"], processes or run.get("layout"))
    # A replayed node's messages are in the bag itself, whatever has become of the one before.
    from_bag = dict.fromkeys(run.get("replayed") or {}, Path(trace.path or "."))
    return make_plan(scenario, node_set, manner, bag, from_bag)


def differing_surroundings(trace: Trace) -> Iterator[str]:
    """Yield what is another than at the recording: bits may differ then, and nobody is to blame."""
    from steering_bringup.bags.run_metadata import libraries, machine, software

    for what, now in (("software", software()), ("libraries", libraries()), ("machine", machine())):
        before = trace.run.get(what) or {}
        for key in sorted(set(now) & set(before)):
            if now[key] != before[key]:
                yield f"{what} {key} was {before[key]}, is {now[key]}"
