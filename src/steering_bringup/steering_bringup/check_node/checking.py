"""All cases of a check, one after the other."""

from __future__ import annotations

from collections.abc import Sequence

from steering_bringup.check_node.case import Case
from steering_bringup.check_node.faults import END, FAULTS, Fault
from steering_bringup.check_node.judge import Verdict, judge
from steering_bringup.check_node.record import Subject
from steering_bringup.errors import BenchError
from steering_bringup.progress import Bar
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_core.naming import unknown

CHECK_NODE_SET = "closed_centre_overlay"


def check(
    subject: Subject, scenario: str, names: Sequence[str] | None, patience: float
) -> list[Verdict]:
    """Return a verdict for each fault of ``names`` (None: all that can happen to the node).

    A node that ends by itself in the first of them gets no further ones. Raises BenchError for an
    unknown fault or scenario, and for a command that cannot be started.
    """
    faults = chosen(subject, names)
    drive = load_scenario(scenario).model_copy(update={"duration": END * 1e-3})
    verdicts: list[Verdict] = []
    with Bar("check-node", END * 1e-3 * len(faults)) as bar:
        for k, fault in enumerate(faults):
            bar.update(k * END, 0.0, fault.key)
            record = Case(subject, fault, drive, load_node_set(CHECK_NODE_SET), patience).run()
            verdicts.append(judge(subject, fault, record, drive.parameter_values()))
            if k == 0 and record.ended and not verdicts[-1].passed:
                break
    return verdicts


def chosen(subject: Subject, names: Sequence[str] | None) -> list[Fault]:
    """Return the faults called ``names`` that can happen to the node."""
    for name in names or ():
        if name not in FAULTS:
            raise BenchError(f"--faults: {unknown('fault', name, FAULTS)}")
        if subject.style not in FAULTS[name].styles:
            raise BenchError(f"--faults {name}: cannot happen to a member of the lock step")
    wanted = names or FAULTS
    return [f for key, f in FAULTS.items() if key in wanted and subject.style in f.styles]
