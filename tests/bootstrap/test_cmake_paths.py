"""Paths of the wheels' build machine are replaced, and nothing else."""

import hashlib
import sys
from pathlib import Path

import pytest

from bootstrap import cmake_paths

HEADERS, NUMPY = "/usr/include/python3.X", r"/env/site-packages/numpy\1/_core/include"


@pytest.mark.parametrize("version", ["3.11", "3.12", "3.13"])
@pytest.mark.parametrize("core", ["core", "_core"])
def test_both_paths_are_replaced(tmp_path, version, core):
    base = "/opt/python/cp{0}-cp{0}".format(version.replace(".", ""))
    file = tmp_path / "std_msgs" / "cmake" / "export.cmake"
    file.parent.mkdir(parents=True)
    file.write_text(
        f'set(x "{base}/include/python{version};'
        f'{base}/lib/python{version}/site-packages/numpy/{core}/include;/usr/include")\n'
    )
    changed = cmake_paths.fix(tmp_path, HEADERS, NUMPY)
    assert file.read_text() == f'set(x "{HEADERS};{NUMPY};/usr/include")\n'
    assert changed == {str(file): hashlib.sha256(file.read_bytes()).hexdigest()}


def test_other_files_stay_and_a_second_time_changes_nothing(tmp_path):
    plain = tmp_path / "plain.cmake"
    plain.write_bytes(b"set(name \xff)\n")
    text = tmp_path / "readme.txt"
    text.write_text("/opt/python/cp311-cp311/include/python3.11\n")
    times = [file.stat().st_mtime_ns for file in (plain, text)]
    assert cmake_paths.fix(tmp_path, HEADERS, NUMPY) == {}
    assert [file.stat().st_mtime_ns for file in (plain, text)] == times


def test_includes_come_from_the_environment_itself():
    headers, numpy = cmake_paths.includes_of(Path(sys.executable), {})
    assert headers.endswith(f"python{sys.version_info[0]}.{sys.version_info[1]}")
    assert numpy.endswith("include")
