"""The bench's nodes as ROS executables: ``ros2 run steering_plant plant_node --graph FILE``.

Light: signals are settled before a node's program is loaded, whose imports take seconds.
"""

from __future__ import annotations

import os
import sys
from functools import partial
from pkgutil import resolve_name

from steering_lockstep.ending import end_at_once

EXECUTABLES = {
    "plant": ("steering_plant", "plant_node"),
    "valve_controller": ("pressure_control", "valve_controller_node"),
    "load_force_controller": ("pressure_control", "load_force_node"),
    "overlay_arbiter": ("pressure_control", "overlay_arbiter_node"),
    "lane_keeper": ("steering_bringup", "lane_keeper_node"),
    "driver": ("driver_model", "driver_node"),
    "vehicle": ("vehicle_model", "vehicle_node"),
    "rig_bridge": ("rig_bridge", "rig_bridge_node"),
    "recorder": ("steering_bringup", "recorder_node"),
    "replay": ("steering_bringup", "replay_node"),
}
"""Kind of node to (package, executable); nodes of one's own kinds run in ``ANY``."""

SPIN = "steering_lockstep.standalone:spin_alone"

ANY = ("steering_lockstep", "lockstep_node")


def executable(kind: str) -> tuple[str, str]:
    """Return the package and the name of the executable for nodes of ``kind``."""
    return EXECUTABLES.get(kind, ANY)


def run(kind: str | None) -> None:
    """Run the node that the command line names, one of ``kind``; None: of any."""
    end_at_once()
    # Threads of numerical libraries would only wait for one another, and change the last digits.
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    from steering_core.requirements import missing_text

    try:
        status = int(resolve_name(SPIN)(kind))
    except ImportError as error:
        sys.exit(f"error: {missing_text(error)}")
    # All is closed. Taking the interpreter down would need longer than all of that.
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


plant = partial(run, "plant")
valve_controller = partial(run, "valve_controller")
load_force_controller = partial(run, "load_force_controller")
overlay_arbiter = partial(run, "overlay_arbiter")
lane_keeper = partial(run, "lane_keeper")
driver = partial(run, "driver")
vehicle = partial(run, "vehicle")
rig_bridge = partial(run, "rig_bridge")
recorder = partial(run, "recorder")
replay = partial(run, "replay")
any_kind = partial(run, None)
