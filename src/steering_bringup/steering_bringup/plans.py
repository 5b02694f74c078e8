"""A plan: everything that one run needs, checked before any process starts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from steering_bringup.errors import BenchError
from steering_bringup.graphs import (
    RECORDER,
    build_graph,
    connection_delays,
    connections,
    has_arbiter,
)
from steering_bringup.replays import REPLAY_KIND, Replay, load_replay
from steering_bringup.rig_runs import RIG_KIND, RigChoice, rig_layout, with_rig
from steering_bringup.scenario_files import load_node_set
from steering_bringup.schema import NodeSet, Scenario
from steering_core.naming import unknown
from steering_lockstep.graph import CLOCK, Graph, NodeSpec
from steering_lockstep.names import NAMES, Names, parse_namespace, parse_remaps
from steering_lockstep.settings import RunSettings
from steering_lockstep.topics import OVERLAY

Layout = Literal["one", "each"] | dict[str, str]

ODOMETRY = "/vehicle/odometry"
DIRECT_KINDS = (
    "plant",
    "valve_controller",
    "load_force_controller",
    "driver",
    "vehicle",
    "overlay_arbiter",
    "lane_keeper",
    "recorder",
    REPLAY_KIND,
)


@dataclass(frozen=True)
class Manner:
    """How runs are made, whatever is run. ``timeout``: s of wall clock without a tick.

    ``domain``: ROS_DOMAIN_ID in which nodes outside the run find it; None: a free one.
    ``namespace``, ``remap`` ("OLD:=NEW"): how its topics are called there. ``external``: nodes that
    somebody starts elsewhere; ``wait_for``: topics that somebody outside must listen to before
    tick 0; ``wait`` [s]: for all of these. ``compress``: the bag's chunks.
    """

    runner: Literal["graph", "direct"] = "graph"
    processes: Literal["one", "each"] | None = None
    real_time: bool = False
    timeout: float = 2.0
    domain: int | None = None
    external: tuple[str, ...] = ()
    wait: float = 60.0
    compress: bool = False
    namespace: str = ""
    remap: tuple[str, ...] = ()
    wait_for: tuple[str, ...] = ()


@dataclass(frozen=True)
class Plan:
    """One run of a scenario with one node set.

    ``bag``: where it is recorded, None: nowhere; ``replays``: nodes that a bag stands for;
    ``rig``: what takes the plant's place; ``names``: how its topics are called outside.
    """

    scenario: Scenario
    node_set: NodeSet
    graph: Graph
    manner: Manner
    bag: Path | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)
    replays: Mapping[str, Replay] = field(default_factory=dict)
    rig: RigChoice | None = None
    names: Names = NAMES

    @property
    def layout(self) -> Layout:
        """Which nodes share a process: all of them, none, or as a rig wants it."""
        if self.manner.processes is None and self.rig is not None:
            return rig_layout(self.graph)
        return self.manner.processes or self.node_set.processes

    def metadata(self, domain: int | None = None) -> dict[str, Any]:
        """Return what is needed to repeat the run, for the bag, and in which ROS domain it was."""
        from steering_bringup.bags import run_metadata
        from steering_bringup.node_parameters import changed_values

        return run_metadata(
            scenario=self.scenario.model_dump(mode="json", by_alias=True),
            node_set=self.node_set.model_dump(mode="json", by_alias=True),
            parameters=self.parameters,
            overrides=changed_values(self.scenario),
            effects=self.scenario.effects,
            domain=domain,
            layout=self.layout if self.manner.runner == "graph" else None,
            runner=self.manner.runner,
            real_time=self.manner.real_time,
            rig=None if self.rig is None else self.rig.metadata(),
            replayed={name: replay.origin() for name, replay in self.replays.items()},
            **({"namespace": self.names.namespace} if self.names.namespace else {}),
        )

    def notes(self) -> list[str]:
        """Return what a reader of the results must know about their inputs."""
        effects = self.scenario.effects
        if self.rig is None:
            notes = idle_effects(effects, self.node_set.valve_system)
        else:
            notes = list(self.rig.notes(effects))
        for name, replay in self.replays.items():
            notes += [f"node '{name}' was replayed from '{replay.bag}'", *replay.notes]
        return notes


def idle_effects(effects: Mapping[str, Any], valve_system: str) -> list[str]:
    """Return a note on each effect that is on and does nothing in ``valve_system``."""
    if not effects:
        return []
    from steering_plant.effects import EFFECTS

    return [
        f"effect '{name}' does nothing in {valve_system}: it acts in "
        f"{', '.join(EFFECTS[name].valve_systems)}"
        for name in effects
        if valve_system not in EFFECTS[name].valve_systems
    ]


def make_plan(
    scenario: Scenario,
    node_set: NodeSet,
    manner: Manner,
    bag: Path | None,
    from_bag: Mapping[str, Path] | None = None,
    rig: RigChoice | None = None,
) -> Plan:
    """Return the checked plan of one run; BenchError tells what cannot run.

    ``from_bag``: {node: bag that stands for it}; ``rig``: what takes the plant's place.
    """
    from_bag = from_bag or {}
    direct = manner.runner == "direct"
    if rig is not None:
        node_set = with_rig(node_set, rig)
        _check_one_plant(node_set, from_bag)
    record = bag is not None and not direct
    graph = build_graph(
        node_set, scenario.delays, truth=scenario.truth, record=record, replayed=from_bag
    )
    if direct:
        _check_direct(graph)
    _check_external(graph, manner.external, from_bag)
    parameters = scenario.parameter_values().flat()
    run = RunSettings(graph, scenario.ticks)
    replays = {name: load_replay(graph.node(name), run, path) for name, path in from_bag.items()}
    names = names_of(graph, manner)
    return Plan(scenario, node_set, graph, manner, bag, parameters, replays, rig, names)


def names_of(graph: Graph, manner: Manner) -> Names:
    """Return how a run's topics are called; BenchError for a name that is wrong or no topic's."""
    for name in manner.wait_for:
        if name not in graph.publisher:
            raise BenchError(f"--wait-for {name}: {unknown('topic', name, graph.publisher)}")
    known = [*graph.publisher, OVERLAY] if has_arbiter(graph) else [*graph.publisher]
    return Names(parse_namespace(manner.namespace), parse_remaps(manner.remap, known))


def for_node_set(scenario: Scenario, node_set: NodeSet, all_sets: Iterable[NodeSet]) -> Scenario:
    """Return the scenario without the delays of connections that only other node sets have.

    One that no node set has stays, for the check of the graph to refuse it.
    """
    elsewhere = {c for other in all_sets for c in connections(other)} - set(connections(node_set))
    delays = {c: ticks for c, ticks in scenario.delays.items() if c not in elsewhere}
    return scenario.model_copy(update={"delays": delays})


def node_sets_of(scenario: Scenario) -> list[NodeSet]:
    """Return the node sets that a scenario runs, one after the other."""
    found = [load_node_set(name) for name in scenario.node_set]
    names = [node_set.name for node_set in found]
    if len(set(names)) < len(names):
        raise BenchError(f"scenario '{scenario.name}' names a node set twice: {', '.join(names)}")
    return found


def valve_loop_delay(graph: Graph) -> int:
    """Return the most ticks on the way from a pressure over a controller back to the plant."""
    delays = connection_delays(graph)
    ways = [
        delays.get(f"/steering/pressure->{node.name}", 0)
        + max(delays.get(f"{topic}->{graph.clock.name}", 0) for topic in node.outputs)
        for node in graph.nodes
        if node.kind == "valve_controller"
    ]
    return max(ways, default=0)


def _check_one_plant(node_set: NodeSet, from_bag: Mapping[str, Path]) -> None:
    for name, entry in node_set.nodes.items():
        if name in from_bag and entry.kind == RIG_KIND:
            raise BenchError(f"'{name}' is the rig's place: leave out --from-bag {name}=...")


def _check_external(graph: Graph, names: Iterable[str], from_bag: Collection[str]) -> None:
    known = [node.name for node in graph.nodes]
    for name in names:
        if name not in known:
            raise BenchError(f"--external {name}: {unknown('node', name, known)}")
        why = "reads a bag of this computer" if name in from_bag else None
        why = "is the clock" if name == graph.clock.name else why
        why = "writes its bag on this computer" if name == RECORDER else why
        if why:
            raise BenchError(f"--external {name}: the node stays with the run, as it {why}")


def _check_direct(graph: Graph) -> None:
    for node in graph.nodes:
        if node.kind not in DIRECT_KINDS:
            raise BenchError(
                f"the direct runner has no node of kind '{node.kind}' ('{node.name}'): "
                "leave out --direct to run it in the graph"
            )
        if node.period != 1 and node.kind != "lane_keeper":
            raise BenchError(
                f"the direct runner steps every node on every tick; '{node.name}' has "
                f"period {node.period}: leave out --direct"
            )
        if node.kind == REPLAY_KIND:
            _check_direct_replay(node)
    _check_direct_places(graph)


def _check_direct_places(graph: Graph) -> None:
    """Refuse what the compiled loop has no place for: it knows one node of these kinds each."""
    places = {
        "overlay_arbiter": "arbiter",
        "lane_keeper": "lane_keeper",
        "load_force_controller": "load_cylinder",
    }
    named = [node for node in graph.nodes if node.kind in places]
    for node in named:
        if node.name != places[node.kind]:
            raise BenchError(
                f"the direct runner knows one node of kind '{node.kind}', called "
                f"'{places[node.kind]}', not '{node.name}': leave out --direct"
            )
        if node.kind == "load_force_controller":
            continue
        vehicle = graph.node(graph.publisher[ODOMETRY])
        if vehicle.kind != "vehicle" or (node.kind == "lane_keeper" and node.inputs[ODOMETRY]):
            raise BenchError(
                f"the direct runner gives '{node.name}' the simulated vehicle's motion of the same "
                "tick only: leave out --direct"
            )


def _check_direct_replay(node: NodeSpec) -> None:
    from steering_bringup.direct.runner import MEASURED_TOPICS, RECORDED_TOPICS

    unknown = set(node.outputs) - RECORDED_TOPICS
    lacking = MEASURED_TOPICS - set(node.outputs) if CLOCK in node.outputs else set()
    for topic in sorted(unknown | lacking):
        how = "has no place for" if topic in unknown else "needs"
        raise BenchError(
            f"the direct runner {how} {topic} from the replayed node '{node.name}': leave out "
            "--direct to run it in the graph"
        )
