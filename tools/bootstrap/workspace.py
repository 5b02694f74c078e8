"""The ROS workspace: messages generated and packages linked by colcon."""

import os
from pathlib import Path

from bootstrap import stamp
from bootstrap.layout import Layout, python_of
from bootstrap.logged import LoggedRunner
from bootstrap.progress import step
from bootstrap.removal import remove
from bootstrap.variables import for_build, for_run

_PROVE = """
import rclpy
from steering_msgs.msg import SteeringTorque
type(SteeringTorque).__import_type_support__()
"""


def build(layout: Layout, environment: Path, top: Path, runner: LoggedRunner) -> None:
    """Build the workspace `top` from nothing; the stamp comes last."""
    remove(top)
    top.mkdir(parents=True)
    python = python_of(environment)
    command: list[str | Path] = [python, "-m", "colcon", "--log-base", top / "log", "build"]
    command += ["--merge-install", "--symlink-install", "--base-paths", layout.source]
    command += ["--build-base", top / "build", "--install-base", top / "install"]
    command += ["--cmake-args", f"-DPython3_EXECUTABLE={python}", "-DBUILD_TESTING=OFF"]
    with step(f"building {len(layout.packages())} ROS packages") as shown:
        runner.run(command, for_build(layout, environment, os.environ), shown, layout.root)
        variables = for_run(layout, environment, top, os.environ)
        runner.run([python, "-c", _PROVE], variables, shown, layout.root)
    stamp.write(top, environment=environment.name)
