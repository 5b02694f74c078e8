"""Installs the package `rig_bridge` under colcon (ament_python)."""

from setuptools import find_packages, setup

NAME = "rig_bridge"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, NAME + ".*"]),
    package_data={NAME: ["rigs/*.yaml", "rigs/*.dbc", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    maintainer="Steering bench maintainers",
    maintainer_email="maintainers@steering-bench.example",
    description="Channels, limits, watchdogs and links to a hardware test rig.",
    url="https://steering-bench.example",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "rig_bridge_node = steering_lockstep.executables:rig_bridge",
            "rig_emulator = rig_bridge.emulator.main:main",
        ],
    },
)
