"""Chattering, lag, latency and tolerances: what the linear models predict happens in simulation."""

import json
import os

import numpy as np
import pytest
from dask_here import dask_executor

from steering_bringup.cli import main
from steering_core.parameters import load_parameters
from steering_studies import parallel
from steering_studies.linear import chattering, lag, source_figures, tolerance
from steering_studies.linear.latency import latency_map
from steering_studies.linear.systems import compare, limit_cycle

PARAMETERS = load_parameters()


@pytest.mark.parametrize("onset", [chattering.gain_onset, chattering.motion_onset])
def test_chattering_begins_where_the_linear_gear_says(onset):
    found = onset(PARAMETERS, 3.0)
    assert found.simulated == pytest.approx(found.predicted, rel=0.03)
    assert 70.0 < found.frequency < 120.0


def test_catch_up_begins_where_the_static_map_says():
    found = lag.catch_up(PARAMETERS)
    assert found.onset_simulated == pytest.approx(found.onset_predicted, rel=0.03)
    assert found.onset_predicted == pytest.approx(0.0587, rel=0.02)


def test_dynamic_lag_of_the_simulation_is_the_linear_models():
    found = lag.dynamic_lag(PARAMETERS)
    np.testing.assert_allclose(found.simulated, found.predicted, rtol=0.07)
    assert np.all(np.diff(found.predicted) < 0.0)


def test_map_has_every_node_set_and_the_gain_falls_with_the_first_ticks():
    plain, known, servo = latency_map(PARAMETERS, (0, 1, 2), simulate=False)
    assert np.all(np.diff(plain.predicted) < 0.0)
    assert np.all(np.diff(servo.predicted) < 0.0)
    assert known.predicted[1] > 1.5 * plain.predicted[1]
    assert np.all(np.isnan(plain.simulated))


def test_one_late_tick_cycles_plain_and_is_quiet_when_known():
    """At 1300 rad/s with commands one tick late (the plain limit is 890)."""
    fast = PARAMETERS.with_values({"valve_controller.resonance": 1300.0})
    known = fast.with_values({"valve_controller.delay_compensation": 1.0})
    assert limit_cycle(fast, delay=1)
    assert not limit_cycle(known, delay=1)
    assert compare(known, delay=1).driver_torque < 0.11


def test_same_seed_same_specimens_on_any_executor():
    """Dask's executor stands for a distributed engine."""
    here = tolerance.figures_of(PARAMETERS, tolerance.specimens(PARAMETERS, 2, 7)[1])
    with dask_executor() as executor:
        found = tolerance.monte_carlo(PARAMETERS, 2, 7, executor=executor)
    np.testing.assert_array_equal(found.figures[1], here)
    assert found.figures.shape == (2, len(tolerance.FIGURES))


def test_specimens_stay_within_three_standard_deviations():
    rows = tolerance.specimens(PARAMETERS, 50, 3)
    for name in rows[0]:
        wide = 1.5 * PARAMETERS.info(name).tolerance
        ratio = np.array([row[name] for row in rows]) / PARAMETERS[name]
        assert np.all(np.abs(ratio - 1.0) <= wide + 1e-12)


def test_every_figure_of_the_source_has_its_function():
    wanted = [
        "4.3",
        "4.5",
        "4.6",
        "4.7",
        "6.5",
        "6.6",
        "6.7",
        "6.11",
        "6.12",
        "7.6",
        "7.7",
        "8.1",
        "8.2",
        "8.3",
        "8.4",
        "8.5",
        "8.6",
    ]
    assert list(source_figures.FIGURES) == wanted
    static = source_figures.FIGURES["4.3"](PARAMETERS)
    np.testing.assert_allclose(static.load_pressure[-1][[0, 25, 50]] / 1e5, [276, 91, -1], atol=1)
    loop = source_figures.FIGURES["6.11"](PARAMETERS).margins()
    # more phase margin at low torque than at high, as the source says of both
    assert loop[0].phase > loop[4].phase + 20.0
    step = source_figures.FIGURES["8.1"](PARAMETERS)
    assert step.closed[0] / 1e5 == pytest.approx(4.9, abs=0.5)
    assert step.closed[-1] / 1e5 == pytest.approx(15.5, abs=0.5)
    assert step.rise(step.closed) <= step.rise(step.opened) + 1e-3


def test_command_writes_page_and_numbers(tmp_path, capsys):
    numbers = tmp_path / "n.json"
    status = main(["linear", "chattering", "--out", str(tmp_path), "--json", str(numbers)])
    assert status == 0
    assert "motion against the assistance, 3 N m" in capsys.readouterr().out
    assert (tmp_path / "linear.html").stat().st_size > 1000
    assert len(json.loads(numbers.read_text())["chattering"]["onsets"]) == 6
    assert main(["linear", "chatering"]) == 1
    assert "did you mean 'chattering'" in capsys.readouterr().err


def test_without_shared_memory_the_specimens_are_computed_here(monkeypatch, capsys):
    def refused(*arguments: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(parallel, "ProcessPoolExecutor", refused)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    figures = [0.0] * len(tolerance.FIGURES)
    monkeypatch.setattr(tolerance, "figures_of", lambda parameters, specimen: figures)
    told: list[int] = []
    found = tolerance.monte_carlo(PARAMETERS, 1, 7, on_progress=told.append)
    assert told == [1]
    assert found.figures.shape == (1, len(tolerance.FIGURES))
    assert "/dev/shm" in capsys.readouterr().err
