"""A whole diagnosis of the bench's own records: a cause named, with evidence and extension."""

import numpy as np
import pytest
from bench_records import NOISE, bench_record

from steering_diagnosis.steering.diagnose_record import diagnose_record

HIDDEN = {"mechanics.piston_area": 7.03e-4, "oil.bulk_modulus": 0.93e9}


@pytest.fixture(scope="module")
def diagnosis():
    """A gear with more friction in its column, and parameters within tolerance."""
    effects = {"column_friction": {"factor": 2.0}}
    return diagnose_record(
        bench_record(
            "open_centre",
            scenario="weave",
            duration=7.0,
            effects=effects,
            hidden=HIDDEN,
            noise=NOISE,
        )
    )


def test_the_hidden_effect_is_named_with_its_size(diagnosis):
    (cause,) = diagnosis.report.causes
    assert cause.effect == "column_friction"
    factor = cause.parameters["factor"]
    assert factor.value == pytest.approx(2.0, rel=0.1)
    assert factor.low < factor.value < factor.high
    assert cause.gain["driver_torque"] > 0.8


def test_the_evidence_is_there(diagnosis):
    assert diagnosis.held_out is not None
    assert 0.05 < diagnosis.held_out.mean() < 0.5
    overlay = diagnosis.overlays["driver_torque"]
    judged = slice(500, -200)
    before = np.std((overlay.measured - overlay.refitted)[judged])
    assert np.std((overlay.measured - overlay.extended)[judged]) < 0.3 * before
    strongest = max(diagnosis.balances, key=lambda b: b.share)
    assert strongest.balance == "column torque"


def test_the_extension_holds_the_cause(diagnosis):
    effects = diagnosis.extension["effects"]
    assert effects == {"column_friction": {"factor": pytest.approx(2.0, rel=0.1)}}
