"""Places that cannot be written: refused before the work, named after it."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from steering_bringup.cli import main
from steering_bringup.outputs import check_file, check_folder, write_json
from steering_core.errors import BenchError

FULL = Path("/dev/full")


@pytest.mark.parametrize("command", [["diagnose", "a.csv"], ["compare", "a.csv", "b.csv"]])
def test_a_file_in_the_place_of_the_folder_is_told_before_anything_is_read(
    command, tmp_path, capsys
):
    file = tmp_path / "out"
    file.write_text("kept")
    for out in (file, file / "inside"):
        assert main([*command, "--out", str(out)]) == 1
        told = capsys.readouterr().err
        assert f"'{file}'" in told
        assert "is a file" in told
        assert told.count("\n") == 1
    assert file.read_text() == "kept"


def test_a_folder_in_the_place_of_a_file_is_told_before_the_work(tmp_path, capsys):
    assert main(["list", "--json", str(tmp_path)]) == 1
    streams = capsys.readouterr()
    assert f"'{tmp_path}' is a folder" in streams.err
    assert not streams.out


def test_what_can_be_written_passes_and_is_not_made_yet(tmp_path):
    check_folder(tmp_path / "a" / "b")
    check_file(tmp_path / "c" / "d.json")
    assert not list(tmp_path.iterdir())
    write_json(tmp_path / "c" / "d.json", {"x": 1})
    check_file(tmp_path / "c" / "d.json")
    assert json.loads((tmp_path / "c" / "d.json").read_text()) == {"x": 1}


@pytest.mark.skipif(not FULL.exists(), reason="no /dev/full on this system")
def test_a_full_disk_is_named_with_the_file():
    with pytest.raises(BenchError, match="'/dev/full' cannot be written: No space left"):
        write_json(FULL, {})


@pytest.mark.skipif(not FULL.exists(), reason="no /dev/full on this system")
def test_a_full_standard_output_is_named():
    code = "import sys; from steering_bringup.cli import main; sys.exit(main(['list']))"
    with FULL.open("w") as full:
        ended = subprocess.run(
            [sys.executable, "-c", code],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert ended.returncode == 1
    assert ended.stderr == (
        "steer list: standard output cannot be written: No space left on device\n"
    )
