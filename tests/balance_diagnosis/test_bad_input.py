"""Bad input: one clear line that names the thing, the place and what to do."""

import math
from typing import Any, cast

import numpy as np
import pytest

from balance_diagnosis import BalanceError, Model, Record, between, diagnose, ode, toleranced

COUNT = 200
PARAMETERS = {"gain": toleranced(2.0, 0.1)}
CAUSES = {"offset": {"offset": (0.0, -5.0, 5.0)}}


def record(seed=0, name="run", count=COUNT, **channels):
    draw = np.random.default_rng(seed)
    times = 0.01 * np.arange(count)
    u = np.cumsum(draw.standard_normal(count))
    y = 2.1 * u + 0.01 * draw.standard_normal(count)
    return Record(times, {"u": u, "y": y, **channels}, name=name)


def line(p, r):
    return {"y": p.gain * r["u"] + p.offset}


def model(predict=line, **given):
    return Model(predict, **{"parameters": PARAMETERS, "causes": CAUSES, **given})


def refusal(act):
    """Return the one line with which something is refused."""
    with pytest.raises(BalanceError) as caught:
        act()
    text = str(caught.value)
    assert "\n" not in text
    return text


def broken(p, r):
    raise ZeroDivisionError("division by zero")


def random_line(p, r):
    return {"y": line(p, r)["y"] + np.random.default_rng().standard_normal(len(r))}


def greedy(p, r):
    r["u"][:] = 2.0 * r["u"]
    return line(p, r)


PREDICTIONS = {
    "raises": (broken, "the model fails at its nominal values on record 'run': ZeroDivisionError"),
    "nan": (
        lambda p, r: {"y": np.where(np.arange(COUNT) == 7, np.nan, r["u"] * p.gain)},
        "the model's 'y' is nan at sample 7 of record 'run', at its nominal values",
    ),
    "shape": (
        lambda p, r: {"y": p.gain * r["u"][:-1]},
        "predict returned 'y' with shape (199,); record 'run' has 200 samples",
    ),
    "column": (
        lambda p, r: {"y": p.gain * r["u"][:, None]},
        "predict returned 'y' with shape (200, 1); record 'run' has 200 samples",
    ),
    "number": (
        lambda p, r: {"y": p.gain},
        "predict returned 'y' with shape (); record 'run' has 200 samples",
    ),
    "no name": (
        lambda p, r: p.gain * r["u"],
        "predict has to return its channels by name, as {'level': values}; it returned ndarray",
    ),
    "other name": (
        lambda p, r: {"Y": p.gain * r["u"]},
        "predict returned 'Y', but no prediction of 'u', 'y' of record 'run'",
    ),
    "misspelled beside a right one": (
        lambda p, r: {"u": p.gain * r["u"], "Y": p.gain * r["u"]},
        "predict returns 'Y', and record 'run' has 'y', which would not be judged",
    ),
    "reads a channel that is not there": (
        lambda p, r: {"y": p.gain * r["force"]},
        "record 'run' has no channel 'force'; it has 'u', 'y'",
    ),
    "reads a number that is not there": (
        lambda p, r: {"y": p["gian"] * r["u"]},
        "there is no 'gian' among the model's numbers; there are 'offset', 'gain'",
    ),
    "reads an attribute that is not there": (
        lambda p, r: {"y": p.gian * r["u"]},
        "there is no 'gian' among the model's numbers",
    ),
    "depends on nothing": (
        lambda p, r: {"y": 2.0 * r["u"] + p.offset},
        "no output depends on any parameter ('gain'): does predict use p?",
    ),
    "complex": (
        lambda p, r: {"y": 1j * p.gain * r["u"]},
        "predict returned 'y' with complex numbers: return real ones",
    ),
    "random": (random_line, "predict returns another 'y' each time it is called"),
    "changes the record": (greedy, "predict changes the channels of record 'run'"),
}


