"""The benchmark of the same name for a few seconds: at 1 kHz nothing is lost, by tick."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("rclpy")
pytestmark = pytest.mark.ros

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "record_while_playing.py"
SECONDS = 4


def test_nothing_is_lost(tmp_path):
    numbers = tmp_path / "numbers.json"
    words = [str(BENCHMARK), "--seconds", str(SECONDS), "--json", str(numbers)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, *words], env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stdout + done.stderr
    result = json.loads(numbers.read_text())
    recorded = result["recorded"]
    assert len(recorded["missing"]) == 10
    assert recorded["messages"] == SECONDS * (8 * 1000 + 2 * 100)
    assert set(recorded["missing"].values()) == {0}
    for topic in result["played"]["listener"].values():
        assert topic["lost"] == 0
        assert topic["received"] >= 500 * SECONDS
