"""A replay at a specimen's own parameters: what it leaves is what no diagnosis can explain."""

import numpy as np
import pytest

from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.bags import record_of
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.disturbance import WHITE
from steering_diagnosis.benchmark.truth.run import run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen, nominal_specimen
from steering_diagnosis.data.channels import MEASURED
from steering_diagnosis.steering.drive import SENSORS
from steering_diagnosis.steering.replay import SteeringReplay

NOMINAL = load_parameters()
ROWS = {SENSORS[channel]: row for row, channel in reversed(list(enumerate(MEASURED)))}
NOISE = dict(zip(MEASURED, WHITE, strict=True)) | {"driver_torque": 0.03, "load_force": 3.0}
SHARE = {"driver_torque": 2.0}
"""Of the noise that may be left: the column's torque stands on a twice differentiated angle."""


def own(specimen, name):
    """Return the specimen's value of a nuisance of the replay."""
    group, quantity = name.rsplit(".", 1)
    if group in ROWS:
        return specimen.sensors[ROWS[group], ["gain", "offset"].index(quantity)]
    return specimen.sheet[name]


@pytest.mark.parametrize("system", ["open_centre", "closed_centre"])
@pytest.mark.parametrize(
    ("kind", "load"),
    [("weave", "table"), ("weave", "bicycle"), ("park", "dry_park"), ("large", "none")],
)
def test_a_specimen_s_own_parameters_leave_a_tenth_of_the_noise(system, kind, load):
    random = np.random.default_rng(5)
    specimen = draw_specimen(NOMINAL, random)
    course = draw_course(random, 6.0, kind, load)
    signals = run_closed_loop(specimen, NOMINAL, course, system == "closed_centre")
    replay = SteeringReplay(record_of(signals, NOMINAL, system, load, "truth"))
    residuals = replay.residuals({n.name: own(specimen, n.name) for n in replay.nuisances}, {})
    left = np.sqrt(np.nanmean(residuals**2, axis=0))
    for output, rms in zip(replay.outputs, left, strict=True):
        assert rms < SHARE.get(output.name, 0.1) * NOISE[output.name], output.name


@pytest.mark.parametrize("system", ["open_centre", "closed_centre"])
def test_what_the_inputs_noise_does_is_known_without_knowing_the_noise(system):
    """White noise of the sensors: error of the prediction against a second draw's."""
    random = np.random.default_rng(6)
    specimen = nominal_specimen(NOMINAL)
    course = draw_course(random, 8.0, "weave", "bicycle")
    noise = WHITE * random.standard_normal((len(course.angle), len(WHITE)))
    signals = run_closed_loop(specimen, NOMINAL, course, system == "closed_centre", noise)
    record = record_of(signals, NOMINAL, system, "bicycle", "truth")
    replay = SteeringReplay(record)
    residuals, shaken = replay.residuals({}, {}), replay.shaken({}, {})
    for name in ("torsion_bar_torque", "left_pressure", "rack_position"):
        column = [o.name for o in replay.outputs].index(name)
        added = noise[:, list(MEASURED).index(name)]
        error = np.nanstd(residuals[:, column] - added)
        assert 0.5 < np.nanstd(shaken[:, column]) / error < 2.0, name
