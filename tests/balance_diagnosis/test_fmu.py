"""Models of other tools: FMUs made here from equations in C, and a public one where it is given."""

import os
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp

from balance_diagnosis import BalanceError, Record, diagnose
from balance_diagnosis.fmu import FmuModel

EXAMPLES = Path(__file__).parents[2] / "src" / "balance_diagnosis" / "examples"
REFERENCE = os.environ.get("STEER_REFERENCE_FMUS")
EMPS = os.environ.get("STEER_EMPS_DATA")

SLIDING = {
    "schema": 1,
    "name": "sliding mass",
    "inputs": {"push": "push"},
    "outputs": {"speed": "speed"},
    "states": ["x"],
    "parameters": {
        "mass": {"nominal": 10.0, "tolerance": 0.1, "unit": "kg"},
        "damping": {"variable": "viscous", "nominal": 20.0, "tolerance": 0.4},
        "coulomb": {"between": [1.0, 30.0]},
    },
    "starts": {"begin": {"variable": "v", "nominal": 0.0, "plus_minus": 1.0}},
    "causes": {
        "spring": {"spring": {"neutral": 0.0, "low": 0.0, "high": 60.0, "unit": "N/m"}},
        "speed sensor's gain": {
            "gain": {"neutral": 0.0, "low": -0.3, "high": 0.3, "gain_of": "speed"}
        },
        "push offset": {
            "shift": {"neutral": 0.0, "low": -9.0, "high": 9.0, "offset_of": "push", "unit": "N"}
        },
        "speed sensor is late": {
            "late": {"neutral": 0.0, "low": 0.0, "high": 0.2, "delay_of": "speed"}
        },
    },
}
TRUE = {"mass": 10.4, "damping": 18.0, "coulomb": 8.8, "begin": 0.2}


