"""An identified gear as files: a parameter set that loads, and the boost curve."""

from __future__ import annotations

from pathlib import Path

import yaml

from steering_bringup.errors import BenchError
from steering_core.parameters import ParameterSet, load_parameters
from steering_studies.identification.identify import Identified
from steering_studies.identification.opening_areas import BoostCurve, boost_points

HEAD = """\
# {name}: identified from rig tests, SI units. tolerance: relative, two standard deviations.
# Use it with `parameter_set: {file}` in a scenario, or --set-file {file}.
"""


def parameter_lines(identified: Identified) -> dict[str, dict[str, dict[str, object]]]:
    """Return group -> parameter -> {value, tolerance, unit, source}."""
    groups: dict[str, dict[str, dict[str, object]]] = {}
    for full, estimate in identified.estimates.items():
        group, name = full.split(".", 1)
        half = 0.5 * (estimate.high - estimate.low)
        groups.setdefault(group, {})[name] = {
            "value": float(f"{estimate.value:.6g}"),
            "tolerance": float(f"{min(half / abs(estimate.value), 0.99):.2g}"),
            "unit": estimate.unit,
            "source": estimate.source,
        }
    return groups


def write_set(identified: Identified, path: Path) -> ParameterSet:
    """Write the parameter set, and return it as it loads again."""
    text = HEAD.format(name=path.stem, file=path.name)
    text += yaml.safe_dump(parameter_lines(identified), sort_keys=False, width=120)
    _write(path, text)
    return load_parameters(path)


def write_curve(curve: BoostCurve, path: Path) -> None:
    """Write the boost curve as a scenario's ``boost_curve`` takes it."""
    lines = ["torsion_bar_torque_Nm,load_pressure_Pa"]
    torque, pressure = boost_points(curve)
    lines += [f"{t:.6g},{p:.7g}" for t, p in zip(torque, pressure, strict=True)]
    _write(path, "\n".join(lines) + "\n")


def _write(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BenchError(f"'{path}' cannot be written: {error.strerror}") from None
