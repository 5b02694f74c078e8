"""The car that a checked node steers: the bench's cores and its arbiter. Pure, no ROS."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pressure_control.overlay.arbiter import OUTPUTS, OverlayArbiter
from steering_bringup.cores import build_cores
from steering_bringup.schema import NodeSet, Scenario
from vehicle_model.motion_messages import IMU, ODOMETRY, imu_fields, odometry_fields

MOTION_EVERY = 10
APPLIED_TOPIC = "/torque_overlay/applied"


class Car:
    """A closed loop of its own, one tick at a time.

    ``arbiter``: hears guests; with ``period`` [ticks] it has one member, whose [torque N m,
    priority] are in ``wish``. ``rows``: what it gave at each tick done, each (19,).
    """

    def __init__(self, scenario: Scenario, node_set: NodeSet, period: int | None = None) -> None:
        cores = build_cores(scenario, node_set)
        assert cores.left is not None
        assert cores.right is not None
        self.plant, self.driver, self.vehicle = cores.plant, cores.driver, cores.vehicle
        self.valves = (cores.left, cores.right)
        periods = () if period is None else (period,)
        self.arbiter = OverlayArbiter(scenario.parameter_values(), periods)
        self.wish = [0.0, -1.0] * len(periods)
        self.rows: list[np.ndarray] = []
        self._applied = [0.0] * OUTPUTS

    def messages(self, tick: int) -> dict[str, Sequence[float]]:
        """Return the fields of all that the bench publishes at ``tick``, by topic."""
        measured = self.plant.out.tolist()
        fields: dict[str, Sequence[float]] = {
            "/steering/torque": measured[:3],
            "/steering/pressure": measured[3:6],
            "/steering/rack": measured[6:],
            APPLIED_TOPIC: self._applied,
        }
        if tick % MOTION_EVERY == 0:
            fields[ODOMETRY] = odometry_fields(self.vehicle.odometry())
            fields[IMU] = imu_fields(self.vehicle.imu())
        return fields | {"/clock": ()}

    def step(self, tick: int, hand: float = 0.0) -> None:
        """Go from ``tick`` to the next with what the arbiter has heard.

        ``hand`` [N m]: of a driver's hands, felt by the arbiter on top of the torsion bar's torque.
        """
        measured = self.plant.out.tolist()
        angle, wheel_speed, bar = measured[:3]
        speed = self.vehicle.odometry().v_x
        out = self.arbiter.step(tick, angle, wheel_speed, bar + hand, speed, *self.wish)
        self.rows.append(out.copy())
        self._applied = out.tolist()
        inputs = (*measured, float(out[1]))
        forces = [valve.step(tick, *inputs)[1] for valve in self.valves]
        driver = self.driver.step(tick, *measured[:3])[0]
        load = self.vehicle.step(tick, *measured[6:]).tolist()
        self.plant.step(tick, driver, *forces, *load)
