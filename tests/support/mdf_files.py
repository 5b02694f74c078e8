"""MDF files of three sine channels, and what reading them must give."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from asammdf import MDF, Signal

from steering_core.errors import BenchError
from steering_diagnosis.data.read import read_record
from steering_diagnosis.data.record import Record

N = 2600
T = np.arange(N) * 1e-3
ANGLE = 20.0 * np.sin(2 * np.pi * 0.7 * T)
LEFT = 5.0 + 3.0 * np.sin(2 * np.pi * 0.9 * T)
RIGHT = 6.0 - 2.0 * np.cos(2 * np.pi * 0.6 * T)
TRUE = {
    "steering_wheel_angle": np.radians(ANGLE),
    "left_pressure": LEFT * 1e5,
    "right_pressure": RIGHT * 1e5,
}
CHANNELS = """\
channels:
  steering_wheel_angle: {from: angle, unit: deg}
  left_pressure: {from: pL, unit: bar}
  right_pressure: {from: pR, unit: bar}
"""


def signal(
    values: np.ndarray, name: str, unit: str = "", time: np.ndarray = T, **more: Any
) -> Signal:
    """A channel of a file."""
    return Signal(samples=np.asarray(values), timestamps=time, name=name, unit=unit, **more)


def plain(**more: Signal) -> list[Signal]:
    """The three channels, those of `more` in their place."""
    made = {"angle": (ANGLE, "deg"), "pL": (LEFT, "bar"), "pR": (RIGHT, "bar")}
    return [more.get(n) or signal(v, n, unit) for n, (v, unit) in made.items()]


def written(
    folder: Path,
    *groups: Any,
    version: str = "4.10",
    change: Callable[[Any], object] | None = None,
    name: str = "drive.mf4",
    **save: Any,
) -> Path:
    """Write groups, each a list of signals or (list, options of append)."""
    path = folder / name
    with MDF(version=cast(Any, version)) as file:
        for group in groups:
            signals, options = group if isinstance(group, tuple) else (group, {})
            file.append(signals, **({"comment": "measured"} | options))
        if change is not None:
            change(file)
        saved = Path(file.save(path, overwrite=True, **save))
    return saved.rename(path)


def read(path: Path, text: str = CHANNELS) -> Record:
    """The record by a mapping file of `text`."""
    mapping = path.parent / "mapping.yaml"
    mapping.write_text("schema: 1\nvalve_system: open_centre\n" + text, encoding="utf-8")
    return read_record(path, mapping)


def check(
    record: Record,
    lost: Iterable[int] = (),
    tolerance: float = 1e-6,
    names: Iterable[str] = tuple(TRUE),
) -> None:
    """Values within ``tolerance`` of the largest; gaps exactly at ``lost`` (of left_pressure)."""
    for name in names:
        true, here = TRUE[name], record[name]
        assert abs(len(here) - N) <= 1
        gone = np.isnan(here)
        wanted = np.isin(np.arange(len(here)), list(lost)) & (name == "left_pressure")
        assert np.array_equal(gone, wanted), f"{name}: {gone.sum()} gone"
        error = np.abs(here - true[: len(here)])[~gone]
        assert error.max() <= tolerance * np.abs(true).max(), name


def refused(path: Path, text: str, *words: str) -> str:
    """What a refusal says: one line with the `words` in it."""
    with pytest.raises(BenchError) as caught:
        read(path, text)
    said = str(caught.value)
    assert "\n" not in said
    for word in words:
        assert word in said, said
    return said


def left(rest: str) -> str:
    """The mapping with something else for the left chamber."""
    return CHANNELS.replace("{from: pL, unit: bar}", f"{{{rest}}}")
