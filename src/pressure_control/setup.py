"""Installs the package `pressure_control` under colcon (ament_python)."""

from setuptools import find_packages, setup

NAME = "pressure_control"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, NAME + ".*"]),
    package_data={NAME: ["*.yaml", "py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    maintainer="Steering bench maintainers",
    maintainer_email="maintainers@steering-bench.example",
    description="Boost-curve reference and the controller of each pressure control valve.",
    url="https://steering-bench.example",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "valve_controller_node = steering_lockstep.executables:valve_controller",
            "load_force_node = steering_lockstep.executables:load_force_controller",
            "overlay_arbiter_node = steering_lockstep.executables:overlay_arbiter",
        ],
    },
)
