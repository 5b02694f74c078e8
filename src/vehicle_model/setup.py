"""Installs the package `vehicle_model` under colcon (ament_python)."""

from setuptools import find_packages, setup

NAME = "vehicle_model"

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
    description="Linear bicycle model and dry-park load on the rack; the vehicle node.",
    url="https://steering-bench.example",
    license="Apache-2.0",
    entry_points={
        "console_scripts": [
            "vehicle_node = steering_lockstep.executables:vehicle",
        ],
    },
)
