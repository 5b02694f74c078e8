"""``steer run``: a scenario from the first tick to the page."""

from __future__ import annotations

import argparse
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from steering_bringup.cli.ros_options import add_domain, add_names, settle_domain
from steering_bringup.errors import BenchError
from steering_bringup.interrupts import nothing_to_lose
from steering_bringup.outputs import write_json

if TYPE_CHECKING:
    from steering_bringup.outcome import Outcome
    from steering_bringup.plans import Manner, Plan
    from steering_bringup.rig_runs import RigChoice
    from steering_bringup.schema import Scenario

EXAMPLES = """examples:
  steer run                                    the main job: on-centre, both valve systems, compared
  steer run dry_park
  steer run step --node-set closed_centre --set mechanics.rack_mass=30
  steer run --processes each --real-time --duration 5
  steer run --direct --set manoeuvre.amplitude_deg=20
  steer run step --from-bag driver=results/step-1/closed_centre
  steer run on_centre --node-set closed_centre --plant rig --rig-link can
  steer run lane_keeping --external lane_keeper --domain 42
  steer run weave --real-time --domain 42 --namespace car1 --wait-for /steering/torque
  steer run --delay '/valve/left/command->plant=1' --delay '/valve/right/command->plant=1' \\
            --set valve_controller.resonance=400"""

OF_THE_GRAPH = ("real_time", "processes", "domain", "namespace", "remap", "wait_for")
"""Options that mean nothing without ROS."""


def what_runs(parser: argparse.ArgumentParser) -> None:
    """Declare the scenario and what changes it."""
    add = parser.add_argument
    add("scenario", nargs="?", default="on_centre", help="name (see 'steer list') or YAML file")
    what = parser.add_argument_group("what runs")
    add = what.add_argument
    add("--node-set", metavar="NAME", action="append", help="node set by name or file; repeatable")
    add("--manoeuvre", metavar="KIND", help="another manoeuvre with its defaults")
    add("--load", metavar="KIND", help="another load with its defaults")
    add("--duration", metavar="S", help="simulated time in s")
    add("--set", metavar="NAME=VALUE", action="append", default=[], help="a value; repeatable")
    add("--set-file", metavar="FILE", action="append", default=[], help="values from a YAML file")
    add(
        "--delay",
        metavar="TOPIC->NODE=TICKS",
        action="append",
        default=[],
        help="extra delay of a connection; repeatable",
    )
    add(
        "--from-bag",
        metavar="NODE=BAG",
        action="append",
        default=[],
        help="what a node published in a bag, in its place; repeatable",
    )


def a_rig(parser: argparse.ArgumentParser) -> None:
    """Declare what puts a rig in the plant's place."""
    rig = parser.add_argument_group("a rig in the plant's place")
    add = rig.add_argument
    add("--plant", choices=("simulated", "rig"), default="simulated", help="default: simulated")
    add("--rig", metavar="RIG", help="rig by name or file (default: emulated)")
    add("--rig-link", choices=("udp", "can"), help="link to it (default: as its file says)")
    add(
        "--rig-fault",
        choices=("end", "hold"),
        help="in the safe state end the run (default), or go on until /rig/reset is called",
    )


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    what_runs(parser)
    how = parser.add_argument_group("how it runs")
    add = how.add_argument
    add("--direct", action="store_true", help="without ROS: the same cores in one fast loop")
    add("--processes", choices=("one", "each"), help="all nodes in one process, or one each")
    add("--real-time", action="store_true", help="pace the ticks to the wall clock")
    add_domain(how)
    add_names(how)
    add(
        "--wait-for",
        metavar="TOPIC",
        action="append",
        default=[],
        help="tick 0 comes when somebody outside listens to this topic; repeatable",
    )
    add("--timeout", metavar="S", type=float, default=2.0, help="s without a tick (default: 2)")
    add(
        "--external",
        metavar="NODE",
        action="append",
        default=[],
        help="a node that is started elsewhere, with 'steer node'; repeatable",
    )
    add(
        "--wait",
        metavar="S",
        type=float,
        default=60.0,
        help="s for who is waited for (default: 60)",
    )
    a_rig(parser)
    out = parser.add_argument_group("what is kept")
    add = out.add_argument
    add("--out", metavar="DIR", type=Path, help="folder (default: results/SCENARIO-1, -2, ...)")
    add("--record", metavar="BAG", type=Path, help="folder of the bag, where one node set runs")
    add("--no-record", action="store_true", help="record nothing")
    add("--compress", choices=("zstd",), help="compress the bags (default: not)")
    add("--truth", action=argparse.BooleanOptionalAction, help="true states of the plant too")
    add("--json", metavar="FILE", type=Path, help="write the summary for machines")


