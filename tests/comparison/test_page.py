"""The page is one file that loads nothing, and shows what it should."""

import base64
import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from steering_bringup.comparison import compare, comparison_page, write_page
from steering_bringup.errors import BenchError
from steering_bringup.pages import Axes, Curve, Figure, Page, paragraph
from steering_bringup.pages.arrays import thin


def _figures(text: str) -> dict:
    found = re.search(r"const FIGURES=(\{.*?\});\"use strict\"", text, re.DOTALL)
    assert found
    return json.loads(found[1])


def _own_text(text: str) -> str:
    """The page without the plot library, which holds addresses that it does not load."""
    longest = max(re.findall(r"<script>.*?</script>", text, re.DOTALL), key=len)
    return text.replace(longest, "")


def _values(packed: dict) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed["bdata"]), packed["dtype"])


def test_nothing_is_loaded_from_elsewhere(pair):
    text = comparison_page(compare(*pair)).render()
    own = _own_text(text)
    assert not re.search(r"https?://|//cdn|@import|url\(", own)
    assert not re.search(r"<(script|img|iframe|link)[^>]*(src|href)=(?!'data:)", own)
    assert "default-src 'none'" in own
    assert "showSendToCloud: false" in own
    assert text.count("<script>") == 2


def test_figures_come_in_the_sources_order_with_units(pair):
    text = comparison_page(compare(*pair)).render()
    titles = re.findall(r"<h3>(.*?)</h3>", text)
    numbers = [m[1] for t in titles if (m := re.search(r"as figure (8\.\d)", t))]
    assert numbers == ["8.2", "8.3", "8.4", "8.5"]
    assert titles[-1] == "Supply and energy"
    for figure in _figures(text).values():
        for name, axis in figure["layout"].items():
            if re.match(r"[xy]axis", name):
                assert re.search(r"\[.+\]$", axis["title"]["text"])


@pytest.mark.parametrize("swapped", [False, True])
def test_open_centre_is_dashed_and_closed_centre_solid(pair, swapped):
    first, second = reversed(pair) if swapped else pair
    figures = _figures(comparison_page(compare(first, second)).render())
    dashes = {
        (trace["name"], trace["line"]["dash"])
        for figure in figures.values()
        for trace in figure["data"]
        if trace["name"]
    }
    assert dashes == {("open-centre", "dash"), ("closed-centre", "solid")}


def test_plotted_values_are_the_signals(pair):
    result = compare(*pair)
    trace = _figures(comparison_page(result).render())["figure-3"]["data"][0]
    shown = _values(trace["y"])
    error = result.error("steering_wheel_torque")
    assert shown.max() == pytest.approx(error.max(), rel=1e-6)
    assert shown.min() == pytest.approx(error.min(), rel=1e-6)
    at = _values(trace["x"]).astype(float)
    assert np.allclose(np.interp(at, result.time, error), shown, atol=1e-5)


def test_key_numbers_and_metadata_are_on_the_page(pair):
    own = _own_text(comparison_page(compare(*pair)).render())
    assert "steers like" in own
    assert "0.40 <span class='unit'>bar" in own
    assert "38% less than open-centre" in own
    assert own.count("mechanics.rack_mass") == 2


def test_a_long_run_stays_small(make_run, tmp_path):
    runs = [make_run(f"long{c}", closed=c, duration=60.0) for c in (False, True)]
    path = write_page(compare(*runs), tmp_path / "page.html")
    assert path.stat().st_size < 8e6


def test_names_cannot_break_the_page():
    evil = "</script><script>alert('x')</script>"
    page = Page(title=evil, lead=evil)
    page.add(paragraph(evil))
    line = Curve(np.arange(3.0), np.arange(3.0), name=evil)
    page.add(Figure(evil, [[Axes("t [s]", "x [m]", [line], evil)]], evil))
    own = _own_text(page.render())
    assert "<script>alert" not in own
    assert _figures(page.render())["figure-1"]["data"][0]["name"] == evil


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BenchError, match=r"file/page\.html"):
        Page("t").write(tmp_path / "file" / "page.html")


@given(st.integers(1, 20_000), st.integers(10, 500), st.integers(0, 1000))
def test_thinning_keeps_the_extremes(count, most, seed):
    y = np.random.default_rng(seed).normal(size=count)
    x, kept = thin(np.arange(float(count)), y, most)
    assert len(x) <= most + 2 * (-(-2 * count // most)) + 2
    assert (kept.max(), kept.min()) == (y.max(), y.min())
    assert np.all(np.diff(x) > 0)
    assert np.array_equal(y[x.astype(int)], kept)
    assert (x[0], x[-1]) == (0.0, count - 1.0)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("chromium") is None, reason="no browser on this machine")
def test_a_browser_draws_every_figure(pair, tmp_path):
    path = write_page(compare(*pair), tmp_path / "page.html")
    command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"]
    command += ["--disable-background-networking", "--disable-component-update", "--disable-sync"]
    command += [f"--user-data-dir={tmp_path / 'profile'}", "--window-size=1366,6000"]
    command += ["--virtual-time-budget=20000", "--enable-logging=stderr", "--dump-dom"]
    done = subprocess.run(
        [*command, path.as_uri()], capture_output=True, text=True, timeout=120, check=True
    )
    assert done.stdout.count("js-plotly-plot") >= 6
    assert done.stdout.count('class="main-svg"') >= 12
    assert "Uncaught" not in done.stderr
    assert "Refused to" not in done.stderr
