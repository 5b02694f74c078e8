"""A run with an arbiter leaves a page with what was asked, applied and why they differ."""

import json

import numpy as np

from steering_bringup.cli import main
from steering_bringup.overlay_page import _bars


def test_a_lane_keeping_run_leaves_its_page(tmp_path):
    words = ("lane_keeping", "--direct", "--duration", "2", "--json", str(tmp_path / "out.json"))
    assert main(["run", *words, "--out", str(tmp_path / "run")]) == 0
    page = (tmp_path / "run" / "overlay.html").read_text()
    assert json.loads((tmp_path / "out.json").read_text())["pages"] == [
        str(tmp_path / "run" / "overlay.html")
    ]
    for text in ("Farthest from the lane", "Asked and applied", "Authority", "Jerk [m"):
        assert text in page
    assert "NaN" not in page.split("const FIGURES=")[1].split(";")[0]


def test_a_run_without_overlays_leaves_none(tmp_path):
    words = ("step", "--direct", "--duration", "1", "--node-set", "closed_centre")
    assert main(["run", *words, "--out", str(tmp_path)]) == 0
    assert not list(tmp_path.glob("*.html"))


def test_reasons_are_bars_that_can_be_seen():
    time = np.arange(10_000) * 1e-3
    on = np.zeros(10_000, bool)
    on[[5, 7, 9]], on[3000:4000], on[9999] = True, True, True
    bars = _bars(time, on, 1.0, "", "").x.reshape(-1, 3)
    np.testing.assert_allclose(bars[:, 0], [0.005, 3.0, 9.999])
    np.testing.assert_allclose(bars[:, 1] - bars[:, 0], [0.024, 1.019, 0.02], atol=1e-3)
