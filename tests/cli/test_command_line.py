"""The command line as a user meets it: exit statuses, one-line errors, quick lists."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from steering_bringup.cli import COMMANDS, main

HEAVY = ("rclpy", "numba", "plotly", "rosbags", "scipy")


def steer(*words: str, folder: Path | None = None, **options) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "steering_bringup.cli", *words]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    return subprocess.run(
        command, capture_output=True, text=True, cwd=folder, env=environment, timeout=120, **options
    )


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command, capsys):
    with pytest.raises(SystemExit) as caught:
        main([command, "--help"])
    assert caught.value.code == 0
    shown = capsys.readouterr().out
    assert "example" in shown
    assert f"steer {command}" in shown


@pytest.mark.parametrize("words", [["--help"], ["list"], ["list", "parameters", "valve*"]])
def test_help_and_lists_import_nothing_heavy(words):
    probe = (
        "import sys\nfrom steering_bringup.cli import main\n"
        f"try:\n    main({words!r})\nexcept SystemExit:\n    pass\n"
        f"print('LOADED', [m for m in {HEAVY!r} if m in sys.modules])"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, "-c", probe], capture_output=True, text=True, env=environment, timeout=60
    )
    assert "LOADED []" in done.stdout, done.stdout + done.stderr


def test_the_list_is_there_in_well_under_a_second():
    times = []
    for _ in range(3):
        start = time.perf_counter()
        assert steer("list").returncode == 0
        times.append(time.perf_counter() - start)
    assert min(times) < 1.0


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["rnu"], "unknown command 'rnu'; did you mean 'run'?"),
        (
            ["run", "--procesess", "one"],
            "unknown option '--procesess'; did you mean '--processes'?",
        ),
        (["list", "scenario"], "unknown list 'scenario'; did you mean 'scenarios'?"),
        (["compare", "only_one"], "DATA"),
    ],
)
def test_a_slip_in_the_command_is_status_2_and_one_line(words, expected, capsys):
    with pytest.raises(SystemExit) as caught:
        main(words)
    assert caught.value.code == 2
    error = capsys.readouterr().err
    assert expected in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["drypark"], "did you mean 'dry_park'"),
        (["no/such.yaml"], "there is no scenario file"),
        (["--set", "rack_mass=3"], "did you mean 'mechanics.rack_mass'"),
        (["--set", "mechanics.rack_mass=-3"], "must be greater than 0 kg"),
        (["--set", "open_centre.chamber_volume=1e-6"], "open_centre.chamber_volume"),
        (["--set-file", "no.yaml"], "there is no file 'no.yaml'"),
        (["--duration", "0"], "duration"),
        (["--node-set", "open_center"], "did you mean 'open_centre'"),
        (["--manoeuvre", "weeve"], "did you mean 'weave'"),
        (["--load", "dri_park"], "did you mean 'dry_park'"),
        (["--delay", "/driver/torqe->plant=1"], "did you mean '/driver/torque->plant'"),
        (["--direct", "--real-time"], "leave out"),
        (["--timeout", "-1"], "--timeout"),
        (["--record", "bag"], "use --out"),
        (["--node-set", "closed_centre", "--set", "valve_controller.resonance=1e5"], "unstable"),
    ],
)
def test_what_cannot_run_is_refused_before_anything_starts(words, expected, tmp_path):
    done = steer("run", *words, folder=tmp_path)
    assert done.returncode == 1
    said = [line for line in done.stderr.splitlines() if not line.startswith("compiling")]
    assert len(said) == 1
    assert said[0].startswith("steer run: ")
    assert expected in said[0]
    assert not list(tmp_path.iterdir())


def test_an_existing_bag_is_not_overwritten(tmp_path):
    (tmp_path / "bag").mkdir()
    done = steer("run", "step", "--direct", "--record", "bag", folder=tmp_path)
    assert done.returncode == 1
    assert "'bag' exists already" in done.stderr


@pytest.mark.skipif(os.getuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission_is_named(tmp_path):
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    done = steer("run", "step", "--direct", "--out", str(locked / "here"))
    assert done.returncode == 1
    assert "locked" in done.stderr


def test_a_file_in_the_place_of_a_folder_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    done = steer("run", "step", "--direct", "--out", str(tmp_path / "file" / "here"))
    assert done.returncode == 1
    assert f"{tmp_path / 'file'}" in done.stderr


def test_debug_shows_the_traceback(tmp_path):
    assert "Traceback" not in steer("run", "drypark", folder=tmp_path).stderr
    assert "Traceback" in steer("run", "drypark", "--debug", folder=tmp_path).stderr


def test_a_reader_that_leaves_early_is_no_error():
    words = [sys.executable, "-m", "steering_bringup.cli", "list", "parameters"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    with subprocess.Popen(
        words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""


def test_lists_for_machines(tmp_path):
    file = tmp_path / "list.json"
    assert main(["list", "parameters", "rack_mass", "--json", str(file)]) == 0
    (entry,) = json.loads(file.read_text())["parameters"]
    assert (entry["name"], entry["unit"]) == ("mechanics.rack_mass", "kg")


def test_the_json_schema_is_written(tmp_path):
    assert main(["schema", "--out", str(tmp_path / "schemas")]) == 0
    names = {path.name for path in (tmp_path / "schemas").iterdir()}
    assert names == {"scenario.schema.json", "node_set.schema.json", "rig.schema.json"}
