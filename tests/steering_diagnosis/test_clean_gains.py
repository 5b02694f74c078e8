"""What a cause has to gain stands on what clean records gain by it."""

import pytest

from steering_diagnosis.steering.clean_gains import BEYOND, LEAST, clean_gains, largest, settings_of


def test_the_largest_gain_of_each_hypothesis_is_kept_where_there_is_any():
    found = largest(
        [
            ("open_centre", {"rack_mass": 0.3, "entrained_air": 0.01}),
            ("closed_centre", {"rack_mass": 0.07}),
            ("open_centre", {"rack_mass": 0.2, "pump_flow_ripple": 0.06}),
        ]
    )
    assert found["records"] == {"closed_centre": 1, "open_centre": 2}
    assert found["gains"]["open_centre"] == {"rack_mass": 0.3, "pump_flow_ripple": 0.06}
    assert found["gains"]["closed_centre"] == {"rack_mass": 0.07}


@pytest.mark.parametrize("system", ["open_centre", "closed_centre"])
def test_every_cause_needs_more_than_clean_records_gain(system):
    settings = settings_of(system)
    assert settings.least_gain_of("no such effect") == LEAST
    assert clean_gains()[system]
    for name, gain in clean_gains()[system].items():
        assert settings.least_gain_of(name) == max(LEAST, BEYOND * gain) > gain


def test_another_valve_system_has_the_least_gain():
    assert settings_of("servo_valve").least_gains == {}