@pytest.mark.parametrize("kind", PREDICTIONS)
def test_a_prediction_that_is_none_is_refused(kind):
    predict, told = PREDICTIONS[kind]
    assert told in refusal(lambda: diagnose(model(predict), fit=[record()]))


MODELS: dict[str, tuple[dict[str, Any], str]] = {
    "no causes": ({"causes": {}}, "the model has no causes"),
    "a cause without numbers": ({"causes": {"leak": {}}}, "cause 'leak' has no numbers"),
    "a cause of two numbers": (
        {"causes": {"leak": {"leak": (0.0, 1.0)}}},
        "cause 'leak', 'leak': give (off, low, high), not (0.0, 1.0)",
    ),
    "off outside of its bounds": (
        {"causes": {"leak": {"leak": (0.0, 1.0, 2.0)}}},
        "cause 'leak', 'leak': the bounds 1 to 2 exclude 0, where it is off",
    ),
    "bounds in the wrong order": (
        {"causes": {"leak": {"leak": (0.0, 1.0, -1.0)}}},
        "cause 'leak', 'leak': no bounds: 1 to -1",
    ),
    "a list of causes": (
        {"causes": ["leak"]},
        "causes is a list; give names with what they hold: {'name': {'size': (off, low, high)}}",
    ),
    "a list of parameters": ({"parameters": ["gain"]}, "parameters is a list; give names"),
    "a name that is a number": (
        {"causes": {"leak": {3: (0.0, -1.0, 1.0)}}},
        "'3' of cause 'leak' is no name that p.NAME could have",
    ),
    "a number twice": (
        {"causes": {"leak": {"gain": (0.0, -1.0, 1.0)}}},
        "'gain' is in the parameters and in cause 'leak': rename one",
    ),
    "a name that is none": (
        {"parameters": {"my gain": toleranced(1.0, 0.1)}},
        "'my gain' of the parameters is no name that p.NAME could have",
    ),
    "a parameter without a prior": (
        {"parameters": {"gain": 2.0}},
        "parameter 'gain': give between(low, high) or toleranced(nominal, share), not 2.0",
    ),
    "a unit of nothing": (
        {"units": {"gian": "N"}},
        "a unit is given for 'gian', which is no number of the model",
    ),
}


@pytest.mark.parametrize("kind", MODELS)
def test_a_model_that_is_none_is_refused(kind):
    given, told = MODELS[kind]
    assert told in refusal(lambda: model(**given))


PRIORS = {
    "bounds exclude the nominal": (lambda: toleranced(2.0, 0.1, low=3.0), "exclude it"),
    "bounds in the wrong order": (lambda: between(2.0, 1.0), "between(2, 1): the first bound"),
    "no tolerance": (lambda: toleranced(2.0, 0.0), "its tolerance has to be above zero"),
    "a share of nothing": (lambda: toleranced(0.0, 0.1), "its tolerance has to be above zero"),
    "no number": (lambda: toleranced(math.nan, 0.1), "not a number"),
    "a text": (lambda: between(cast(Any, "low"), 2.0), "is low, not a number"),
}


@pytest.mark.parametrize("kind", PRIORS)
def test_a_prior_that_is_none_is_refused(kind):
    make, told = PRIORS[kind]
    assert told in refusal(make)


def test_a_cause_that_does_nothing_is_named_with_its_bounds():
    idle = {**CAUSES, "leak": {"leak": (0.0, 0.0, 1.0)}}
    text = refusal(lambda: diagnose(model(causes=idle), fit=[record()]))
    assert text.startswith("cause 'leak' changes no output of any record within its bounds")
    assert "leak 0 to 1" in text


def test_a_catalogue_that_is_emptied_is_refused():
    assert refusal(lambda: model().without("offset")) == "no cause would be left in the catalogue"
    assert refusal(lambda: model().without("ofset")) == "there is no cause 'ofset' to take out"


