"""Generated messages travel through a real middleware unchanged."""

import math

import pytest

rclpy = pytest.importorskip("rclpy")
messages = pytest.importorskip("steering_msgs.msg")

pytestmark = pytest.mark.ros
KINDS = (
    "SteeringTorque", "ChamberPressure", "RackState", "DriverTorque", "ValveCommand", "RackForce",
    "PlantTruth", "TickReport", "TorqueOverlay", "TorqueOverlayApplied", "LoadCommand",
)  # fmt: skip


@pytest.fixture
def node(monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=87)
    node = rclpy.create_node("round_trip", context=context, start_parameter_services=False)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def filled(kind):
    """A message with a different number in every field."""
    message = getattr(messages, kind)()
    message.header.frame_id = "rack"
    message.header.stamp.nanosec = 1_000_000
    message.tick = 2**63 + 1
    for index, name in enumerate(message.get_fields_and_field_types()):
        if name not in ("header", "tick"):
            number = -math.pi * 10.0**index
            kinds = {bool: True, int: index, str: f"name_{index}"}
            setattr(message, name, kinds.get(type(getattr(message, name)), number))
    return message


@pytest.mark.parametrize("kind", KINDS)
def test_message_arrives_unchanged(node, kind):
    received: list = []
    sent = filled(kind)
    node.create_subscription(type(sent), "/round_trip", received.append, 10)
    publisher = node.create_publisher(type(sent), "/round_trip", 10)
    executor = rclpy.executors.SingleThreadedExecutor(context=node.context)
    executor.add_node(node)
    for _ in range(100):
        if publisher.get_subscription_count():
            break
        executor.spin_once(timeout_sec=0.05)
    publisher.publish(sent)
    for _ in range(100):
        if received:
            break
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    assert received == [sent]