def execute(options: argparse.Namespace) -> int:
    """Plan, run, compare, and tell."""
    with ExitStack() as stack:
        with nothing_to_lose():
            zygote = None
            if not options.direct:
                from steering_bringup.forerunner import forerunner

                zygote = stack.enter_context(forerunner())
            from steering_bringup.session import run_all

            scenario = scenario_of(options)
            folder = _folder(options, scenario.name)
            plans = plans_of(options, scenario, folder)
            _prepare_external(plans, folder)
        outcomes = run_all(plans, _tell, zygote, _announce)
    report: dict[str, Any] = {"runs": [outcome.as_json() for outcome in outcomes]}
    if len(outcomes) == 2 and all(outcome.ok and outcome.bag for outcome in outcomes):
        report["comparison"] = _compare(outcomes, folder / "comparison.html")
    pages = _overlay_pages(plans, outcomes, folder)
    report |= {"pages": [str(page) for page in pages]} if pages else {}
    if options.json:
        write_json(options.json, report)
    return _status(outcomes[-1])


def scenario_of(options: argparse.Namespace) -> Scenario:
    """Return the scenario with all options applied, checked."""
    from steering_bringup.overrides import merge, set_delay, set_file, set_value
    from steering_bringup.scenario_files import check_scenario, find, open_scenario

    document = open_scenario(options.scenario)
    if (choice := rig_of(options)) is not None:
        given = document.data.get("parameters") or {}
        missing = {n: v for n, v in choice.rig.parameters.items() if n not in given}
        merge(document, missing, f"rig '{choice.rig.name}'")
    for path in options.set_file:
        set_file(document, path)
    for name in ("manoeuvre", "load"):
        if getattr(options, name):
            merge(document, {f"{name}.kind": getattr(options, name)}, f"--{name}")
    for text in options.set:
        set_value(document, text)
    for text in options.delay:
        set_delay(document, text)
    for name in ("duration", "node_set", "truth"):
        if getattr(options, name) is not None:
            merge(document, {name: getattr(options, name)}, f"--{name.replace('_', '-')}")
    if options.no_record:
        merge(document, {"record": False}, "--no-record")
    return check_scenario(document, find("scenario", options.scenario).parent)


def rig_of(options: argparse.Namespace) -> RigChoice | None:
    """Return the rig that takes the plant's place, checked; None where the plant is simulated."""
    if options.plant != "rig":
        for name in ("rig", "rig_link", "rig_fault"):
            if getattr(options, name):
                raise BenchError(f"--{name.replace('_', '-')} is for --plant rig")
        return None
    from steering_bringup.rig_runs import choose_rig

    if options.direct:
        raise BenchError("a rig runs in wall time, through the ROS graph: leave out --direct")
    return choose_rig(options.rig or "emulated", options.rig_link, options.rig_fault or "end")


def _folder(options: argparse.Namespace, name: str) -> Path:
    from steering_bringup.checks import free_folder

    return options.out or free_folder(Path("results"), name)


def plans_of(options: argparse.Namespace, scenario: Scenario, folder: Path) -> list[Plan]:
    """Return the checked plan of each node set, with its bag in ``folder``."""
    from steering_bringup.plans import for_node_set, make_plan, node_sets_of

    node_sets = node_sets_of(scenario)
    if options.record and (len(node_sets) > 1 or options.no_record):
        reason = "--no-record" if options.no_record else f"{len(node_sets)} node sets"
        raise BenchError(f"--record names one bag, but there is {reason}: use --out DIR")
    rig = rig_of(options)
    label = "" if rig is None else "_rig"
    bags = {
        node_set.name: (options.record or folder / (node_set.name + label))
        if scenario.record
        else None
        for node_set in node_sets
    }
    manner, from_bag = _manner(options), _from_bag(options)
    return [
        make_plan(for_node_set(scenario, n, node_sets), n, manner, bags[n.name], from_bag, rig)
        for n in node_sets
    ]