RECORDS = {
    "no record": (lambda: diagnose(model(), fit=[]), "there is no record to fit"),
    "a record in place of a list": (
        lambda: diagnose(model(), fit=record()),
        "fit and holdout are lists of records: write fit=[record]",
    ),
    "no model": (
        lambda: diagnose(cast(Any, line), fit=[record()]),
        "give diagnose a Model, not function: Model(predict, ...)",
    ),
    "something else": (
        lambda: diagnose(model(), fit=cast(Any, [np.zeros(100)])),
        "fit and holdout hold records, not ndarray",
    ),
    "the same bytes under two names": (
        lambda: diagnose(model(), fit=[record(name="a"), record(name="b")]),
        "records 'a' and 'b' are the same bytes: give each once",
    ),
    "one name for two": (
        lambda: diagnose(model(), fit=[record(0), record(1)]),
        "two records are called 'run': give each a name",
    ),
    "a hold-out with other channels": (
        lambda: diagnose(
            model(),
            fit=[record(name="a")],
            holdout=[Record(np.arange(100.0), {"y": np.arange(100.0)}, name="b")],
        ),
        "record 'b' has no channel 'u'; it has 'y'",
    ),
}


@pytest.mark.parametrize("kind", RECORDS)
def test_records_that_do_not_go_together_are_refused(kind):
    act, told = RECORDS[kind]
    assert told in refusal(act)


def test_one_object_twice_is_refused():
    same = record()
    text = refusal(lambda: diagnose(model(), fit=[same], holdout=[same]))
    assert text == "one record is given twice: give each once, to fit or to holdout"


def test_a_hold_out_that_was_fitted_is_refused_with_its_share():
    whole = record()
    text = refusal(lambda: diagnose(model(), fit=[whole], holdout=[whole.part(0.4, 1.0, "end")]))
    assert text == (
        "100% of the hold-out 'end' are samples of 'run', which is fitted: hold out other data"
    )


def test_a_hold_out_of_the_same_samples_with_another_channel_beside_them_is_refused():
    more = record(name="more", force=np.zeros(COUNT))
    text = refusal(lambda: diagnose(model(), fit=[record()], holdout=[more]))
    assert text.startswith("100% of the hold-out 'more' are samples of 'run'")


def test_another_run_of_the_same_input_may_be_held_out():
    again = record(name="again")
    again.channels["y"] += 0.01 * np.random.default_rng(5).standard_normal(COUNT)
    assert diagnose(model(), fit=[record()], holdout=[again]).gains[1].held_out


def test_records_may_come_from_a_generator_and_no_hold_out_may_be_none():
    one = cast(Any, (r for r in [record()]))
    found = diagnose(model(), fit=one, holdout=cast(Any, None))
    assert [gain.record for gain in found.gains] == ["run"]


def test_a_gap_in_an_input_is_told_with_its_channel():
    gap = record()
    gap.channels["u"][50] = np.nan
    text = refusal(lambda: diagnose(model(), fit=[gap]))
    assert "the model's 'y' is nan at sample 50 of record 'run'" in text
    assert text.endswith("channel 'u', which it reads, has a gap there")


def test_a_gap_in_what_is_judged_is_none():
    gap = record()
    gap.channels["y"][50:60] = np.nan
    assert diagnose(model(), fit=[gap]).gains[0].nominal < 0.1


def test_a_start_that_is_no_state_is_told_with_the_states():
    def predict(p, r):
        return {"y": p.gain * r["u"] + p.get("level", 0.0) + p.offset}

    setattr(predict, "states", ("level",))  # noqa: B010 - as those of ode() have them
    text = refusal(
        lambda: diagnose(model(predict, starts={"levle": between(0.0, 1.0)}), fit=[record()])
    )
    assert text == (
        "no output depends on the start 'levle'; the states are 'level': is it a state?"
    )


def test_a_number_that_equations_do_not_have_is_told_by_its_name():
    def rates(x, u, p):
        return (u[0] - p.gian * x[0],)

    def seen(x, r, p):
        return {"y": x.level}

    predict = ode(rates, seen, states=("level",), inputs=("u",))
    text = refusal(lambda: diagnose(model(predict), fit=[record()]))
    assert text == "numba cannot compile 'rates': there is no 'gian' among the model's numbers"


