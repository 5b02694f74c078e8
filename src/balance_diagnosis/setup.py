"""Installs the package `balance_diagnosis`, under colcon (ament_python) or with pip alone."""

from setuptools import find_packages, setup

NAME = "balance_diagnosis"

setup(
    name=NAME,
    version="0.1.0",
    packages=find_packages(include=[NAME, NAME + ".*"]),
    package_data={NAME: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/" + NAME]),
        ("share/" + NAME, ["package.xml"]),
    ],
    install_requires=["numpy", "scipy", "numba"],
    extras_require={"fmu": ["fmpy", "PyYAML"], "test": ["pytest"]},
    python_requires=">=3.11",
    zip_safe=False,
    maintainer="Steering bench maintainers",
    maintainer_email="maintainers@steering-bench.example",
    description="Names what a model of any machine gets wrong, from records of it.",
    url="https://steering-bench.example",
    license="Apache-2.0",
)
