"""What is refused before any process starts, beside the schema: physics and places on disk."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, NamedTuple

from steering_bringup.errors import BenchError
from steering_bringup.outputs import check_folder
from steering_bringup.plans import Plan, valve_loop_delay
from steering_bringup.scenario_files import restore
from steering_bringup.schema import NodeSet, Scenario


class Physics(NamedTuple):
    """What of a plan the physics sees, as plain data: another process may look at it.

    scenario, node_set: as ``model_dump`` gives them; delay: of the valves' loop, ticks.
    """

    scenario: dict[str, Any]
    node_set: dict[str, Any]
    delay: int
    direct: bool

    def models(self) -> tuple[Scenario, NodeSet]:
        """Return scenario and node set again."""
        scenario = restore(Scenario, self.scenario, "scenario")
        return scenario, restore(NodeSet, self.node_set, "node set")


def physics_of(plan: Plan) -> Physics:
    """Return what of a plan the physics sees."""
    scenario, node_set = (
        model.model_dump(mode="json", by_alias=True) for model in (plan.scenario, plan.node_set)
    )
    delay = valve_loop_delay(plan.graph) + (plan.rig.rig.delay if plan.rig else 0)
    return Physics(scenario, node_set, delay, plan.manner.runner == "direct")


def check_physics(physics: Physics) -> None:
    """Refuse parameters that do not fit together and a controller that would be unstable.

    The cores are built, and for a run through the graph stepped once. So their kernels are compiled
    before a node process needs them within a tick's time-out.
    """
    from steering_bringup.cores import boost_curve, build_cores, step_once
    from steering_bringup.valve_controllers import check_delayed_stability
    from steering_core.compiled import cache_folder
    from steering_plant.effects.models import need_slots

    scenario, node_set = physics.models()
    kernels = "with effects " if need_slots(scenario.effects) else ""
    if not any(cache_folder().rglob("steering_plant_model_*/*.nbi" if kernels else "*.nbi")):
        print(
            f"compiling the kernels {kernels}(once after each change of the code) ...",
            file=sys.stderr,
        )
    cores = build_cores(scenario, node_set)
    parameters = scenario.parameter_values()
    if not physics.direct:
        check_spool_sensor(parameters["valve_controller.spool_sensor"])
        step_once(cores)
    if physics.delay != parameters["valve_controller.delay_compensation"]:
        # Otherwise the controllers themselves have just been judged as they were built.
        try:
            check_delayed_stability(node_set, parameters, boost_curve(scenario), physics.delay)
        except ValueError as error:
            raise BenchError(str(error)) from None


def state_of_rest(physics: Physics) -> dict[str, tuple[float, ...]]:
    """Return what each topic is taken to have held before the first tick."""
    from steering_bringup.cores import build_cores, rest_values

    return rest_values(build_cores(*physics.models()))


def check_spool_sensor(wanted: float) -> None:
    """Refuse spool-position feedback in the graph, where no topic carries the spools."""
    if wanted > 0.0:
        raise BenchError(
            "valve_controller.spool_sensor: no topic carries the spools' positions, so it works "
            "in direct runs only: add --direct"
        )


def check_place(bag: Path) -> None:
    """Refuse a bag's folder that exists already or cannot be made."""
    if bag.exists():
        raise BenchError(f"'{bag}' exists already: name another folder, or remove it")
    check_folder(bag)


def free_folder(root: Path, name: str) -> Path:
    """Return ``root``/``name``-1, -2, ...: the first that does not exist yet."""
    number = 1
    while (folder := root / f"{name}-{number}").exists():
        number += 1
    return folder
