"""Nodes of a run that are started elsewhere, knowing no more than a copied file."""

import shutil

import pytest
from bench_process import Bench, wait_for

from steering_bringup.bags import first_difference, read_bag
from steering_lockstep.domain import claim_domain

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros


@pytest.fixture
def domain(monkeypatch):
    claim = claim_domain()
    number = claim.number
    claim.release()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
    return str(number)


def started(folder, domain, *words):
    """Start a run with an external node; return it and the file, copied to another folder."""
    run = Bench(
        *("run", "lane_keeping", "--duration", "1", "--domain", domain, "--out", "out", *words),
        *("--external", "lane_keeper"),
        folder=folder,
    )
    file = folder / "out" / "nodes.json"
    wait_for(file.exists)
    other = folder / "other"
    other.mkdir()
    shutil.copy(file, other)
    return run, other


def test_a_node_elsewhere_makes_the_same_bytes(tmp_path, domain):
    run, other = started(tmp_path, domain)
    node = Bench("node", "nodes.json", "lane_keeper", folder=other)
    status, out, err = run.finish()
    assert status == 0, err
    assert f"start: ROS_DOMAIN_ID={domain} ./steer node out/nodes.json lane_keeper" in out
    assert node.finish() == (0, "", "")
    words = ("run", "lane_keeping", "--duration", "1", "--direct", "--out", "direct")
    assert Bench(*words, folder=tmp_path).finish()[0] == 0
    one, other_bag = (tmp_path / n / "closed_centre_lane_keeping" for n in ("out", "direct"))
    assert first_difference(read_bag(one), read_bag(other_bag)) is None


def test_a_run_names_the_node_that_does_not_come(tmp_path, domain):
    run, _ = started(tmp_path, domain, "--wait", "12")
    status, _, err = run.finish()
    assert status == 1
    assert "not ready after 12 s" in err
    assert "/torque_overlay/lane_keeper: no publisher" in err


def test_a_node_names_the_run_that_does_not_come_and_the_one_that_goes(tmp_path, domain):
    run, other = started(tmp_path, domain, "--real-time", "--wait", "30", "--duration", "60")
    node = Bench("node", "nodes.json", "lane_keeper", "--timeout", "1", folder=other)
    bag = tmp_path / "out" / "closed_centre_lane_keeping"
    wait_for(bag.exists)
    wait_for(lambda: sum(f.stat().st_size for f in bag.glob("*.mcap")) > 100_000)
    run.process.terminate()
    run.finish()
    status, _, err = node.finish()
    assert status == 1
    assert "nothing for 1 s" in err
    assert "/vehicle/odometry of node 'vehicle'" in err
    alone = Bench("node", "nodes.json", "lane_keeper", "--wait", "1", folder=other)
    status, _, err = alone.finish()
    assert status == 1
    assert "not ready after 1 s: lane_keeper: /torque_overlay/lane_keeper: 0 of 2 readers" in err


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--external", "plant"), "stays with the run, as it is the clock"),
        (("--external", "recorder"), "writes its bag on this computer"),
        (("--external", "lane_keper"), "lane_keeper"),
    ],
)
def test_what_cannot_be_elsewhere_is_refused(words, reason, tmp_path):
    bench = Bench("run", "lane_keeping", "--domain", "7", *words, folder=tmp_path)
    status, _, err = bench.finish()
    assert status == 1
    assert reason in err
    assert len(err.splitlines()) == 1


def test_a_domain_must_be_agreed_on(tmp_path):
    _, _, err = Bench("run", "lane_keeping", "--external", "driver", folder=tmp_path).finish()
    assert "--domain N" in err
