"""The truth generator against the bench's own plant, and its balances."""

from dataclasses import replace

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
from steering_diagnosis.benchmark.truth.gear import rates, rub, valve
from steering_diagnosis.benchmark.truth.loop import STAGES, TICK, age
from steering_diagnosis.benchmark.truth.run import LED_IN, SUBSTEPS, run_clamped, run_closed_loop
from steering_diagnosis.benchmark.truth.specimen import draw_specimen, nominal_specimen
from steering_diagnosis.benchmark.visibility import STEPS
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


@pytest.mark.parametrize("discharge", [1.0, 0.6])
def test_a_discharge_coefficient_acts_at_every_orifice_and_on_the_momentum_of_its_jets(discharge):
    """Torricelli's speed at each orifice; a jet pushes the spool shut with rho Q v cos(delta)."""
    p = nominal_specimen(NOMINAL).par(True, False)[0]
    chamber, supply, control, solenoid = 1.2e7, 1.8e7, 1e6, 20.0
    y, d = np.zeros(s.STATES), np.zeros(s.STATES)
    y[s.LEFT_VALVE] = spool = 2e-4
    y[s.LEFT_VALVE + 2] = control
    drawn, into = valve(p, y, d, s.LEFT_VALVE, chamber, supply, solenoid, 0.0, discharge)

    density, coefficient = p["density"], discharge * p["flow_coefficient"]
    into_control = coefficient * np.pi / 4 * p["damping_orifice_diameter"] ** 2
    into_control *= np.sqrt(2.0 * (chamber - control) / density)
    assert drawn - into == pytest.approx(into_control, rel=1e-3)
    stiffness = p["bulk_modulus"] / p["control_chamber_volume"]
    assert d[s.LEFT_VALVE + 2] == pytest.approx(stiffness * into_control, rel=1e-3)

    speed = np.sqrt(2.0 * (supply - chamber) / density)
    jet = density * drawn * speed * p["jet_angle_cosine"]
    face = np.pi / 4 * p["pressure_area_diameter"] ** 2
    left = solenoid - face * control - p["spring_preload"] - p["spring_stiffness"] * spool - jet
    assert d[s.LEFT_VALVE + 1] == pytest.approx(left / p["spool_mass"], rel=1e-4)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_friction_of_two_levels_has_bristles_of_one_stiffness(direction):
    """Dahl's law in closed form, F_d (1 - exp(-k x/F_d)); turned round, the bristle lets go."""
    difference, step, speed = 40.0, 1e-3, direction * 1e-2
    made = nominal_specimen(NOMINAL)
    made = replace(made, extras={**made.extras, "coulomb_difference": difference})
    p, y = made.par(False, False)[0], np.zeros(s.STATES)
    seals = p["rack_friction"]
    level, stiffness = seals + direction * difference / 2, seals / p["rack_friction_displacement"]
    y[s.RACK_SPEED] = speed
    for k in range(1, 201):
        rub(p, y, step)
        bent = k * step * abs(speed)
        closed = direction * level * (1.0 - np.exp(-stiffness * bent / level))
        assert y[s.RACK_FRICTION] == pytest.approx(closed, rel=1e-9)
    y[s.RACK_SPEED] = -direction * 1e-9
    rub(p, y, step)
    assert y[s.RACK_FRICTION] == pytest.approx(direction * level, rel=1e-6)


@pytest.mark.parametrize("steps", [*SUBSTEPS.values(), *STEPS.values()])
@pytest.mark.parametrize("lags", [1, 2, 4])
def test_a_delayed_ramp_is_late_by_the_delay(steps, lags):
    """A lag follows a ramp behind by its time, so a chain of them by the sum of their times."""
    h, delay, slope = TICK / steps, 4e-3, 3.0
    delays, chain = np.zeros((s.CHANNELS, 2)), np.zeros((s.CHANNELS, 1 + STAGES))
    delays[s.TORQUE_OUT] = delay, lags
    true = np.zeros(s.CHANNELS)
    for k in range(1, round(0.2 / h) + 1):
        true[s.TORQUE_OUT] = slope * k * h
        age(delays, chain, true, h)
    ramp = slope * (k * h - delay)
    assert chain[s.TORQUE_OUT, lags] == pytest.approx(ramp, rel=1e-6)


def test_a_delayed_sensor_answers_a_step_as_erlang_says():
    """A step through a chain of four lags: 1 less the first four terms of Poisson's sum."""
    h, delay = TICK / 20, 8e-3
    delays, chain = np.zeros((s.CHANNELS, 2)), np.zeros((s.CHANNELS, 1 + STAGES))
    delays[s.TORQUE_OUT] = delay, 4
    true = np.zeros(s.CHANNELS)
    true[s.TORQUE_OUT] = 1.0
    chain[s.TORQUE_OUT, 0] = 1.0
    for k in range(1, round(3.0 * delay / h) + 1):
        age(delays, chain, true, h)
        x = 4.0 * k * h / delay
        erlang = 1.0 - np.exp(-x) * (1.0 + x + x**2 / 2.0 + x**3 / 6.0)
        assert chain[s.TORQUE_OUT, 4] == pytest.approx(erlang, abs=2e-4)


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
