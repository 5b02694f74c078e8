"""Percentiles of the latency against numpy's."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rig_bridge.latency import Latency


def test_nothing_yet():
    assert Latency().report() == {"p50": 0.0, "p99": 0.0, "max": 0.0, "ticks": 0, "late": 0}


@settings(suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(st.lists(st.integers(0, 5_000_000), min_size=1, max_size=300))
def test_percentiles_to_a_microsecond(latencies):
    latency = Latency()
    for value in latencies:
        latency.add(value)
    report = latency.report()
    for name, share in (("p50", 0.5), ("p99", 0.99)):
        exact = np.quantile(latencies, share, method="inverted_cdf") * 1e-9
        assert exact - 1e-12 <= report[name] <= exact + 1.001e-6
    assert report["max"] == pytest.approx(max(latencies) * 1e-9)
    assert report["late"] == sum(value > 1_000_000 for value in latencies)
    assert report["ticks"] == len(latencies)
