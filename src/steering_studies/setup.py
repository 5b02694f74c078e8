"""Installs the package `steering_studies` under colcon (ament_python)."""

from setuptools import find_packages, setup

NAME = "steering_studies"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, NAME + ".*"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    maintainer="Steering bench maintainers",
    maintainer_email="maintainers@steering-bench.example",
    description="Rig tests, identification, linear analysis, designs, reproduction of the source.",
    url="https://steering-bench.example",
    license="Apache-2.0",
)
