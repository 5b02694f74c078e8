"""What is refused before any process starts, beside the schema: physics and places on disk."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from steering_bringup.errors import BenchError
from steering_bringup.plans import Plan, valve_loop_delay


def check_physics(plan: Plan) -> None:
    """Refuse parameters that do not fit together and a controller that would be unstable.

    The cores are built and stepped once. So their kernels are compiled and kept on disk before a
    node process needs them within a tick's time-out.
    """
    from steering_bringup.cores import boost_curve, build_cores, step_once
    from steering_bringup.valve_controllers import check_delayed_stability
    from steering_core.compiled import cache_folder

    if not any(cache_folder().rglob("*.nbi")):
        print("compiling the kernels (once after each change of the code) ...", file=sys.stderr)
    step_once(build_cores(plan.scenario, plan.node_set))
    delay = valve_loop_delay(plan.graph) + (plan.rig.rig.delay if plan.rig else 0)
    parameters = plan.scenario.parameter_values()
    check_spool_sensor(plan, parameters["valve_controller.spool_sensor"])
    if delay != parameters["valve_controller.delay_compensation"]:
        # Otherwise the controllers themselves have just been judged as they were built.
        try:
            table = boost_curve(plan.scenario)
            check_delayed_stability(plan.node_set, parameters, table, delay)
        except ValueError as error:
            raise BenchError(str(error)) from None


def check_spool_sensor(plan: Plan, wanted: float) -> None:
    """Refuse spool-position feedback in the graph, where no topic carries the spools."""
    if wanted > 0.0 and plan.manner.runner != "direct":
        raise BenchError(
            "valve_controller.spool_sensor: no topic carries the spools' positions, so it works "
            "in direct runs only: add --direct"
        )


def check_place(bag: Path) -> None:
    """Refuse a bag's folder that exists already or cannot be made."""
    if bag.exists():
        raise BenchError(f"'{bag}' exists already: name another folder, or remove it")
    above = next(folder for folder in bag.absolute().parents if folder.exists())
    if not above.is_dir():
        raise BenchError(f"'{bag}' cannot be made: '{above}' is a file")
    if not os.access(above, os.W_OK | os.X_OK):
        raise BenchError(f"no permission to write into '{above}': name another folder with --out")


def free_folder(root: Path, name: str) -> Path:
    """Return ``root``/``name``-1, -2, ...: the first that does not exist yet."""
    number = 1
    while (folder := root / f"{name}-{number}").exists():
        number += 1
    return folder
