"""Bags of the emulated rig: session, guard, link and bench's cores as in a run, time counted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from healthy_rig import EMULATED, PERIOD_NS
from rig_links import both_ends

from rig_bridge.emulator.rig import EmulatedRig
from rig_bridge.emulator.settings import EmulatorSettings, load_settings
from rig_bridge.rig_file import load_rig
from rig_bridge.session import Session
from steering_bringup.bags import BagWriter
from steering_bringup.cores import build_cores, rest_values
from steering_bringup.plans import Manner, Plan, make_plan
from steering_bringup.rig_runs import RigChoice
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_bringup.schema import Scenario
from steering_lockstep.topics import TABLE, wire

NODE_SETS = {"emulated": "closed_centre"}
"""Of each rig; the others are called as their rig is."""

MEASURED = {"/steering/torque": slice(0, 3), "/steering/pressure": slice(3, 6)}
MEASURED["/steering/rack"] = slice(6, 9)


def emulator_of(rig: str, hidden: dict[str, Any]) -> EmulatorSettings:
    """Return the emulator's settings of a shipped rig with what is ``hidden`` laid over."""
    own = load_rig(EMULATED.with_name(f"{rig}.yaml")).emulator
    assert own is not None
    given = load_settings(EMULATED.with_name(own)).model_dump(exclude_unset=True)
    for key, value in hidden.items():
        given[key] = {**given.get(key, {}), **value} if isinstance(value, dict) else value
    return EmulatorSettings.model_validate(given)


def rig_plan(rig: str, scenario: str, duration: float, bag: Path) -> Plan:
    """Return the plan that ``steer run SCENARIO --plant rig --rig RIG`` makes."""
    path = EMULATED.with_name(f"{rig}.yaml")
    choice = RigChoice(path, load_rig(path), "udp")
    given = load_scenario(scenario).model_dump(by_alias=True)
    given |= {"duration": duration}
    given["parameters"] = {**choice.rig.parameters, **given["parameters"]}
    made = Scenario.model_validate(given)
    return make_plan(made, load_node_set(NODE_SETS.get(rig, rig)), Manner(), bag, rig=choice)


class Nodes:
    """The bench's nodes: ``commands`` of a tick's measurements, by topic."""

    def __init__(self, plan: Plan) -> None:
        cores = build_cores(plan.scenario, load_node_set(plan.node_set.name.removesuffix("_rig")))
        self.cores = cores
        self.rest = rest_values(cores)

    def commands(self, tick: int, measured: tuple[float, ...]) -> dict[str, tuple[float, ...]]:
        cores, torque, rack = self.cores, measured[:3], measured[6:]
        load = cores.vehicle.step(tick, *rack).tolist()
        given = {"/driver/torque": cores.driver.step(tick, *torque), "/vehicle/rack_force": load}
        for side, valve in (("left", cores.left), ("right", cores.right)):
            if valve is not None:
                given[f"/valve/{side}/command"] = valve.step(tick, *measured)
        if cores.load_cylinder is not None:
            given["/load_cylinder/command"] = cores.load_cylinder.step(tick, *rack, *load)
        return {topic: tuple(float(v) for v in values) for topic, values in given.items()}


def write_rig_bag(
    bag: Path,
    rig: str = "emulated",
    scenario: str = "on_centre",
    duration: float = 8.0,
    hidden: dict[str, Any] | None = None,
    lost: frozenset[int] = frozenset(),
) -> Path:
    """Run a shipped rig for ``duration`` s and return the bag.

    hidden: what only the emulator's file knows, over the shipped one. lost: ticks of the run whose
    frame does not arrive.
    """
    plan = rig_plan(rig, scenario, duration, bag)
    assert plan.rig is not None
    nodes = Nodes(plan)
    columns = [(topic, part) for topic in nodes.rest for part in wire(topic).fields]
    with both_ends("udp", plan.rig.rig) as (bench_end, rig_end):
        session = Session(plan.rig.rig, columns, lambda: bench_end)
        emulated = EmulatedRig(plan.rig.rig, emulator_of(rig, hidden or {}), rig_end.sequence_bits)
        rows = _run(session, emulated, rig_end, nodes, plan.scenario.ticks, lost)
        report = session.report()
        session.close()
    _write(bag, rows, {**plan.metadata(), "rig_run": report})
    return bag


def _run(
    session: Session,
    rig: EmulatedRig,
    rig_end: Any,
    nodes: Nodes,
    ticks: int,
    lost: frozenset[int],
) -> list[dict[str, tuple[float, ...]]]:
    """Step rig and bench in turn; return what the bag holds of each tick, by topic."""
    now_ns = 0
    session.open()
    session.open_bridge.clock = lambda: now_ns
    asked, periods = dict(nodes.rest), 0
    rows: list[dict[str, tuple[float, ...]]] = []
    while len(rows) < ticks:
        frame = rig.measure()
        gone = session.started and periods in lost
        periods += session.started
        if not gone:
            rig_end.send_frame(frame)
        now_ns += PERIOD_NS
        for measured in session.receive(ticks - len(rows)):
            asked = nodes.commands(len(rows), measured)
            told = {topic: measured[part] for topic, part in MEASURED.items()}
            rows.append({**told, **asked})
        values = [value for topic in nodes.rest for value in asked.get(topic, nodes.rest[topic])]
        session.answer(max(len(rows) - 1, 0), values, 0, None)
        rig.step(rig_end.receive_demands(1.0))
        assert session.failure is None, session.failure
    return rows


def _write(bag: Path, rows: list[dict[str, tuple[float, ...]]], metadata: dict[str, Any]) -> None:
    ticks = np.arange(len(rows), dtype=np.int64)
    types = {topic: TABLE[topic].type_name.replace("/", "/msg/") for topic in rows[0]}
    messages = {}
    for topic in types:
        layout = wire(topic)
        made = layout.from_columns(ticks, np.array([row[topic] for row in rows]))
        messages[topic] = made.view(np.uint8).reshape(len(ticks), layout.size)
    with BagWriter(bag, types, metadata) as writer:
        writer.write_block(ticks * PERIOD_NS, messages)