def _from_bag(options: argparse.Namespace) -> dict[str, Path]:
    from steering_bringup.replays import parse_replay

    pairs = [parse_replay(text) for text in options.from_bag]
    twice = {node for node, _ in pairs if [n for n, _ in pairs].count(node) > 1}
    if twice:
        raise BenchError(f"--from-bag names node '{min(twice)}' twice: one bag stands for it")
    return dict(pairs)


def _manner(options: argparse.Namespace) -> Manner:
    from steering_bringup.plans import Manner

    if not options.timeout > 0.0:
        raise BenchError(f"--timeout must be greater than 0 s, got {options.timeout:g}")
    for name in OF_THE_GRAPH:
        if options.direct and getattr(options, name):
            raise BenchError(
                "--direct runs in one loop as fast as it goes, without ROS: leave out "
                f"--{name.replace('_', '-')}"
            )
    runner: Any = "direct" if options.direct else "graph"
    domain = None if options.direct else settle_domain(options)
    if options.external and (options.direct or domain is None):
        raise BenchError("--external needs the graph and --domain N, in which the node is found")
    if not options.wait > 0.0:
        raise BenchError(f"--wait must be greater than 0 s, got {options.wait:g}")
    external = tuple(dict.fromkeys(options.external))
    return Manner(
        runner,
        options.processes,
        options.real_time,
        options.timeout,
        domain,
        external,
        options.wait,
        options.compress is not None,
        options.namespace,
        tuple(options.remap),
        tuple(options.wait_for),
    )


def _prepare_external(plans: list[Plan], folder: Path) -> None:
    """Write the file for the nodes that are started elsewhere, and say how to start them."""
    for plan in plans:
        if not plan.manner.external:
            continue
        if len(plans) > 1:
            raise BenchError("--external runs one node set: choose it with --node-set")
        from steering_bringup.graph_run import write_external

        path = folder / "nodes.json"
        write_external(plan, path)
        for name in plan.manner.external:
            print(f"start: ROS_DOMAIN_ID={plan.manner.domain} ./steer node {path} {name}")
        print(f"waiting for them for {plan.manner.wait:g} s", flush=True)


def _announce(where: str) -> None:
    print(where, flush=True)


def _tell(outcome: Outcome) -> None:
    from steering_bringup.summary import lines

    print("\n".join(lines(outcome)), flush=True)


def _compare(outcomes: list[Outcome], page: Path) -> dict[str, object]:
    from steering_bringup.session import compare_bags

    first, second = (outcome.bag for outcome in outcomes)
    assert first is not None
    assert second is not None
    text, numbers = compare_bags(first, second, page)
    print("\n" + "\n".join(text))
    print(f"page: {page}")
    return numbers


def _overlay_pages(plans: list[Plan], outcomes: list[Outcome], folder: Path) -> list[Path]:
    """Draw a page of each recorded run with an arbiter of torque overlays."""
    from steering_bringup.graphs import has_arbiter

    pages = []
    for plan, outcome in zip(plans, outcomes, strict=False):
        if outcome.bag is not None and outcome.ticks > 1 and has_arbiter(plan.graph):
            from steering_bringup.bags import read_bag
            from steering_bringup.overlay_page import write_overlay_page

            many = len(plans) > 1
            page = folder / (f"overlay_{plan.node_set.name}.html" if many else "overlay.html")
            write_overlay_page(read_bag(outcome.bag), plan.scenario, plan.node_set, page)
            print(f"page: {page}")
            pages.append(page)
    return pages


def _status(outcome: Outcome) -> int:
    from steering_bringup.cli import FAILED, INTERRUPTED

    kept = f"; the bag so far is {outcome.bag}" if outcome.bag else ""
    if outcome.stopped_by:
        where = f"after tick {outcome.ticks} of {outcome.planned}"
        print(f"steer run: stopped by {outcome.stopped_by} {where}{kept}", file=sys.stderr)
        return INTERRUPTED if outcome.stopped_by == "SIGINT" else 143
    if outcome.error:
        print(f"steer run: {outcome.error}{kept}", file=sys.stderr)
        return FAILED
    return 0 if outcome.ok else FAILED
