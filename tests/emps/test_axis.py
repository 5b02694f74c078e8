"""The engine on a real machine: the EMPS axis, whose data stay outside the project."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from steering_core.errors import BenchError
from steering_diagnosis.emps.run import ForceErrors, diagnose_axis
from steering_diagnosis.engine.findings import Findings

FOLDER = os.environ.get("STEER_EMPS_DATA")
measured = pytest.mark.skipif(
    FOLDER is None, reason="STEER_EMPS_DATA does not name the folder of the EMPS records"
)


@pytest.fixture(scope="module")
def found() -> tuple[Findings, ForceErrors]:
    assert FOLDER is not None
    return diagnose_axis(Path(FOLDER))


@measured
def test_direction_dependent_viscous_friction_is_named_alone(
    found: tuple[Findings, ForceErrors],
) -> None:
    """So neither the offset that looks certain on its own, nor Stribeck, nor position."""
    findings, _ = found
    assert [c.hypothesis.name for c in findings.causes] == ["viscous_asymmetry"]
    assert findings.causes[0].ambiguous_with == ()
    size = findings.causes[0].parameters["size"]
    assert size.low < -37.0 < size.high, "half the difference of 167 and 241 N s/m"


@measured
def test_the_mode_that_the_pulses_excite_is_called_unexplained(
    found: tuple[Findings, ForceErrors],
) -> None:
    findings, _ = found
    modes = [u for u in findings.unexplained if u.where == "held-out record"]
    assert modes
    assert modes[0].band_hz[1] > 15.0


@measured
def test_force_errors_are_near_the_published_ones(found: tuple[Findings, ForceErrors]) -> None:
    """Published: 4.08 % symmetric, 3.11 % direction-dependent; 5.98 % on the pulses."""
    _, errors = found
    assert errors.extended < 0.033
    assert errors.extended_held_out < 0.0598


def test_a_folder_without_the_records_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match=r"DATA_EMPS\.mat"):
        diagnose_axis(tmp_path)
