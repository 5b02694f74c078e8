"""No value that the engine asks a model for, or tells, ever leaves its physical range."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from toy_model import HYPOTHESES, NUISANCES, toy

from steering_core.errors import BenchError
from steering_diagnosis.engine.catalogue import catalogue, room_for
from steering_diagnosis.engine.diagnose import diagnose
from steering_diagnosis.engine.model import HypothesisParameter, Nuisance

SIZES = st.floats(0.02, 1.5)


@st.composite
def _nuisances(draw):
    """Return the toy's nuisances, their ranges about nominal anything from none to infinite."""
    found = []
    for n in NUISANCES:
        below, above = (draw(st.sampled_from([0.0, 0.3, 1.0, 2.4, np.inf])) for _ in "lh")
        tolerance = n.tolerance * draw(st.sampled_from([0.2, 1.0, 5.0]))
        low, high = n.nominal - below * tolerance, n.nominal + above * tolerance
        found.append(replace(n, tolerance=tolerance, low=low, high=high))
    return tuple(found)


@st.composite
def _hypotheses(draw):
    """Return the toy's hypotheses with bounds that may end at neutral or within a typical size."""
    found = {}
    for h in HYPOTHESES.values():
        p = h.parameters[0]
        low = -draw(st.sampled_from([0.0, 0.3, 4.0])) if not p.shape else 0.0
        high = draw(SIZES) * (0.1 if p.shape else 1.0)
        typical = min(p.typical, high)
        made = HypothesisParameter(p.name, p.unit, 0.0, low, high, typical, p.shape)
        found[h.name] = replace(h, parameters=(made,))
    return found


def _strict(ranges, refused):
    """Return a fault that fails the test where a call leaves a range, and refuses some calls."""

    def fault(nuisances, effects, found):
        values = {**nuisances, **{n: next(iter(p.values())) for n, p in effects.items()}}
        for name, value in values.items():
            low, high = ranges[name]
            assert low <= value <= high, (name, value, low, high)
        if refused is not None and values.get(refused[0], -np.inf) > refused[1]:
            raise BenchError("the plant left what is possible")
        return found

    return fault


@settings(max_examples=10, deadline=None, phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(
    seed=st.integers(0, 1000),
    nuisances=_nuisances(),
    hypotheses=_hypotheses(),
    hidden=st.dictionaries(st.sampled_from(["square", "product", "lag", "offset"]), SIZES),
    refused=st.none()
    | st.tuples(st.sampled_from(["square", "cube", "late", "gain", "lag"]), st.floats(1e-3, 1.2)),
)
def test_no_call_and_no_finding_leaves_its_range(seed, nuisances, hypotheses, hidden, refused):
    hidden = {n: v * (0.03 if n in ("lag", "offset") else 1.0) for n, v in hidden.items()}
    ranges = {n.name: (n.low, n.high) for n in nuisances}
    ranges |= {h.name: (h.parameters[0].low, h.parameters[0].high) for h in hypotheses.values()}
    if refused and refused[0] == "gain":
        refused = ("gain", 1.0 + refused[1])
    made = replace(toy(seed, **hidden), nuisances=nuisances, hypotheses=hypotheses)
    second = replace(toy(seed + 1, **hidden), nuisances=nuisances, hypotheses=hypotheses)
    fault = _strict(ranges, refused)
    found = diagnose(replace(made, fault=fault), replace(second, fault=fault))
    told = {
        **found.nuisances,
        **{n: p for n, p in found.refitted.items() if n not in found.effects},
    }
    told |= {n: next(iter(p.values())) for n, p in found.effects.items()}
    for name, value in told.items():
        assert ranges[name][0] <= value <= ranges[name][1]
    for cause in found.causes:
        for name, interval in cause.parameters.items():
            p = next(p for p in cause.hypothesis.parameters if p.name == name)
            assert p.low <= interval.low <= interval.value <= interval.high <= p.high


@given(
    low=st.floats(-10.0, 0.0),
    high=st.floats(0.0, 10.0),
    share=st.floats(0.0, 1.0),
    step=st.floats(-30.0, 30.0),
)
def test_a_step_for_differences_stays_in_the_range(low, high, share, step):
    value = min(max(low + share * (high - low), low), high)
    taken = room_for(step, value, low, high)
    assert low - 1e-12 <= value + taken <= high + 1e-12
    assert taken != 0.0 or step == 0.0 or high == low or abs(step) < 1e-300


def test_a_wrong_parameter_is_looked_for_within_its_range():
    late = Nuisance("lag", "s", 0.0, 2e-3, 0.0, 0.02)
    book = catalogue(replace(toy(0), nuisances=(late,)))
    (p,) = book.hypotheses["parameter:lag"].parameters
    assert (p.low, p.high, p.typical) == (0.0, 0.02, 4e-3)
    assert (book.lowest[0], book.highest[0]) == (0.0, 2.0)


def _early(made):
    """Return the toy with its first output a sample early."""
    early = np.vstack([made.measured[1:, 0], made.measured[:-1, 1]]).T
    return replace(made, measured=np.vstack([early, early[-1:]]))


def test_what_a_record_asks_for_beyond_a_range_is_a_finding():
    found = diagnose(_early(toy(7)))
    assert found.causes == ()
    assert found.verdict == "unexplained"
    assert {r.output for r in found.unexplained} == {"one"}
    assert any("lag is held at 0 s" in note for note in found.notes)


def test_a_nuisance_within_its_range_is_no_finding():
    found = diagnose(toy(7, lag=3e-3))
    assert found.verdict == "clean"
    assert found.notes == ()


def test_a_nuisance_at_its_end_leaves_the_estimates_of_causes_alone():
    """The specimen is early, which the lag cannot be: it ends at none, and the cause is found."""
    found = diagnose(_early(toy(7, square=0.4)))
    assert found.nuisances.get("lag", 0.0) == 0.0
    assert [c.hypothesis.name for c in found.causes] == ["square"]
    value = found.causes[0].parameters["size"]
    assert value.low < 0.4 < value.high
