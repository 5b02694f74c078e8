"""Whatever goes wrong in one candidate model costs that candidate, and the report says so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from dask_here import dask_executor
from numba.core.errors import NumbaError
from toy_model import Toy, toy

from steering_core.errors import BenchError
from steering_core.parameters import load_parameters
from steering_diagnosis.engine import conclude as concluding
from steering_diagnosis.engine import search as searching
from steering_diagnosis.engine.diagnose import diagnose
from steering_diagnosis.engine.findings import Findings
from steering_diagnosis.engine.fit import Fit
from steering_diagnosis.engine.reporting import to_report
from steering_diagnosis.report import Source


def raising(error: Exception) -> Callable[[np.ndarray], np.ndarray]:
    def out(found: np.ndarray) -> np.ndarray:
        raise error

    return out


def out_of_range(found: np.ndarray) -> np.ndarray:
    load_parameters().with_values({"rack_force_sensor.delay": -1e-3})
    return found


def not_finite(value: float) -> Callable[[np.ndarray], np.ndarray]:
    def out(found: np.ndarray) -> np.ndarray:
        found[500:510, 0] = value
        return found

    return out


TROUBLE = {
    "BenchError": raising(BenchError("the plant left what is possible")),
    "range": out_of_range,
    "ZeroDivisionError": raising(ZeroDivisionError("division by zero")),
    "LinAlgError": raising(np.linalg.LinAlgError("Singular matrix")),
    "OverflowError": raising(OverflowError("math range error")),
    "NumbaError": raising(NumbaError("a kernel")),
    "NaN": not_finite(np.nan),
    "infinity": not_finite(np.inf),
    "divergence": not_finite(1e200),
    "a large number": not_finite(1e45),
}
"""What a model's own code may do."""

ELSEWHERE = {
    "always": lambda nuisances, size: True,
    "beyond the template": lambda nuisances, size: abs(abs(size) - 0.5) > 1e-9,
    "beside a nuisance": lambda nuisances, size: bool(nuisances),
    "at large sizes": lambda nuisances, size: abs(size) > 0.6,
    "at small sizes": lambda nuisances, size: abs(size) < 0.4,
    "one way": lambda nuisances, size: size > 0.0,
}
"""Where the hypothesis that fails does so: each in another step of the search."""


def failing(made: Toy, name: str, where: str, how: str) -> Toy:
    def fault(nuisances, effects, found):
        size = next(iter(effects.get(name, {}).values()), 0.0)
        if name in effects and ELSEWHERE[where](nuisances, size):
            return TROUBLE[how](found)
        return found

    return replace(made, fault=fault)


def told(found: Findings, name: str) -> bool:
    report = to_report(found, Source(path="toy", sha256=""), "0")
    rivals = [r for r in report.rivals if r.effect == name and "could not be tried" in r.why_not]
    notes = [n for n in report.notes if n.startswith("could not be tried") and name in n]
    return bool(rivals and notes)


@pytest.mark.parametrize("how", TROUBLE)
def test_a_hypothesis_that_can_never_be_replayed_is_told_and_left_out(how):
    found = diagnose(failing(toy(1, square=0.4), "product", "always", how))
    assert [c.hypothesis.name for c in found.causes] == ["square"]
    assert found.causes[0].parameters["size"].value == pytest.approx(0.4, abs=0.02)
    assert told(found, "product")


@pytest.mark.parametrize(
    ("where", "how"),
    [*zip(ELSEWHERE, ["NaN", "BenchError", "NaN", "divergence", "NaN", "BenchError"], strict=True)],
)
def test_trouble_of_one_hypothesis_leaves_the_others_alone(where, how):
    found = diagnose(failing(toy(1, square=0.4), "product", where, how))
    assert [c.hypothesis.name for c in found.causes] == ["square"]


