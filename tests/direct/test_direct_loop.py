"""The compiled loop against the same cores stepped one by one, and what it promises."""

import tracemalloc

import numpy as np
import pytest

from steering_bringup.cores import build_cores
from steering_bringup.direct.runner import CONNECTIONS, delay_vector, run
from steering_bringup.scenario_files import load_node_set, load_scenario
from steering_plant.plant import PlantError

SYSTEMS = ("open_centre", "closed_centre")
TICKS = 700


def cores(system, name="on_centre", **parameters):
    scenario = load_scenario(name)
    update = {"duration": TICKS * 1e-3, "parameters": {**scenario.parameters, **parameters}}
    return build_cores(scenario.model_copy(update=update), load_node_set(system))


def by_hand(made, ticks, delays):
    """Step the cores one after another; every value a connection delays comes from a list."""
    seen: list = []
    torques: list = []
    lefts: list = []
    rights: list = []
    loads: list = []
    rest = made.plant.out.copy()
    forces = [0.0 if v is None else v.out[1] for v in (made.left, made.right)]

    def late(kept, tick, name, before):
        at = tick - delays.get(name, 0)
        return kept[at] if at >= 0 else before

    for tick in range(ticks):
        seen.append(made.plant.out.copy())

        def measured(node, tick=tick):
            torque = late(seen, tick, f"/steering/torque->{node}", rest)
            pressure = late(seen, tick, f"/steering/pressure->{node}", rest)
            rack = late(seen, tick, f"/steering/rack->{node}", rest)
            return (*torque[:3], *pressure[3:6], *rack[6:])

        torque_in = late(seen, tick, "/steering/torque->driver", rest)
        torques.append(made.driver.step(tick, *torque_in[:3])[0])
        for valve, kept, node in (
            (made.left, lefts, "valve_left"),
            (made.right, rights, "valve_right"),
        ):
            kept.append(0.0 if valve is None else valve.step(tick, *measured(node))[1])
        rack_in = late(seen, tick, "/steering/rack->vehicle", rest)
        loads.append(made.vehicle.step(tick, *rack_in[6:]).copy())
        if tick + 1 < ticks:
            made.plant.step(
                tick,
                late(torques, tick, "/driver/torque->plant", 0.0),
                late(lefts, tick, "/valve/left/command->plant", forces[0]),
                late(rights, tick, "/valve/right/command->plant", forces[1]),
                *late(loads, tick, "/vehicle/rack_force->plant", np.zeros(3)),
            )
    return np.array(seen), np.array(torques), np.array(lefts), np.array(loads)


DELAYS = [
    {},
    {"/driver/torque->plant": 1, "/vehicle/rack_force->plant": 2},
    {"/steering/torque->driver": 1, "/steering/rack->vehicle": 3, "/steering/rack->valve_left": 1},
    {"/valve/left/command->plant": 1, "/valve/right/command->plant": 1},
]


@pytest.mark.parametrize("delays", DELAYS, ids=[str(i) for i in range(len(DELAYS))])
@pytest.mark.parametrize("system", SYSTEMS)
def test_the_loop_is_the_cores_one_by_one_to_the_bit(system, delays):
    parameters = {"valve_controller.resonance": 350.0}
    seen, torques, lefts, loads = by_hand(cores(system, **parameters), TICKS, delays)
    trace = run(cores(system, **parameters), TICKS, delays)
    assert np.array_equal(np.hstack([trace.torque, trace.pressure, trace.rack]), seen)
    assert np.array_equal(trace.driver[:, 0], torques)
    assert np.array_equal(trace.load, loads)
    if system == "closed_centre":
        assert np.array_equal(trace.left_valve[:, 1], lefts)


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_run_repeats_to_the_bit(system):
    first, second = (run(cores(system), TICKS, truth=True) for _ in range(2))
    for topic, rows in first.topics().items():
        assert np.array_equal(rows, second.topics()[topic]), topic


def test_progress_and_the_truth_change_nothing():
    done: list[int] = []
    plain = run(cores("closed_centre"), TICKS)
    watched = run(cores("closed_centre"), TICKS, truth=True, on_progress=done.append)
    assert done[-1] == TICKS
    assert np.array_equal(plain.pressure, watched.pressure)
    assert watched.truth.shape == (TICKS, 8)
    assert np.all(np.diff(watched.truth[:, 7]) >= 0.0)


def test_topics_are_those_of_the_system():
    names = set(run(cores("open_centre"), 50).topics())
    assert "/valve/left/command" not in names
    assert {"/steering/torque", "/steering/pressure", "/vehicle/rack_force"} <= names


def test_an_unknown_connection_names_the_nearest():
    with pytest.raises(ValueError, match="did you mean '/driver/torque->plant'"):
        delay_vector({"/driver/torqe->plant": 1})


def test_a_negative_delay_is_refused():
    with pytest.raises(ValueError, match="must not be negative"):
        delay_vector({CONNECTIONS[0]: -1})


def test_the_plants_end_names_the_tick():
    """An unstable loop at a twentieth of the oil's stiffness ends with the plant's own text."""
    made = cores("closed_centre", **{"simulation.inner_steps": 1.0})
    made.plant.state[3] = 50.0
    with pytest.raises(PlantError, match=r"tick \d+\).*rack_position"):
        run(made, TICKS)


@pytest.mark.parametrize("system", SYSTEMS)
def test_memory_beside_the_trace_does_not_grow(system):
    beside = []
    for ticks in (2_000, 20_000):
        made = cores(system)
        tracemalloc.start()
        trace = run(made, ticks)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        whole = {id(a if a.base is None else a.base): a for a in vars(trace).values()}
        beside.append(peak - sum((a if a.base is None else a.base).nbytes for a in whole.values()))
    assert max(beside) < 50_000
