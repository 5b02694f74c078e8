"""The source's rig, emulated, and its controllers through the bridge at gains that it allows."""

import math

import numpy as np
import pytest
from healthy_rig import EMULATED
from rig_links import both_ends
from rig_loop import Loop

from driver_model.driver import Driver
from driver_model.manoeuvres import make_manoeuvre
from pressure_control.load_force import LoadForceController
from pressure_control.load_loop import largest_load_gain
from pressure_control.servo_controller import ServoValveController
from rig_bridge.emulator.hand import Hand
from rig_bridge.emulator.rig import EmulatedRig
from rig_bridge.emulator.settings import load_settings
from rig_bridge.rig_file import load_rig
from rig_bridge.safety.machine import State
from rig_bridge.transport.packets import Demand, Order
from steering_core.errors import BenchError
from steering_core.parameters import load_parameters
from vehicle_model.loads import LOADS
from vehicle_model.vehicle import Vehicle

FILE = EMULATED.with_name("servo_rig.yaml")
SETTINGS = load_settings(EMULATED.with_name("emulator_servo.yaml"))
STILL, TICKS = 150, 3000
MANOEUVRES = {
    "on_centre": make_manoeuvre("on_centre", duration_s=3.0),
    "hold": make_manoeuvre("hold"),
}
DELAY = SETTINGS.command_delay + SETTINGS.sensors["rack_force"].delay
"""Ticks from a force to the period in which its command acts, more than in simulation."""


def servo_rig():
    rig = load_rig(FILE)
    short = {"check_ticks": 20, "check_timeout_ticks": 100, "entry_ticks": 20}
    return rig.model_copy(update={"watching": rig.watching.model_copy(update=short)})


class Bench:
    """Driver, valve controllers, vehicle and force control; ``commands`` for measurements."""

    def __init__(self, manoeuvre="on_centre", **changes):
        rig = load_rig(FILE)
        self.parameters = load_parameters().with_values({**rig.parameters, **changes})
        p, total = self.parameters, STILL + TICKS
        self.driver = Driver(p, MANOEUVRES[manoeuvre], total)
        held = np.zeros(STILL)
        self.driver.reference = np.concatenate([held, self.driver.reference])
        self.driver.hands_on = np.concatenate([held + 1.0, self.driver.hands_on])
        self.vehicle = Vehicle(p, LOADS["bicycle"](), total)
        self.left, self.right = (ServoValveController(p, side) for side in ("left", "right"))
        self.force = LoadForceController(p)
        self.rest = (0.0, *self.left.out, *self.right.out, 0.0, 0.0)
        self.names = (
            "driver_torque",
            "left_reference_pressure",
            "left_valve_opening",
            "right_reference_pressure",
            "right_valve_opening",
            "load_reference_force",
            "load_valve_opening",
        )

    def commands(self, tick, measured):
        torque = self.driver.step(tick, *measured[:3])[0]
        wanted = self.vehicle.step(tick, *measured[6:])
        left, right = (v.step(tick, *measured).copy() for v in (self.left, self.right))
        force = self.force.step(tick, *measured[6:], *wanted)
        return dict(zip(self.names, (torque, *left, *right, *force), strict=True))

    def at_rest(self):
        return dict(zip(self.names, self.rest, strict=True))


def driven(bench, ticks=TICKS, settings=SETTINGS):
    """Drive through the bridge: the rig's true outputs, the commands, and the loop at its end."""
    with both_ends("udp", rig=servo_rig()) as (bench_end, rig_end):
        loop = Loop(bench_end, rig_end, table=servo_rig(), settings=settings)
        for _ in range(STILL):
            reply = loop.tick(bench.at_rest())
        measured, true, sent = np.array(list(reply.measured.values())), [], []
        for tick in range(ticks):
            asked = bench.commands(tick, measured)
            reply = loop.tick(asked)
            measured = np.array(list(reply.measured.values()))
            true.append(loop.rig.plant.out.copy())
            sent.append(list(asked.values()))
        return np.array(true), np.array(sent), loop


@pytest.mark.parametrize("kind", ["udp", "can"])
def test_every_command_passes_each_link(kind):
    rig = servo_rig()
    asked = dict(zip(Bench().names, (3.0, 5.5e6, -0.05, 6e6, 0.1, -200.0, 0.02), strict=True))
    values = tuple(asked[name] for name in rig.commanded)
    with both_ends(kind, rig=rig) as (bench_end, rig_end):
        bench_end.send_demand(Demand(9, 7, Order.RUN, values))
        (got,) = rig_end.receive_demands(10.0)
    scales = [channel.scale for channel in rig.rows(rig.commanded)]
    assert np.all(np.abs(np.subtract(got.values, values)) <= scales)


def test_the_rig_starts_with_empty_chambers_and_without_load():
    rig = EmulatedRig(servo_rig(), SETTINGS, 32)
    out = rig.plant.out
    assert out[3] < 1e5
    assert out[4] < 1e5
    assert abs(out[8]) < 50.0
    assert rig.tick == 0


