"""Reports of a diagnosis written by hand, and the sealed truth that they are judged by."""

from typing import Any

from steering_diagnosis.benchmark.cases import Sealed

ONE = Sealed(
    "visible-000001",
    "visible",
    1,
    "open_centre",
    "sweep",
    "bicycle",
    sizes={"rack_mass": 10.0},
    parameters={"rack_mass": {"added": 10.0}},
    neutral={"rack_mass": 0.0},
    mistaken={"rack_mass": ["rack_viscous_damping"]},
)


def cause(effect: str, *others: str, **parameters: Any) -> dict[str, Any]:
    """Return one cause as a report has it."""
    return {"effect": effect, "ambiguous_with": list(others), "parameters": parameters}


def report(*causes: dict[str, Any], verdict: str = "named", **more: Any) -> dict[str, Any]:
    """Return a report."""
    return {"verdict": verdict, "causes": list(causes), **more}
