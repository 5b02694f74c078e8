"""One call of ``steer run``: the planned runs one after the other, then their comparison."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from steering_bringup.checks import check_physics, check_place, physics_of
from steering_bringup.errors import BenchError
from steering_bringup.forerunner import forerunner
from steering_bringup.interrupts import nothing_to_lose
from steering_bringup.outcome import Outcome
from steering_bringup.plans import Plan
from steering_lockstep.kinds import programs

if TYPE_CHECKING:
    from steering_bringup.bags import Trace
    from steering_lockstep.zygote import Zygote

CHECK_PHYSICS = "steering_bringup.checks:check_physics"


def run_all(
    plans: Sequence[Plan],
    on_outcome: Callable[[Outcome], None],
    zygote: Zygote | None = None,
    on_start: Callable[[str], None] | None = None,
) -> list[Outcome]:
    """Run ``plans`` in order; the first that does not end well is the last that is run.

    Checks all of them before the first starts. on_start: is told of each graph where it is seen.
    zygote: a ``forerunner`` that was started earlier,
    where time matters.
    """
    for plan in plans:
        if plan.bag is not None:
            check_place(plan.bag)
    with ExitStack() as stack:
        graphs = [plan for plan in plans if plan.manner.runner == "graph"]
        if graphs:
            zygote = zygote or stack.enter_context(forerunner())
            zygote.load(programs(_kinds(graphs)))
        with nothing_to_lose():
            for plan in plans:
                physics = physics_of(plan)
                if zygote is None or physics.direct:
                    check_physics(physics)
                else:
                    zygote.call(CHECK_PHYSICS, physics)
            if graphs:
                # Here, where Ctrl-C cannot be lost; it takes long enough.
                import steering_lockstep.processes  # noqa: F401
        outcomes: list[Outcome] = []
        for plan in plans:
            if plan.bag is not None:
                make_folder(plan.bag.parent)
            outcomes.append(_run(plan, zygote, on_start))
            outcomes[-1].notes[:0] = plan.notes()
            if len(outcomes) > 1:
                outcomes[-1].since_command = 0.0
            on_outcome(outcomes[-1])
            if not outcomes[-1].ok:
                break
    return outcomes


def _kinds(plans: Sequence[Plan]) -> set[str]:
    """Return the kinds of nodes that the runs' own processes hold."""
    return {
        node.kind
        for plan in plans
        for node in plan.graph.nodes
        if node.name not in plan.manner.external
    }


def make_folder(folder: Path) -> None:
    """Make a folder and those above it; BenchError names the one that cannot be made."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        place = error.filename or folder
        raise BenchError(f"the folder '{place}' cannot be made: {error.strerror}") from None


def _run(plan: Plan, zygote: Zygote | None, on_start: Callable[[str], None] | None) -> Outcome:
    if plan.manner.runner == "direct":
        from steering_bringup.direct_run import run_direct

        return run_direct(plan)
    from steering_bringup.graph_run import run_through_graph

    return run_through_graph(plan, zygote, on_start)


def compare_bags(first: Path, second: Path, page: Path) -> tuple[list[str], dict[str, object]]:
    """Compare two bags, write the page, and return (lines for the terminal, numbers)."""
    from steering_bringup.bags import read_bag

    return compare_traces(
        read_bag(first, repair_damage=False), read_bag(second, repair_damage=False), page
    )


def compare_traces(first: Trace, second: Trace, page: Path) -> tuple[list[str], dict[str, object]]:
    """Compare two traces, write the page, and return (lines for the terminal, numbers)."""
    from steering_bringup.comparison import compare, summary
    from steering_bringup.comparison.page import write_page

    result = compare(first, second)
    write_page(result, page)
    return summary(result).splitlines(), result.to_dict()
