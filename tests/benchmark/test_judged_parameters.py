"""What a diagnosis is judged by: the library's parameters that describe the truth best."""

import numpy as np
import pytest

from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.bags import record_of
from steering_diagnosis.benchmark.truth.changes import BOTH
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.disturbance import WHITE
from steering_diagnosis.benchmark.truth.effects import changed
from steering_diagnosis.benchmark.truth.listed import LISTED
from steering_diagnosis.benchmark.truth.run import run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import nominal_specimen
from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.steering.replay import SteeringReplay
from steering_plant.effects import EFFECTS

NOMINAL = load_parameters()

NOISE = dict(zip(MEASURED, WHITE, strict=True)) | {"driver_torque": 0.03, "load_force": 3.0}

BESIDE = {
    "entrained_air": {"polytropic_exponent": 1.3},
    "rack_end_stop": {"stiffness": 0.134},
    "pump_flow_ripple": {"frequency": 137.0, "phase": 0.7 - np.pi},
}
"""Parameters that are not judged, where the neutral ones are far from the truth."""

JUDGED = [
    pytest.param(effect, system, id=f"{effect.name}-{system}")
    for effect in LISTED
    for system in effect.systems
    if effect.equivalent(effect.typical)
]


def test_what_is_not_judged():
    assert {e.name for e in LISTED if not e.equivalent(e.typical)} == {"rack_stribeck_friction"}
    assert {system for _, system in (p.values for p in JUDGED)} == set(BOTH)


@pytest.mark.parametrize(("effect", "system"), JUDGED)
def test_a_judged_parameter_is_within_five_per_cent_of_the_best_fit(effect, system):
    """Without noise and tolerances a replay errs less with it than 10 % above or below."""
    kind = effect.kinds[0] if effect.kinds else "weave"
    load = "none" if effect.kinds else "bicycle" if effect.loads == ("bicycle",) else "table"
    course = draw_course(np.random.default_rng(1), 9.0 if effect.kinds else 5.0, kind, load)
    made = changed(nominal_specimen(NOMINAL), NOMINAL, system, {effect.name: effect.typical})
    signals = run_closed_loop(made, NOMINAL, course, system == "closed_centre")
    replay = SteeringReplay(record_of(signals, NOMINAL, system, load, "truth"))
    noise = np.array([NOISE.get(o.name, NOISE["supply_pressure"]) for o in replay.outputs])
    beside = EFFECTS[effect.name].neutral() | BESIDE.get(effect.name, {})
    ((judged, value),) = effect.equivalent(effect.typical).items()

    def error(share):
        fitted = effect.neutral + share * (value - effect.neutral)
        residuals = replay.residuals({}, {effect.name: {**beside, judged: fitted}})
        return np.nansum((residuals / noise) ** 2)

    assert error(1.0) < min(error(0.9), error(1.1))