@pytest.mark.slow
def test_the_source_s_rig_is_driven_through_the_bridge():
    """Pressures, load and torque follow; nothing is limited and nothing trips."""
    true, sent, loop = driven(Bench())
    assert loop.state is State.RUNNING, loop.bridge.report()
    reference = sent[:-1, 3] - sent[:-1, 1]
    load_pressure = true[1:, 4] - true[1:, 3]
    assert np.abs(load_pressure).max() > 15e5
    assert np.std(load_pressure - reference) < 2.5e5
    assert np.abs(sent[:, 5]).max() > 1000.0
    assert np.std(true[:, 8] - sent[:, 5]) < 250.0


def restless(**changes):
    """Size of the load's movement while the wheel is held, and the loop."""
    true, _, loop = driven(Bench("hold", **changes), ticks=600)
    return np.ptp(true[-200:, 8]), loop


def test_the_simulation_s_gain_is_a_limit_cycle_on_the_rig():
    """As the sampled loop has it with the delay as argument; with the rig's own it is quiet."""
    rig, simulated = Bench().parameters, load_parameters()
    held = rig["mechanics.torsion_bar_stiffness"] * rig["mechanics.gear_ratio"] ** 2
    gain = simulated["load_force_controller.gain"]
    assert largest_load_gain(simulated, held) > 3.0 * gain
    assert largest_load_gain(simulated, held, DELAY) < 0.6 * gain
    assert largest_load_gain(rig, held, DELAY) > 2.0 * rig["load_force_controller.gain"]
    quiet, loop = restless()
    assert loop.state is State.RUNNING
    assert quiet < 120.0
    names = ("load_force_controller.gain", "load_force_controller.speed_lowpass")
    assert restless(**{name: simulated[name] for name in names})[0] > 5.0 * quiet


def test_a_fault_empties_the_chambers_and_relieves_the_load():
    """Commands stay away while the rack is loaded: tank, no load, and a free wheel."""
    bench = Bench()
    with both_ends("udp", rig=servo_rig()) as (bench_end, rig_end):
        loop = Loop(bench_end, rig_end, table=servo_rig(), settings=SETTINGS)
        loop.started(bench.at_rest())
        loaded = bench.at_rest() | {"load_valve_opening": 0.02}
        for _ in range(5):
            loop.tick(loaded)
        assert abs(loop.rig.plant.out[8]) > 100.0
        for _ in range(150):
            loop.tick(loaded, answers=False)
    assert loop.rig.watchdog.latched
    assert loop.rig.plant.out[3:5].max() < 1e5
    assert abs(loop.rig.plant.out[8]) < 80.0


def test_a_hand_on_the_wheel_is_the_same_in_every_run():
    hand = Hand.model_validate(
        {"amplitude_deg": 10.0, "final_frequency_hz": 1.0, "duration_s": 0.5, "start_s": 0.1}
    )
    settings = SETTINGS.model_copy(update={"hand": hand})
    one, two = (driven(Bench(), ticks=700, settings=settings)[0] for _ in range(2))
    assert np.array_equal(one, two)
    assert np.degrees(np.abs(one[:, 0]).max()) == pytest.approx(10.0, abs=1.0)
    assert hand.angle(0.05) == 0.0
    # Half a second of sweep make a quarter of a cycle, and then it goes on at 1 Hz.
    assert hand.angle(0.6) == pytest.approx(math.radians(10.0))
    assert hand.angle(1.1) == pytest.approx(-math.radians(10.0))


def test_effects_make_another_rig():
    """What only the rig knows, from its own file: leakage across the piston."""
    leaking = SETTINGS.model_copy(update={"effects": {"cross_piston_leakage": {"leakage": 2e-12}}})
    plain, other = (driven(Bench(), ticks=300, settings=s)[0] for s in (SETTINGS, leaking))
    assert not np.array_equal(plain, other)


def test_the_original_open_centre_valve_is_a_rig_of_its_own():
    """Shipped with its own files: pump pressure shared by both chambers, and no valve commands."""
    rig = load_rig(EMULATED.with_name("open_centre_rig.yaml"))
    settings = load_settings(EMULATED.with_name("emulator_open_centre.yaml"))
    emulated = EmulatedRig(rig, settings, 32)
    assert rig.commanded == ("driver_torque", "load_reference_force", "load_valve_opening")
    assert 4e5 < emulated.plant.out[3] < 6e5
    assert abs(emulated.plant.out[8]) < 50.0
    emulated.step([])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("effects: {cross_piston_leak: {}}", "cross_piston_leakage"),
        ("effects: {tyre_relaxation: {}}", "acts in the vehicle"),
        ("effects: {cross_piston_leakage: {leakage: -1.0}}", "must be between"),
        ("valve_system: servo", "servo_valve"),
        ("hand: {amplitude: 3.0}", "amplitude_deg"),
    ],
)
def test_bad_settings_are_refused_in_one_line(tmp_path, text, says):
    path = tmp_path / "emulator.yaml"
    path.write_text(text)
    with pytest.raises(BenchError, match=says):
        load_settings(path)


def test_impossible_parameters_are_refused():
    small = SETTINGS.model_copy(update={"parameters": {"load_cylinder.chamber_volume": 1e-6}})
    with pytest.raises(BenchError, match=r"servo_rig.*load_cylinder\.chamber_volume"):
        EmulatedRig(servo_rig(), small, 32)
