"""One specimen through two doors with the same channels: one verdict, one cause, one size."""

from dataclasses import replace

import numpy as np
import pytest

from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.doors.door import Door
from steering_diagnosis.benchmark.doors.logger import Logger
from steering_diagnosis.benchmark.doors.write import paths, write_mapping, write_through
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.disturbance import RESOLUTION, disturbance
from steering_diagnosis.benchmark.truth.effects import changed
from steering_diagnosis.benchmark.truth.run import run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen
from steering_diagnosis.data.read import read_record
from steering_diagnosis.steering import suspects
from steering_diagnosis.steering.clean_gains import settings_of
from steering_diagnosis.steering.diagnose_record import diagnose_record
from steering_plant.effects import EFFECTS

SYSTEM = "open_centre"
NOMINAL = load_parameters()
SECONDS = 3.0
LACKING = ("load_command", "speeds", "driver_torque")
PLAIN = Door("bag", LACKING)
CSV = Door("csv", LACKING, Logger(start=1712.25, drift=4e-5, jitter=2e-5), way=1)
MDF = Door("mdf", LACKING, Logger(start=3.5, drift=-3e-5, other=(0.1, 2e-5)))
KNOWN = (
    "torque_sensor_offset",
    "torque_sensor_gain",
    "rack_friction_level",
    "cross_piston_leakage",
    "pressure_sensor_offset_left",
    "pump_flow_level",
)
"""Enough of the catalogue to be wrong; all of it takes minutes."""

QUICK = replace(settings_of(SYSTEM), most_causes=1, refitted=2)


@pytest.fixture(autouse=True)
def small_catalogue(monkeypatch):
    monkeypatch.setattr(suspects, "EFFECTS", {name: EFFECTS[name] for name in KNOWN})


def reports(sizes, doors, folder):
    """Return a specimen's report through each door."""
    random = np.random.default_rng(11)
    course = draw_course(random, SECONDS, "amplitudes", "table")
    specimen = changed(draw_specimen(NOMINAL, random), NOMINAL, SYSTEM, sizes)
    noise = disturbance(random, len(course.angle))
    signals = run_closed_loop(specimen, NOMINAL, course, False, noise, RESOLUTION)
    for door in doors:
        at = paths(door, folder, f"record-{door.kind}")
        write_through(door, at.record, signals, NOMINAL, SYSTEM, "table")
        if at.mapping is not None:
            write_mapping(door, at.mapping, signals, SYSTEM)
        yield diagnose_record(read_record(at.record, at.mapping), settings=QUICK).report


@pytest.mark.parametrize(
    ("sizes", "doors"), [({}, (PLAIN, MDF)), ({"torque_sensor_offset": -0.42}, (PLAIN, CSV))]
)
def test_the_same_is_said_of_the_same_specimen(sizes, doors, tmp_path):
    one, two = reports(sizes, doors, tmp_path)
    assert one.verdict == two.verdict == ("named" if sizes else "clean")
    assert [c.effect for c in one.causes] == [c.effect for c in two.causes] == list(sizes)
    for first, second in zip(one.causes, two.causes, strict=True):
        assert first.parameters.keys() == second.parameters.keys()
        for name, here in first.parameters.items():
            there = second.parameters[name]
            assert here.low <= there.value <= here.high
            assert there.low <= here.value <= there.high
