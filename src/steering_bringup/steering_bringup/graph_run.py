"""A run through the real ROS graph."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from steering_bringup.checks import physics_of, state_of_rest
from steering_bringup.errors import BenchError
from steering_bringup.graphs import RECORDER, connection_delays
from steering_bringup.node_parameters import node_parameters
from steering_bringup.outcome import Outcome, peaks_of
from steering_bringup.plans import Plan
from steering_bringup.process_age import process_age
from steering_bringup.progress import Bar
from steering_lockstep.domain import DomainClaim, DomainError, asked_domain, claim_domain
from steering_lockstep.graph_file import write_run
from steering_lockstep.middleware import RANGE, is_alone
from steering_lockstep.settings import RunSettings

if TYPE_CHECKING:
    from steering_bringup.rig_runs import Connection
    from steering_lockstep.outcome import Progress, RunResult
    from steering_lockstep.zygote import Zygote

STATE_OF_REST = "steering_bringup.checks:state_of_rest"


def run_through_graph(
    plan: Plan, zygote: Zygote | None = None, on_start: Callable[[str], None] | None = None
) -> Outcome:
    """Run the plan over DDS and return what it did; a failed run tells why in ``error``.

    ``on_start``: is told what runs and where it is seen, before anything else. Raises BenchError
    where the ROS domain is taken.
    """
    from steering_lockstep.processes import START_TIMEOUT, placement, run_graph

    scenario = plan.scenario
    age = process_age()
    with ExitStack() as stack:
        claim = stack.enter_context(_domain(plan))
        if on_start is not None:
            on_start(_where(plan, claim.number))
        bar = stack.enter_context(Bar(plan.node_set.name, scenario.duration))
        bar.update(0, 0.0, "starting")
        connection = None
        if plan.rig is not None:
            connection = stack.enter_context(plan.rig.connected())

        def show(progress: Progress) -> None:
            bar.update(progress.tick, progress.real_time_factor, progress.phase)

        result = run_graph(
            plan.graph,
            scenario.ticks,
            parameters=_parameters(plan, connection, claim.number),
            rest=_rest(plan, zygote),
            layout=plan.layout,
            real_time=plan.manner.real_time,
            timeout=plan.manner.timeout,
            on_progress=show,
            zygote=zygote,
            domain=claim,
            names=plan.names,
            wait_for=plan.manner.wait_for,
            urgent=plan.rig is not None,
            external=plan.manner.external,
            start_timeout=plan.manner.wait if _awaits(plan) else START_TIMEOUT,
        )
        notes = [] if connection is None else connection.notes()
    outcome = Outcome(
        scenario.name,
        plan.node_set.name,
        scenario.ticks,
        ticks=result.ticks,
        wall_time=result.wall_time,
        start_time=result.first_tick_time,
        since_command=age + result.first_tick_time,
        processes=len(placement(plan.graph, plan.layout, plan.manner.external)),
        lost=dict(result.lost),
        error=_error(result),
        stopped_by=result.stopped_by,
        latency=result.latency,
        rig=result.node_results.get(plan.graph.clock.name, {}).get("rig"),
        notes=notes,
    )
    return _with_bag(plan, outcome)


def _awaits(plan: Plan) -> bool:
    """Return whether somebody outside is waited for."""
    return bool(plan.manner.external or plan.manner.wait_for)


@contextmanager
def _domain(plan: Plan) -> Iterator[DomainClaim]:
    """Claim the run's ROS domain: the one asked for, or a free one."""
    try:
        asked = plan.manner.domain
        asked = asked_domain(os.environ) if asked is None else asked
        claim = claim_domain(asked, namespace=plan.names.namespace)
    except DomainError as error:
        raise BenchError(str(error)) from None
    try:
        yield claim
    finally:
        claim.release()


