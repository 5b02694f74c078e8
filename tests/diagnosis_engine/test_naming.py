"""The engine on a toy machine whose truth has other code: names, sizes, silence."""

from __future__ import annotations

import pytest
from sled import record

from steering_diagnosis.engine.diagnose import diagnose
from steering_diagnosis.engine.reporting import to_report
from steering_diagnosis.report import Source


@pytest.mark.parametrize(
    ("hidden", "size", "parameter"),
    [("friction_level", 20.0, "size"), ("backlash", 6e-4, "gap"), ("position_delay", 8e-3, "size")],
)
def test_one_hidden_cause_is_named_with_its_size(hidden: str, size: float, parameter: str) -> None:
    found = diagnose(record(3, 12.0, **{hidden: size}))
    first = found.causes[0]
    assert hidden in (first.hypothesis.name, *first.ambiguous_with)
    assert first.hypothesis.name == hidden
    assert first.parameters[parameter].value == pytest.approx(size, rel=0.2)


def test_a_report_can_be_written_of_what_was_found() -> None:
    found = diagnose(record(3, drag=500.0))
    report = to_report(found, Source(path="sled", sha256=""), "0")
    assert report.verdict in ("named", "ambiguous")
    assert "drag" in report.sentence
    assert report.signals["speed"].rmse_extended_holdout < report.signals["speed"].rmse_refitted
