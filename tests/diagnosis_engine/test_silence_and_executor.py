"""The engine stays silent on specimens within tolerance, and answers the same wherever it runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from dask_here import dask_executor
from sled import HYPOTHESES, record

from steering_core.errors import BenchError
from steering_diagnosis.engine.diagnose import diagnose
from steering_diagnosis.engine.findings import Findings


def _numbers(found: Findings) -> tuple[object, ...]:
    causes = {c.hypothesis.name: dict(c.parameters) for c in found.causes}
    return found.verdict, causes, dict(found.nuisances), found.losers


@pytest.mark.parametrize("seed", [10, 11, 12, 13])
def test_nothing_is_named_on_a_specimen_within_tolerance(seed: int) -> None:
    found = diagnose(record(seed))
    assert found.causes == ()
    assert found.verdict == "clean"


def test_two_causes_are_both_named() -> None:
    found = diagnose(record(1, drag=500.0, position_delay=8e-3))
    assert {c.hypothesis.name for c in found.causes} == {"drag", "position_delay"}


def test_causes_with_the_same_trace_are_one_ambiguous_group() -> None:
    """An offset of the load and a friction that depends on direction differ at standstill only."""
    (cause,) = diagnose(record(2, load_offset=8.0)).causes
    group = {cause.hypothesis.name, *cause.ambiguous_with}
    assert "load_offset" in group
    assert group <= {"load_offset", "friction_asymmetry"}
    assert (cause.separating is None) == (not cause.ambiguous_with)


def test_a_phenomenon_in_no_catalogue_is_unexplained() -> None:
    found = diagnose(record(1, ripple=8.0))
    assert found.causes == ()
    assert found.verdict == "unexplained"
    assert {u.output for u in found.unexplained} <= {"position", "force", "speed"}


@pytest.mark.parametrize(
    ("absent", "size"), [("drag", 500.0), ("position_delay", 8e-3), ("stribeck", 20.0)]
)
def test_what_others_explain_only_in_part_gets_none_of_their_names(
    absent: str, size: float
) -> None:
    """Damping explains most of a drag that the catalogue lacks, but leaves what is no noise."""
    known = {n: h for n, h in HYPOTHESES.items() if n != absent}
    found = diagnose(replace(record(4, **{absent: size}), hypotheses=known))
    assert found.causes == ()
    assert found.verdict == "unexplained"


def test_a_distributed_engine_gives_the_same_numbers() -> None:
    """Dask's executor is a concurrent.futures.Executor; here on threads of this process."""
    replay = record(3, 6.0, backlash=6e-4)
    alone = diagnose(replay)
    with dask_executor(threads=2) as executor:
        spread = diagnose(replay, executor=executor)
    assert _numbers(alone) == _numbers(spread)
    assert np.array_equal(alone.residual_extended, spread.residual_extended)


def test_ten_samples_are_refused() -> None:
    with pytest.raises(BenchError, match="too few"):
        diagnose(record(1, 0.01 + 0.05))


def test_progress_ends_at_one() -> None:
    told: list[float] = []

    def tell(share: float, what: str) -> None:
        del what
        told.append(share)

    found = diagnose(record(2, 5.0), progress=tell)
    assert told[-1] == 1.0
    assert all(0.0 <= share <= 1.0 for share in told)
    assert isinstance(found.nuisances, Mapping)
