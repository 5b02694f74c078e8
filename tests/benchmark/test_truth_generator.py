"""The truth generator against the bench's own plant, and its balances."""

import numpy as np
import pytest

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from pressure_control.controller import ValveController
from steering_bringup.direct.runner import Cores, run
from steering_core.parameters import load_parameters
from steering_diagnosis.benchmark.truth import states as s
from steering_diagnosis.benchmark.truth.course import draw_course
from steering_diagnosis.benchmark.truth.disturbance import RESOLUTION, disturbance
from steering_diagnosis.benchmark.truth.effects import TRUE_EFFECTS, changed
from steering_diagnosis.benchmark.truth.run import LED_IN, run_clamped, run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen, nominal_specimen
from steering_plant.plant import Plant
from vehicle_model.loads import make_load
from vehicle_model.vehicle import Vehicle

NOMINAL = load_parameters()
SYSTEMS = ("open_centre", "closed_centre")


def bench(course, system):
    """Measure the bench's own plant on a course, after the same rest."""
    n = LED_IN + len(course.angle)
    driver = Driver(NOMINAL, make_manoeuvre("hold"), n)
    driver.reference[LED_IN:] = np.append(course.angle, course.angle[-1])
    vehicle = Vehicle(NOMINAL, make_load(course.load), n)
    if course.load == "table":
        vehicle.external = np.concatenate([np.full(LED_IN, course.force[0]), course.force])
    closed = system == "closed_centre"
    cores = Cores(
        plant=Plant(NOMINAL, system),
        driver=driver,
        vehicle=vehicle,
        left=ValveController(NOMINAL, "left") if closed else None,
        right=ValveController(NOMINAL, "right") if closed else None,
    )
    trace = run(cores, n)
    return np.column_stack([trace.torque, trace.pressure, trace.rack])[LED_IN:]


@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize(("kind", "load"), [("sweep", "bicycle"), ("ramps", "table")])
def test_nominal_and_noise_free_it_is_the_bench(system, kind, load):
    course = draw_course(np.random.default_rng(1), 5.0, kind, load)
    ours = run_closed_loop(nominal_specimen(NOMINAL), NOMINAL, course, system == "closed_centre")
    theirs = bench(course, system)
    span = np.maximum(np.ptp(theirs, axis=0), 1.0)
    span[[s.RACK_OUT, s.RACK_SPEED_OUT]] = np.ptp(theirs, axis=0)[[s.RACK_OUT, s.RACK_SPEED_OUT]]
    assert (np.abs(ours.true - theirs).max(axis=0) < 5e-4 * span).all()


@pytest.mark.parametrize("system", SYSTEMS)
def test_the_supply_pays_for_what_the_rack_does(system):
    course = draw_course(np.random.default_rng(2), 5.0, "weave", "table")
    signals = run_closed_loop(nominal_specimen(NOMINAL), NOMINAL, course, system == "closed_centre")
    true = signals.true
    pressed = NOMINAL["mechanics.piston_area"] * (true[:, s.RIGHT_OUT] - true[:, s.LEFT_OUT])
    assert 0.0 < np.sum(pressed * true[:, s.RACK_SPEED_OUT]) * 1e-3 < signals.energy


def test_oil_is_neither_made_nor_lost():
    """A blocked valve: what the rack's stroke takes from one chamber must compress the other."""
    from steering_diagnosis.benchmark.truth.gear import rates

    p = nominal_specimen(NOMINAL).par(True, False)[0]
    for position, speed in ((0.0, 0.02), (0.03, -0.05)):
        y, d, u = np.zeros(s.STATES), np.zeros(s.STATES), np.zeros(s.INPUTS)
        y[[s.LEFT, s.RIGHT]] = 2e6
        y[s.LEFT_VALVE + 2], y[s.RIGHT_VALVE + 2] = 2e6, 2e6
        y[s.SUPPLY], y[s.RACK], y[s.RACK_SPEED] = 2e6, position, speed
        y[s.LEFT_VALVE] = y[s.RIGHT_VALVE] = 5e-4
        rates(p, y, u, d)
        left = (p["chamber_volume"] - p["piston_area"] * position) * d[s.LEFT] / p["bulk_modulus"]
        right = (p["chamber_volume"] + p["piston_area"] * position) * d[s.RIGHT] / p["bulk_modulus"]
        assert left == pytest.approx(p["piston_area"] * speed, rel=1e-9)
        assert right == pytest.approx(-p["piston_area"] * speed, rel=1e-9)


@pytest.mark.parametrize("system", SYSTEMS)
def test_every_effect_shows_on_some_record(system):
    """Along the same inputs each effect moves a channel (or a balance) that it should."""
    random = np.random.default_rng(3)
    closed = system == "closed_centre"
    courses = [
        draw_course(random, 3.0, "sweep", "bicycle"),
        draw_course(random, 7.0, "large", "none"),
    ]
    specimen = nominal_specimen(NOMINAL)
    given = [run_closed_loop(specimen, NOMINAL, c, closed) for c in courses]
    before = [
        run_clamped(specimen, NOMINAL, c, g, closed) for c, g in zip(courses, given, strict=True)
    ]
    for name, effect in TRUE_EFFECTS[system].items():
        at = 1 if effect.kinds else 0
        made = changed(specimen, NOMINAL, system, {name: effect.typical})
        if name == "tyre_relaxation":
            after = run_closed_loop(made, NOMINAL, courses[at], closed)
            assert np.abs(after.load - given[at].load).max() > 10.0
            continue
        after = run_clamped(made, NOMINAL, courses[at], given[at], closed)
        moved = np.abs(after.measured - before[at].measured).max(axis=0)
        moved = np.append(moved, np.abs(after.balance - before[at].balance).max(axis=0))
        noise = np.array([1e-4, 1e-3, 3e-3, 3e3, 3e3, 3e3, 2e-6, 2e-4, 2.0, 0.02, 2.0])
        assert (moved > noise).any(), name


def test_a_specimen_is_within_tolerance():
    random = np.random.default_rng(4)
    for _ in range(20):
        made = draw_specimen(NOMINAL, random)
        for name, value in made.sheet.items():
            allowed = NOMINAL.info(name).tolerance * abs(NOMINAL[name])
            assert abs(value - NOMINAL[name]) <= allowed * (1 + 1e-12)


def test_a_seed_repeats_and_another_one_differs():
    def measured(seed):
        random = np.random.default_rng(seed)
        course = draw_course(random, 2.0)
        made = draw_specimen(NOMINAL, random)
        noise = disturbance(random, len(course.angle))
        return run_closed_loop(made, NOMINAL, course, False, noise, RESOLUTION).measured.tobytes()

    assert measured(5) == measured(5)
    assert measured(5) != measured(6)
