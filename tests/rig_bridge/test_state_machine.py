"""The state machine against its truth table, written out, and by properties."""

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from rig_bridge.safety.machine import Seen, State, next_state

CHECKING, ENTERING, RUNNING, SAFE = State

# Without a fault: {state: {(checked, entered, reset): next}}, "-" stands for either.
TABLE = {
    CHECKING: {"0--": CHECKING, "1--": ENTERING},
    ENTERING: {"-0-": ENTERING, "-1-": RUNNING},
    RUNNING: {"---": RUNNING},
    SAFE: {"--0": SAFE, "--1": CHECKING},
}


def matches(pattern, flags):
    return all(p == "-" or p == str(int(flag)) for p, flag in zip(pattern, flags, strict=True))


def test_every_row_of_the_truth_table():
    for state, flags in product(State, product((False, True), repeat=3)):
        rows = [to for pattern, to in TABLE[state].items() if matches(pattern, flags)]
        assert len(rows) == 1, "the table is complete and without contradiction"
        checked, entered, reset = flags
        assert next_state(state, Seen(False, checked, entered, reset)) is rows[0]
        assert next_state(state, Seen(True, checked, entered, reset)) is SAFE


SEEN = st.builds(Seen, st.booleans(), st.booleans(), st.booleans(), st.booleans())


@given(st.lists(SEEN, max_size=60))
def test_pressure_only_after_checks_and_never_back_without_a_reset(ticks):
    state = CHECKING
    for seen in ticks:
        before, state = state, next_state(state, seen)
        if state is ENTERING and before is not ENTERING:
            assert before is CHECKING
            assert seen.checked
        if state is RUNNING and before is not RUNNING:
            assert before is ENTERING
            assert seen.entered
        if before is SAFE and state is not SAFE:
            assert state is CHECKING
            assert seen.reset
            assert not seen.fault


def test_a_fault_is_latched_however_long():
    state = next_state(RUNNING, Seen(fault=True))
    for _ in range(1000):
        state = next_state(state, Seen(checked=True, entered=True))
    assert state is SAFE
