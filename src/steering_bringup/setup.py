"""Installs the package `steering_bringup` under colcon (ament_python)."""

from glob import glob

from setuptools import find_packages, setup

NAME = "steering_bringup"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, NAME + ".*"]),
    package_data={NAME: ["nodesets/*.yaml", "scenarios/*.yaml", "templates/*", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
        ("share/" + NAME + "/launch", sorted(glob(NAME + "/launch_files/*.py"))),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    maintainer="Steering bench maintainers",
    maintainer_email="maintainers@steering-bench.example",
    description="Node sets, scenarios, launcher, recorder, direct runner and command line.",
    url="https://steering-bench.example",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "recorder_node = steering_lockstep.executables:recorder",
            "replay_node = steering_lockstep.executables:replay",
            "lane_keeper_node = steering_lockstep.executables:lane_keeper",
            "steer = steering_bringup.cli:console",
        ],
    },
)
