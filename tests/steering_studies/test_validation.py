"""A model against a system test: its own record is met, a wrong one is told by its channels."""

import numpy as np
import pytest

from steering_bringup.errors import BenchError
from steering_core.parameters import load_parameters
from steering_studies.pages.validation import validation_page
from steering_studies.rig_tests.simulate import TYPICAL_NOISE, simulate
from steering_studies.validation import COMPARED, merit, validate

NOMINAL = load_parameters()


@pytest.fixture(scope="module")
def record():
    return simulate("system", TYPICAL_NOISE)["system"]


def test_the_right_model_meets_every_channel(record):
    made = validate(record, NOMINAL)
    assert set(made.merits) == set(COMPARED)
    assert all(found.fit > 0.97 for found in made.merits.values())
    # The prototype's driver follows the measured angle within 0.58 deg, source: "very good".
    assert np.degrees(made.merits["steering_wheel_angle"].rms) < 0.58
    assert "supply pressure" in validation_page(made, "system").render()


def test_a_wrong_model_is_worse_where_it_is_wrong(record):
    right = validate(record, NOMINAL).merits
    wrong = validate(record, NOMINAL.with_values({"mechanics.rack_friction": 120.0})).merits
    assert wrong["torsion_bar_torque"].rms > 3.0 * right["torsion_bar_torque"].rms


def test_a_delay_is_seen():
    time = np.arange(5000) * 1e-3
    found = merit(np.sin(3.0 * time), np.sin(3.0 * (time - 0.012)), "N m")
    assert found.delay == pytest.approx(0.012)


def test_a_record_without_the_rack_force_is_refused(record):
    with pytest.raises(BenchError, match="rack_force"):
        validate({"steering_wheel_angle": record["steering_wheel_angle"]}, NOMINAL)
