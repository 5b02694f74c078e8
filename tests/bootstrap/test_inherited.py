"""What a person's shell brings along: left out, refused in one line, or made usable."""

import os
from pathlib import Path

import pytest

from bootstrap import inherited, variables
from bootstrap.errors import SetupError
from bootstrap.layout import Layout

ENV, WS = Path("/p/.steer/env-1"), Path("/p/.steer/ws-1")


def run_in(base, folder, **changes):
    layout = Layout(folder)._replace(**changes)
    return variables.for_run(layout, ENV, WS, base)


@pytest.mark.parametrize(
    "name",
    [
        "RMW_IMPLEMENTATION",
        "RCL_ASSERT_RMW_ID_MATCHES",
        "CYCLONEDDS_URI",
        "ZENOH_CONFIG_OVERRIDE",
        "RCUTILS_CONSOLE_OUTPUT_FORMAT",
        "RMW_FASTRTPS_PUBLICATION_MODE",
        "NUMBA_DISABLE_JIT",
        "PYTHONWARNINGS",
        "PYTHONOPTIMIZE",
        "PYTHONINSPECT",
        "PYTHONSTARTUP",
        "PYTHONPLATLIBDIR",
        "ROS_DISCOVERY_SERVER",
        "ROS_SECURITY_ENABLE",
        "ROS_SECURITY_STRATEGY",
        "ROS_LOCALHOST_ONLY",
    ],
)
def test_it_is_left_out(name, tmp_path):
    assert name not in run_in({name: "x"}, tmp_path)


@pytest.mark.parametrize("name", ["PYTHONHASHSEED", "ROS_DOMAIN_ID", "ROS_STATIC_PEERS", "LANG"])
def test_it_is_kept(name, tmp_path):
    assert run_in({name: "1"}, tmp_path)[name] == "1"


def test_pip_and_colcon_do_not_see_it_either(tmp_path):
    assert "PYTHONWARNINGS" not in variables.for_build(
        Layout(tmp_path), ENV, {"PYTHONWARNINGS": "error"}
    )


def test_a_sourced_ros_keeps_its_middleware_and_what_asserts_it(tmp_path):
    base = {"RMW_IMPLEMENTATION": "rmw_x", "RCL_ASSERT_RMW_ID_MATCHES": "rmw_x"}
    assert base.items() <= run_in(base, tmp_path, system_ros=True).items()


def test_a_discovery_server_is_kept_where_others_may_listen(tmp_path):
    base = {"ROS_DISCOVERY_SERVER": "10.0.0.1:11811", inherited.RANGE: "SUBNET"}
    assert base.items() <= run_in(base, tmp_path).items()


def test_localhost_only_stays_on_this_computer(tmp_path):
    base = {"ROS_LOCALHOST_ONLY": "1", inherited.RANGE: "SUBNET"}
    assert run_in(base, tmp_path)[inherited.RANGE] == "LOCALHOST"


@pytest.mark.parametrize(
    ("base", "named"),
    [
        ({inherited.RANGE: "localhost"}, inherited.RANGE),
        ({inherited.PROFILE: "/no/such.xml"}, inherited.PROFILE),
        ({"ROS_SECURITY_ENABLE": "true", inherited.RANGE: "SUBNET"}, "ROS_SECURITY_ENABLE"),
    ],
)
def test_what_is_not_clear_or_not_secured_is_refused(base, named, tmp_path):
    with pytest.raises(SetupError, match=named) as caught:
        run_in(base, tmp_path)
    assert "\n" not in str(caught.value)


def test_an_own_profile_that_can_be_read_is_kept(tmp_path):
    profile = tmp_path / "mine.xml"
    profile.touch()
    assert run_in({inherited.PROFILE: str(profile)}, tmp_path)[inherited.PROFILE] == str(profile)


@pytest.mark.parametrize("threads", ["abc", "", "0", "-2", "2.5", "²"])
def test_a_number_of_threads_that_is_none_counts_as_one(threads, tmp_path):
    assert run_in({"OMP_NUM_THREADS": threads}, tmp_path)["OMP_NUM_THREADS"] == "1"


@pytest.mark.parametrize(
    "base",
    [{}, {"HOME": "/proc/none"}, {"ROS_HOME": "/dev/null"}, {"ROS_LOG_DIR": "/proc/1/x"}],
    ids=str,
)
def test_ros_gets_a_log_folder_that_can_be_written(base, tmp_path):
    folder = Path(run_in(base, tmp_path)["ROS_LOG_DIR"])
    (folder / "log").touch()
    assert folder == tmp_path / ".steer" / "log" / "ros"


def test_in_a_read_only_checkout_the_log_folder_is_a_temporary_one(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    folder = Path(run_in({}, Path("/proc/none"))["ROS_LOG_DIR"])
    assert folder.parent == tmp_path
    assert folder.is_dir()


@pytest.mark.parametrize("name", ["HOME", "ROS_HOME", "ROS_LOG_DIR"])
def test_a_usual_log_folder_stays_and_nothing_is_made_there(name, tmp_path):
    home = tmp_path / "home"
    home.mkdir()
    assert run_in({name: str(home)}, tmp_path).get("ROS_LOG_DIR") == (
        str(home) if name == "ROS_LOG_DIR" else None
    )
    assert not list(home.iterdir())


def test_the_terminal_s_encoding_stays_and_replaces(tmp_path):
    given = run_in({"PYTHONIOENCODING": "ascii:strict"}, tmp_path)
    assert given["PYTHONIOENCODING"] == "ascii:replace"
    assert run_in(given, tmp_path)["PYTHONIOENCODING"] == "ascii:replace"
    assert given["PYTHONUTF8"] == "1"


def test_the_bench_s_own_middleware_settings_survive_a_second_time(tmp_path):
    base = {"HOME": os.fspath(tmp_path), inherited.RANGE: "SUBNET"}
    once = run_in(base, tmp_path)
    assert run_in(once, tmp_path) == once
