"""Places for guests: given back after silence, kept by priority, and a flood keeps nobody out."""

import numpy as np
import pytest

from pressure_control.overlay.arbiter import OverlayArbiter
from pressure_control.overlay.places import MOST_GUESTS
from steering_core.parameters import load_parameters

PARAMETERS = load_parameters()
SILENT_TICKS = 30
"""ticks, three of the shortest period"""


def arbiter_with(count, priority=1.0, tick=0):
    arbiter = OverlayArbiter(PARAMETERS)
    for number in range(count):
        arbiter.hear_guest(f"name {number}", tick, 1.0, priority)
    step(arbiter, tick)
    return arbiter


def step(arbiter, tick):
    return arbiter.step(tick, 0.0, 0.0, 0.0, 20.0).copy()


def served(arbiter, out):
    """Return the name of the guest who is served, as the node tells it."""
    return [*arbiter.guests][int(out[6]) - 1] if out[6] else None


def test_invented_names_give_their_places_back_after_their_silence():
    arbiter = arbiter_with(MOST_GUESTS)
    arbiter.hear_guest("late", 1, 2.0, 1.0)
    assert "late" not in arbiter.guests, "all speak, and none has less priority"
    for tick in range(1, SILENT_TICKS + 2):
        step(arbiter, tick)
    arbiter.hear_guest("late", SILENT_TICKS + 2, 2.0, 0.0)
    assert served(arbiter, step(arbiter, SILENT_TICKS + 2)) == "late"
    assert len(arbiter.guests) == MOST_GUESTS


def test_a_greater_priority_takes_the_place_of_the_least_at_once():
    arbiter = arbiter_with(MOST_GUESTS)
    arbiter.hear_guest("name 7", 1, 1.0, 0.5)
    step(arbiter, 1)
    arbiter.hear_guest("safety", 2, 3.0, 9.0)
    assert "name 7" not in arbiter.guests
    assert served(arbiter, step(arbiter, 2)) == "safety"
    arbiter.hear_guest("name 7", 3, 1.0, 1.0)
    assert "name 7" not in arbiter.guests, "an equal priority takes nobody's place"


def test_who_is_served_keeps_the_place_and_a_fault_takes_none():
    arbiter = arbiter_with(MOST_GUESTS, priority=-1.0)
    arbiter.hear_guest("name 5", 1, 1.0, 0.0)
    assert served(arbiter, step(arbiter, 1)) == "name 5"
    for torque, priority in ((np.nan, 5.0), (1.0, np.nan), (1e9, 5.0), (1.0, np.inf)):
        arbiter.hear_guest("fault", 2, torque, priority)
        assert "fault" not in arbiter.guests
    for number in range(2 * MOST_GUESTS):
        arbiter.hear_guest(f"other {number}", 2, 1.0, -0.5)
    assert served(arbiter, step(arbiter, 2)) == "name 5"


def test_names_stay_in_the_order_of_their_numbers():
    arbiter = arbiter_with(MOST_GUESTS)
    arbiter.hear_guest("name 3", 1, 1.0, 0.0)
    step(arbiter, 1)
    arbiter.hear_guest("new", 2, 1.0, 2.0)
    assert [*arbiter.guests.values()] == list(range(MOST_GUESTS))
    assert [*arbiter.guests][3] == "new"


@pytest.mark.parametrize("priority", [0.0, 1.0])
def test_a_flood_of_invented_names_changes_nothing_for_a_guest_who_was_there(priority):
    """Ten names in each tick, as at 10 kHz, of no greater priority: the same to the bit."""
    applied = []
    for flooded in (False, True):
        arbiter, rows, number = OverlayArbiter(PARAMETERS), [], 0
        for tick in range(400):
            if tick % 10 == 0:
                arbiter.hear_guest("keeper", tick, 2.0, 1.0)
            for _ in range(10 if flooded else 0):
                arbiter.hear_guest(f"invented {number}", tick, -5.0, priority)
                number += 1
            rows.append(step(arbiter, tick)[:7])
        applied.append(np.array(rows))
        assert len(arbiter.guests) <= MOST_GUESTS
    np.testing.assert_array_equal(applied[0], applied[1])


def test_a_guest_of_the_flood_s_priority_gets_in_within_a_tenth_of_a_second():
    arbiter, number = OverlayArbiter(PARAMETERS), 0
    for tick in range(600):
        for _ in range(10):
            arbiter.hear_guest(f"invented {number}", tick, -5.0, 0.0)
            number += 1
        if tick >= 300 and tick % 10 == 0:
            arbiter.hear_guest("late", tick, 2.0, 1.0)
            assert "late" in arbiter.guests
        step(arbiter, tick)
