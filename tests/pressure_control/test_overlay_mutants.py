"""The rules of the overlay are worth something: every break of the limits' code breaks a rule."""

import contextlib
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from mutants import mutants
from overlay_rules import APPLIED, BY_RATE, BY_TORQUE, Rules

import pressure_control
from steering_core.parameters import load_parameters

FOLDER = Path(pressure_control.__file__).parent
ORDER = ("limits", "overlay.lateral", "overlay.limits", "overlay.hands", "overlay.sources")
NAMES = (*ORDER, "overlay.arbiter")
VARIANTS: tuple[dict[str, float], ...] = (
    {},
    {"overlay.maximum_pressure": 6e5},
    {"overlay.maximum_lateral_acceleration": 0.5},
    {"overlay.maximum_rate": 15.0},
    {"overlay.maximum_lateral_jerk": 2.2},
)


def source(name):
    return (FOLDER / f"{name.replace('.', '/')}.py").read_text()


@contextlib.contextmanager
def interpreted(broken, text):
    """Give the arbiter with its kernels as plain Python, one file's source replaced."""
    made = []
    try:
        for name in NAMES:
            code = text if name == broken else source(name)
            code = code.replace("pressure_control.", "broken_control.")
            code = code.replace("from steering_core.compiled import kernel", "kernel = lambda f: f")
            module = ModuleType(f"broken_control.{name}")
            sys.modules[module.__name__] = module
            made.append(module.__name__)
            exec(compile(code, name, "exec"), module.__dict__)
        yield module.OverlayArbiter
    finally:
        for name in made:
            del sys.modules[name]


def keeps_the_rules(make, parameters):
    """Ask far too much, with faults in between, one way and the other; then ask little."""
    rules, arbiter = Rules(parameters), make(parameters, (1,))
    arbiter.par = arbiter.par.view(np.recarray)
    wishes = [29.0] * 1000 + [np.nan] * 20 + [-29.0] * 2000 + [0.9 * rules.level] * 2000
    out = []
    for tick, wish in enumerate(wishes):
        out.append(arbiter.step(tick, 0.0, 0.0, 0.0, 20.0, wish, 1.0).copy())
    rows = np.array(out)
    rules.check(rows)
    applied = rows[:, APPLIED]
    levels = (rules.level, -rules.level, 0.9 * rules.level)
    assert applied[[999, 3019, -1]] == pytest.approx(levels, rel=1e-9)
    for start in (0, 1020, 3020):
        fastest = np.max(np.abs(np.diff(applied[start:])))
        assert fastest == pytest.approx(rules.step, rel=1e-9)
    # each reason is told exactly where that limit alone would hold back
    for i, level in enumerate(rules.levels):
        assert bool(rows[999, BY_TORQUE + i]) == (level < 29.0)
        assert bool(rows[3019, BY_TORQUE + i]) == (level < 29.0)
        assert bool(rows[-1, BY_TORQUE + i]) == (0.9 * rules.level > level)
    distance = np.abs(-rules.level - applied[1599])
    for i, step in enumerate(rules.steps):
        assert bool(rows[1600, BY_RATE + i]) == (distance > step)
        assert not rows[-1, BY_RATE + i]


def caught(broken, text):
    try:
        with interpreted(broken, text) as make:
            for changes in VARIANTS:
                keeps_the_rules(make, load_parameters().with_values(changes))
    except Exception:
        return True
    return False


def test_the_code_as_it_is_keeps_the_rules():
    with interpreted(None, "") as make:
        for changes in VARIANTS:
            keeps_the_rules(make, load_parameters().with_values(changes))


@pytest.mark.parametrize("broken", ["limits", "overlay.limits"])
def test_every_mutant_of_the_limits_is_caught(broken):
    found = list(mutants(source(broken)))
    assert found
    alive = [what for what, text in found if not caught(broken, text)]
    assert alive == []