ARRAYS = {
    "short": (lambda: record(count=20), "record 'run' has 20 samples; 50 are the least"),
    "unequal": (
        lambda: record(force=np.zeros(7)),
        "record 'run', channel 'force': shape (7,), expected (200,)",
    ),
    "infinite": (
        lambda: record(force=np.where(np.arange(COUNT) == 3, np.inf, 0.0)),
        "record 'run', channel 'force': infinite at sample 3",
    ),
    "time goes back": (
        lambda: Record(np.r_[np.arange(60.0), 5.0], {"y": np.zeros(61)}),
        "times have to increase; sample 60 (5 s) does not come after 59 s",
    ),
    "no channels": (lambda: Record(np.arange(60.0), {}), "record 'record' has no channels"),
    "a unit of no channel": (
        lambda: Record(np.arange(60.0), {"y": np.zeros(60)}, {"Y": "m"}),
        "a unit is given for 'Y', which is no channel; there are 'y'",
    ),
    "texts": (
        lambda: Record(np.arange(60.0), {"y": np.array(["a"] * 60)}),
        "record 'record', 'y': no numbers: could not convert string to float",
    ),
    "channels without names": (
        lambda: Record(np.arange(60.0), cast(Any, [np.zeros(60)])),
        "record 'record': channels is a list; give {'name': values}",
    ),
    "times side by side": (
        lambda: Record(np.zeros((60, 2)), {"y": np.zeros(60)}),
        "record 'record': times have shape (60, 2), not (n,)",
    ),
    "a negative noise": (
        lambda: Record(np.arange(60.0), {"y": np.zeros(60)}, noise={"y": -1.0}),
        "the noise of 'y' is -1.0",
    ),
}


@pytest.mark.parametrize("kind", ARRAYS)
def test_arrays_that_are_no_record_are_refused(kind):
    make, told = ARRAYS[kind]
    assert told in refusal(make)


def test_too_little_that_is_judged_is_told():
    few = record()
    few.channels["y"][20:] = np.nan
    text = refusal(lambda: diagnose(model(), fit=[few]))
    assert text == "record 'run', channel 'y': 20 samples are judged; 50 are the least"


FILES = {
    "no file": (None, "there is no file"),
    "no lines": ("t,y\n", "has no header line with names, or no lines below it"),
    "other column": ("t,z\n0,1\n", "has no column 'y'; it has t, z"),
    "text": ("t,y\n0,1\n1,SNA\n", "line 3, column 'y': 'SNA' is no number"),
    "decimal comma": ("t,y\n0,1,5\n", "line 2: 3 cells, and the header has 2 names"),
    "semicolons": ("t;y\n0;1\n", "is separated by ';', not by commas"),
    "a name twice": ("t,y,y\n0,1,2\n", "has the column 'y' twice: rename one"),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_file_that_is_none_is_refused(kind, tmp_path):
    text, told = FILES[kind]
    file = tmp_path / "run.csv"
    if text is not None:
        file.write_text(text)
    said = refusal(lambda: Record.from_csv(file, "t", {"y": "y"}))
    assert told in said
    assert str(file) in said


def test_a_file_is_read_with_empty_cells_as_gaps(tmp_path):
    file = tmp_path / "run.csv"
    file.write_text("t,y\n" + "\n".join(f"{k},{k if k != 3 else ''}" for k in range(60)))
    read = Record.from_csv(file, "t")
    assert np.array_equal(read["y"], np.where(np.arange(60) == 3, np.nan, np.arange(60.0)), True)


def test_a_constant_that_does_not_exist_is_refused():
    from balance_diagnosis.constants import DEFAULT

    assert "there is no constant 'fact'" in refusal(lambda: DEFAULT.scaled("fact", 2.0))


def test_a_record_without_noise_is_diagnosed():
    exact = record()
    exact.channels["y"] = 2.1 * exact["u"] + 3.0
    assert diagnose(model(), fit=[exact]).verdict.named == ("offset",)