def example(name):
    """Return a module of the examples' folder."""
    for folder in (EXAMPLES, EXAMPLES / "fmu"):
        if str(folder) not in sys.path:
            sys.path.append(str(folder))
    return __import__(name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture(scope="module")
def sliding_file(folder):
    return example("make").make("sliding_mass", folder)


def bound(fmu, folder, **changes):
    """Return the sliding mass, its binding changed."""
    file = folder / "binding.yaml"
    file.write_text(yaml.safe_dump({**SLIDING, **changes}))
    return FmuModel(fmu, file)


@pytest.fixture(scope="module")
def sliding(sliding_file, folder):
    return bound(sliding_file, folder)


def pushed(seed, samples=800):
    """Return a record of a push [N] with an empty speed."""
    draw = np.random.default_rng(seed)
    times = 0.01 * np.arange(samples)
    push = np.zeros(samples)
    for w in (0.7, 1.9, 3.3, 6.1):
        push += 18.0 * np.sin(w * times + draw.uniform(0.0, 2.0 * np.pi))
    return Record(times, {"push": push, "speed": 0.0 * times}, name=f"push {seed}")


def made(model, seed, **numbers):
    """Return a record of the sliding mass with noise."""
    blank = pushed(seed)
    speed = model.predicted({**TRUE, **numbers}, blank).outputs["speed"]
    noise = 0.01 * np.random.default_rng(seed + 100).standard_normal(len(blank))
    return blank.replaced({"speed": speed + noise})


def test_a_run_is_what_the_equations_say(sliding):
    record = pushed(1)

    def rates(t, x):
        push = np.interp(t, record.times, record["push"])
        rub = 8.8 * np.tanh(x[1] / 0.01) + 18.0 * x[1]
        return x[1], (push - rub - 5.0 * x[0]) / 10.4

    told = solve_ivp(rates, (0.0, record.times[-1]), (0.0, 0.2), "LSODA", record.times, rtol=1e-8)
    found = sliding.predicted({**TRUE, "spring": 5.0}, record)
    assert np.abs(found.outputs["speed"] - told.y[1]).max() < 2e-3 * np.ptp(told.y[1])
    assert np.abs(found.states["state x"] - told.y[0]).max() < 2e-3 * np.ptp(told.y[0])


def test_runs_do_not_depend_on_those_before(sliding):
    record = pushed(1)
    first = sliding.predicted(TRUE, record).outputs["speed"]
    assert first[0] == 0.2
    other = sliding.predicted({**TRUE, "spring": 30.0, "begin": -1.0}, record).outputs["speed"]
    again = sliding.predicted(TRUE, record).outputs["speed"]
    assert np.array_equal(first, again)
    assert np.abs(first - other).max() > 0.1


def test_an_fmu_that_cannot_be_reset_is_made_anew(sliding_file, folder, monkeypatch):
    monkeypatch.setattr("fmpy.fmi2._FMU2.reset", lambda self: None)
    model, record = bound(sliding_file, folder), pushed(1)
    first, again = (model.predicted(TRUE, record).outputs["speed"] for _ in range(2))
    loop = model.unit._march
    assert np.array_equal(first, again)
    assert np.array_equal(first, model.predicted(TRUE, record).outputs["speed"])
    assert not model.unit._reset_works
    assert model.unit._march is loop


def test_sensors_that_the_fmu_does_not_have_are_added(sliding):
    record = pushed(2)
    plain = sliding.predicted(TRUE, record).outputs["speed"]
    gained = sliding.predicted({**TRUE, "gain": 0.2}, record).outputs["speed"]
    assert np.allclose(gained, 1.2 * plain, rtol=1e-12)
    late = sliding.predicted({**TRUE, "late": 0.05}, record).outputs["speed"]
    assert np.allclose(late[5:], plain[:-5], atol=1e-9)
    shifted = record.replaced({"push": record["push"] + 3.0})
    corrected = sliding.predicted({**TRUE, "shift": 3.0}, shifted).outputs["speed"]
    assert np.allclose(corrected, plain, atol=1e-12)


def test_what_is_hidden_is_named_with_its_size(sliding):
    found = diagnose(sliding, fit=[made(sliding, 3, shift=4.0)])
    assert found.verdict.named == ("push offset",)
    estimate = found.causes["push offset"]["shift"]
    assert estimate.low < 4.0 < estimate.high


def test_the_axis_predicts_and_is_diagnosed_as_its_binding_in_python(folder):
    axis, draw = example("emps_axis"), np.random.default_rng(0)
    model = FmuModel(example("make").make("emps_axis", folder), EXAMPLES / "fmu" / "emps_axis.yaml")
    assert model.causes == axis.MODEL.causes
    assert model.parameters == axis.MODEL.parameters
    channels = {name: draw.standard_normal(300) for name in ("x", "v", "a", "sign", "force")}
    record = Record(0.001 * np.arange(300), channels)
    for _ in range(5):
        numbers = {n: p.value(draw.uniform(-1.0, 1.0)) for n, p in model.parameters.items()}
        for cause in model.causes.values():
            numbers |= {n.name: draw.uniform(n.low, n.high) for n in cause.numbers}
        one, other = (m.predicted(numbers, record).outputs["force"] for m in (model, axis.MODEL))
        assert np.abs(one - other).max() <= 1e-12 * np.abs(other).max()
    if EMPS:
        fit, held = axis.records(EMPS)
        found = [diagnose(m, fit=[fit], holdout=[held]) for m in (model, axis.MODEL)]
        assert found[0].verdict.named == found[1].verdict.named
        assert found[0].verdict.word == found[1].verdict.word
        assert np.allclose(found[0].gains[1].extended, found[1].gains[1].extended, rtol=1e-9)


@pytest.mark.skipif(
    not REFERENCE, reason="STEER_REFERENCE_FMUS: folder of the public reference FMUs (VanDerPol)"
)
@pytest.mark.parametrize("exchange", [False, True])
def test_a_public_fmu_is_diagnosed(tmp_path, exchange):
    file = tmp_path / "van_der_pol.yaml"
    file.write_text(
        "schema: 1\n"
        "outputs: {x0: x0, x1: x1}\n"
        "starts:\n"
        "  first: {variable: x0, between: [-4, 4]}\n"
        "  second: {variable: x1, between: [-4, 4]}\n"
        "parameters: {damping: {variable: mu, nominal: 1.0, tolerance: 0.1}}\n"
        "causes:\n"
        "  offset of x0: {shift: {neutral: 0, low: -1, high: 1, offset_of: x0}}\n"
        "  gain of x1: {scale: {neutral: 0, low: -0.5, high: 0.5, gain_of: x1}}\n"
    )
    model = FmuModel(Path(REFERENCE or "") / "VanDerPol.fmu", file)
    if exchange:
        model.unit.cosimulation = False
    times = np.arange(0.0, 20.0, 0.02 if exchange else 0.01)
    blank = Record(times, {"x0": 0.0 * times, "x1": 0.0 * times})
    true = {"first": 1.5, "second": 0.3, "damping": 1.05}
    draw = np.random.default_rng(0)
    noisy = {
        key: value + 0.02 * draw.standard_normal(len(times))
        for key, value in model.predicted({**true, "scale": 0.1}, blank).outputs.items()
    }
    if exchange:

        def rates(t, x):
            return x[1], 1.05 * (1.0 - x[0] ** 2) * x[1] - x[0]

        exact = solve_ivp(rates, (0.0, 20.0), (1.5, 0.3), t_eval=times, rtol=1e-9).y
        outputs = model.predicted(true, blank).outputs
        assert np.abs(outputs["x0"] - exact[0]).max() < 0.01
        return
    found = diagnose(model, fit=[blank.replaced(noisy)])
    assert found.verdict.named == ("gain of x1",)
    estimate = found.causes["gain of x1"]["scale"]
    assert estimate.low < 0.1 < estimate.high


BINDINGS: dict[str, tuple[dict[str, Any], str]] = {
    "an unknown key": ({"paramters": {}}, "the file: there is no key 'paramters'; did you mean"),
    "off, which YAML takes for false": (
        {"causes": {"spring": {"spring": {False: 0.0, "low": 0.0, "high": 1.0}}}},
        "cause 'spring', 'spring': there is no key 'False'",
    ),
    "an unknown variable": (
        {"outputs": {"speed": "sped"}},
        "there is no variable 'sped'; did you mean 'speed'?",
    ),
    "an output as a parameter": (
        {"parameters": {"speed": {"nominal": 1.0, "tolerance": 0.1}}},
        "variable 'speed' is computed by the FMU and cannot be set",
    ),
    "an input that is none": (
        {"inputs": {"push": "mass"}},
        "inputs, 'push': variable 'mass' is no input of the FMU",
    ),
    "a number that YAML takes for a text": (
        {"parameters": {"mass": {"nominal": "1e1", "tolerance": 0.1}}},
        "parameters, 'mass': 'nominal' has to be a number, not '1e1' (YAML reads 1e-3 as a text",
    ),
    "neither bounds nor nominal": (
        {"parameters": {"mass": {"unit": "kg"}}},
        "parameters, 'mass': give 'between: [low, high]', or 'nominal' with a 'tolerance'",
    ),
    "bounds that exclude the nominal": (
        {"parameters": {"mass": {"nominal": 10.0, "tolerance": 0.1, "low": 11.0}}},
        "parameters, 'mass': toleranced(10): the bounds 11 to 14 exclude it",
    ),
    "a sensor of no channel": (
        {"causes": {"c": {"n": {"neutral": 0.0, "low": 0.0, "high": 1.0, "gain_of": "x"}}}},
        "'n': 'x' is no channel of inputs or outputs",
    ),
    "no outputs": ({"outputs": {}}, "'outputs' is missing"),
    "no causes": ({"causes": {}}, "the model has no causes"),
    "no schema": ({"schema": 2}, "'schema: 1' is missing"),
    "steps that are none": ({"steps": 0}, "'steps' has to be a whole number from 1, not 0"),
}


@pytest.mark.parametrize("kind", BINDINGS)
def test_a_binding_that_is_none_is_told_with_file_and_key(sliding_file, tmp_path, kind):
    changes, told = BINDINGS[kind]
    with pytest.raises(BalanceError) as caught:
        bound(sliding_file, tmp_path, **changes)
    assert told in str(caught.value)
    assert str(tmp_path / "binding.yaml") in str(caught.value)


def repacked(source, target, edit):
    """Write an FMU with its description edited, and without what edit answers None for."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            data = edit(name, old.read(name))
            if data is not None:
                new.writestr(name, data)
    return target


def test_files_that_are_no_fmu_or_not_for_this_machine_are_told(sliding_file, tmp_path):
    no_fmu = tmp_path / "no.fmu"
    no_fmu.write_text("nothing")
    alien = repacked(
        sliding_file, tmp_path / "alien.fmu", lambda n, d: None if n.endswith(".so") else d
    )
    first = repacked(
        sliding_file, tmp_path / "first.fmu", lambda n, d: d.replace(b"'2.0'", b"'1.0'")
    )
    for file, told in {
        tmp_path / "absent.fmu": "there is no file",
        no_fmu: "is no FMU that can be read",
        alien: "has no binary for linux64, only for none",
        first: "FMU",
    }.items():
        with pytest.raises(BalanceError) as caught:
            bound(file, tmp_path)
        assert told in str(caught.value)
        assert file.name in str(caught.value)


def test_an_fmu_that_fails_is_told_in_its_words(sliding, sliding_file, tmp_path):
    other = repacked(
        sliding_file, tmp_path / "other.fmu", lambda n, d: d.replace(b"guid='s", b"guid='x")
    )
    record = made(sliding, 1)
    with pytest.raises(BalanceError, match=r"FMU 'other.fmu' fails: .*nstantiate"):
        diagnose(bound(other, tmp_path), fit=[record])


def test_without_fmpy_the_line_that_installs_it_is_told(sliding_file, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fmpy", None)
    with pytest.raises(BalanceError, match="needs fmpy: pip install fmpy"):
        bound(sliding_file, tmp_path)