def _where(plan: Plan, domain: int) -> str:
    """Return what runs and where it is seen, as one line."""
    how_far = os.environ.get(RANGE, "a profile of one's own")
    seen = "on this computer" if is_alone(os.environ) else f"beyond this computer ({how_far})"
    space = f", namespace {plan.names.namespace}" if plan.names.namespace else ""
    return (
        f"{plan.scenario.name} / {plan.node_set.name}: ROS_DOMAIN_ID={domain}{space}, seen {seen}"
    )


def write_external(plan: Plan, path: Path) -> None:
    """Write all that the plan's external nodes must know; BenchError naming the path."""
    parameters = {name: _parameters(plan, None)[name] for name in plan.manner.external}
    _write_file(plan, parameters, path)


def write_graph_file(plan: Plan, path: Path, connection: Connection | None = None) -> None:
    """Write all that every node of the plan must know; BenchError naming the path.

    ``connection``: to an emulated rig that the caller starts; a rig of its own has its file.
    """
    if plan.rig is not None and connection is None:
        connection = plan.rig.own_connection()
    domain = asked_domain(os.environ) or 0
    _write_file(plan, _parameters(plan, connection, domain), path)


def _write_file(plan: Plan, parameters: dict[str, dict[str, Any]], path: Path) -> None:
    run = RunSettings(
        plan.graph,
        plan.scenario.ticks,
        _rest(plan, None),
        plan.manner.real_time,
        plan.rig is not None,
        names=plan.names,
        wait_for=frozenset(plan.manner.wait_for),
    )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_run(run, parameters, path)
    except OSError as error:
        raise BenchError(f"the file '{path}' cannot be written: {error.strerror}") from None


def _parameters(
    plan: Plan, connection: Connection | None, domain: int | None = None
) -> dict[str, dict[str, Any]]:
    parameters = node_parameters(plan.scenario, plan.node_set)
    if connection is not None:
        parameters[plan.graph.clock.name] = connection.parameters
    for name, replay in plan.replays.items():
        parameters[name] = {"bag": str(replay.bag)}
    if plan.bag is not None:
        metadata = json.dumps(plan.metadata(domain))
        parameters[RECORDER] = {
            "path": str(plan.bag),
            "metadata": metadata,
            "compress": plan.manner.compress,
        }
    return parameters


def _rest(plan: Plan, zygote: Zygote | None) -> dict[str, tuple[float, ...]]:
    """Return the rest values, which delayed inputs and a rig before tick 0 need."""
    if not connection_delays(plan.graph) and plan.rig is None:
        return {}
    physics = physics_of(plan)
    if zygote is None:
        return state_of_rest(physics)
    values: dict[str, tuple[float, ...]] = zygote.call(STATE_OF_REST, physics)
    return values


def _error(result: RunResult) -> str | None:
    if result.error is not None:
        return result.error.message
    if any(result.lost.values()):
        listed = ", ".join(f"{n} on {topic}" for topic, n in result.lost.items() if n)
        return f"messages were lost: {listed}"
    if not result.ok and result.stopped_by is None:
        return f"the run ended after {result.ticks} ticks without saying why"
    return None


def _with_bag(plan: Plan, outcome: Outcome) -> Outcome:
    """Look into the bag: how much it holds, the largest values, and whether it is whole."""
    from steering_bringup.bags import BagError, note_in_bag, read_bag
    from steering_bringup.bags.writer import BROKEN_OFF_KEY

    if plan.bag is None or not plan.bag.exists():
        return outcome
    outcome.bag = plan.bag
    try:
        more: dict[str, Any] = {} if outcome.rig is None else {"rig_run": outcome.rig}
        if outcome.ticks < outcome.planned:
            more |= {BROKEN_OFF_KEY: outcome.error or outcome.stopped_by}
        if more:
            note_in_bag(plan.bag, more)
        trace = read_bag(plan.bag)
    except BagError as error:
        outcome.notes.append(str(error))
        return outcome
    outcome.messages = trace.message_count
    outcome.peaks = peaks_of(trace)
    outcome.notes += trace.notes
    return outcome
