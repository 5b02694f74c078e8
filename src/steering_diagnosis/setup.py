"""Installs the package `steering_diagnosis` under colcon (ament_python)."""

from setuptools import find_packages, setup

NAME = "steering_diagnosis"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, NAME + ".*"]),
    package_data={NAME: ["py.typed"], NAME + ".steering": ["clean_gains.json"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=False,
    maintainer="Steering bench maintainers",
    maintainer_email="maintainers@steering-bench.example",
    description="Shows what the simulation gets wrong, names the cause and extends the model.",
    url="https://steering-bench.example",
    license="Apache-2.0",
)