@pytest.mark.parametrize("where", ELSEWHERE)
def test_trouble_of_the_true_cause_costs_that_cause_and_no_more(where):
    found = diagnose(failing(toy(2, square=0.4), "square", where, "BenchError"))
    names = {c.hypothesis.name for c in found.causes}
    if where in ("at large sizes", "at small sizes"):
        assert "square" in names or told(found, "square")
    else:
        assert names <= {"square"} or told(found, "square")
        assert found.verdict in ("named", "unexplained", "ambiguous")


@pytest.mark.parametrize("first", [3, 9, 18, 29, 45])
def test_a_model_that_begins_to_fail_at_any_step_costs_itself(first):
    """The true cause and a rival fail from their n-th replay on, whatever step that is in."""
    seen = {"square": 0, "product": 0}

    def fault(nuisances, effects, found):
        for name in seen.keys() & effects.keys():
            seen[name] += 1
            if seen[name] > first:
                raise ZeroDivisionError("division by zero")
        return found

    found = diagnose(replace(toy(3, square=0.4), fault=fault))
    names = {c.hypothesis.name for c in found.causes}
    assert names <= {"square", "cube"}
    assert "square" in names or told(found, "square")


def test_a_model_that_only_the_second_record_refuses_is_left_out():
    second = failing(toy(5, square=0.4), "square", "always", "BenchError")
    found = diagnose(toy(4, square=0.4), second)
    assert "square" not in {c.hypothesis.name for c in found.causes}
    assert told(found, "square")


def test_noise_that_drives_a_model_out_of_what_is_possible_costs_that_model():
    def shaking(nuisances, effects, found):
        if "product" in effects:
            raise BenchError("the plant left what is possible")
        return found

    found = diagnose(replace(toy(1, product=0.3), shaking=shaking))
    assert "product" not in {c.hypothesis.name for c in found.causes}
    assert told(found, "product")


STAGES = {
    "refit": (searching, "settled", 2),
    "evidence": (searching, "weigh", 3),
    "parsimony": (searching, "parsimonious", 1),
    "thorough refit": (searching, "refit", 2),
    "intervals": (concluding, "intervals", 1),
    "ambiguity": (concluding, "compare", 2),
    "remaining": (concluding, "left_by", 1),
}
"""Each step's function, and the position of the model in its arguments."""


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("hidden", ["square", "product"])
def test_equations_without_a_solution_cost_the_model_in_every_step(stage, hidden, monkeypatch):
    module, name, position = STAGES[stage]
    real = getattr(module, name)

    def broken(*given, **more):
        model = given[position]
        if "product" in (model.values if isinstance(model, Fit) else model):
            raise np.linalg.LinAlgError("Singular matrix")
        return real(*given, **more)

    monkeypatch.setattr(module, name, broken)
    found = diagnose(toy(1, **{hidden: 0.3}))
    names = {c.hypothesis.name for c in found.causes}
    if hidden == "square":
        assert names == {"square"}
    else:
        assert "product" not in names or stage == "ambiguity"
        assert told(found, "product") or stage == "ambiguity"


def test_workers_tell_of_failures_as_well():
    made = failing(toy(1, square=0.4), "product", "always", "NumbaError")
    with dask_executor(threads=2) as executor:
        found = diagnose(made, executor=executor)
    assert [c.hypothesis.name for c in found.causes] == ["square"]
    assert told(found, "product")


@pytest.mark.parametrize("error", [TypeError("no"), AttributeError("no"), KeyError("no")])
def test_programming_errors_surface(error):
    def fault(nuisances, effects, found):
        if "product" in effects:
            raise error
        return found

    with pytest.raises(type(error)):
        diagnose(replace(toy(1), fault=fault))


@pytest.mark.parametrize("how", [how for how in TROUBLE if how != "a large number"])
def test_a_nominal_model_that_fails_is_one_clear_line(how):
    def fault(nuisances, effects, found):
        if how == "NaN":
            return np.full_like(found, np.nan)
        return TROUBLE[how](found)

    with pytest.raises(BenchError, match="the nominal model") as error:
        diagnose(replace(toy(1), fault=fault))
    assert "\n" not in str(error.value)
