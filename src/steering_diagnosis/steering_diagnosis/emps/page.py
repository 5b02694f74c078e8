"""The page of the axis: the library's example, which binds it as anybody would."""

from __future__ import annotations

import shlex
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import balance_diagnosis
from balance_diagnosis import Diagnosis, diagnose
from steering_core.errors import BenchError

EXAMPLES = Path(balance_diagnosis.__file__).resolve().parents[1] / "examples"


def write_page(folder: Path, out: Path) -> tuple[Diagnosis, Path]:
    """Diagnose the records of a folder with the library; return the diagnosis and its page."""
    example = _example("emps_axis")
    fit, held = example.records(folder)
    diagnosis = diagnose(example.MODEL, fit=[fit], holdout=[held])
    call = shlex.join(["./steer", "diagnose-emps", str(folder)])
    return diagnosis, diagnosis.write(out, call=call)


def _example(name: str) -> ModuleType:
    file = EXAMPLES / f"{name}.py"
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None or not file.is_file():
        raise BenchError(f"there is no '{file}': the page is made from the checkout, with ./steer")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
