"""Small bags for the tests of this folder."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from steering_bringup.bags import BagWriter
from steering_bringup.bags.encode import encode

TOPICS = {
    "/steering/torque": "steering_msgs/msg/SteeringTorque",
    "/steering/rack": "steering_msgs/msg/RackState",
    "/driver/torque": "steering_msgs/msg/DriverTorque",
}


def payloads_of(count: int, seed: int = 0) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Stamps and payloads of `count` ticks of random numbers."""
    random = np.random.default_rng(seed)
    ticks = np.arange(count, dtype=np.uint64)
    stamps = ticks.astype(np.int64) * 1_000_000
    fields = {
        "/steering/torque": ["steering_wheel_angle", "steering_wheel_speed", "torsion_bar_torque"],
        "/steering/rack": ["position", "speed", "force"],
        "/driver/torque": ["torque", "reference_angle"],
    }
    payloads = {
        topic: encode(
            TOPICS[topic],
            stamps,
            {"tick": ticks, **{name: random.normal(size=count) for name in names}},
            frame_id="rack",
        )
        for topic, names in fields.items()
    }
    return stamps, payloads


@pytest.fixture
def make_bag(tmp_path: Path) -> Callable[..., Path]:
    """Write a bag of `count` random ticks, message by message, with chunks of `per_chunk` ticks."""

    def make(
        name: str = "run", count: int = 200, seed: int = 0, per_chunk: int = 50, **options: object
    ) -> Path:
        stamps, payloads = payloads_of(count, seed)
        path = tmp_path / name
        run = {"scenario": {"name": "test"}, "parameters": {"mechanics.rack_mass": 24.0}}
        with BagWriter(path, TOPICS, run, **options) as writer:  # type: ignore[arg-type]
            for k, stamp in enumerate(stamps.tolist()):
                for topic, rows in payloads.items():
                    writer.write(topic, stamp, rows[k].tobytes())
                if (k + 1) % per_chunk == 0:
                    writer.flush()
        return path

    return make


@pytest.fixture
def topics() -> dict[str, str]:
    """Topics of the small bags with their types."""
    return dict(TOPICS)


@pytest.fixture
def random_ticks() -> Callable[..., tuple[np.ndarray, dict[str, np.ndarray]]]:
    """`payloads_of`, for tests that write their own bags."""
    return payloads_of
