"""Installs the package `steering_lockstep` under colcon (ament_python)."""

from setuptools import find_packages, setup

NAME = "steering_lockstep"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, NAME + ".*"]),
    package_data={NAME: ["*.xml", "*.yaml", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    maintainer="Steering bench maintainers",
    maintainer_email="maintainers@steering-bench.example",
    description="The 1 kHz lock-step contract over ROS 2: layouts, topics, node base class.",
    url="https://steering-bench.example",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "lockstep_node = steering_lockstep.executables:any_kind",
        ],
    },
)
