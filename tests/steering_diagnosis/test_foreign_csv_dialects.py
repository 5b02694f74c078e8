"""Any table in any dialect comes back as it was written, or is refused; never otherwise."""

import math
from pathlib import Path

import pytest
from csv_dialects import Dialect, Written, dialects, write
from hypothesis import HealthCheck, event, given, settings

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign import Raw, read_foreign
from steering_diagnosis.data.mapping import Mapping

ROWS = 30


@pytest.fixture(scope="module")
def file(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("csv") / "drive.csv"


@settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
@given(dialects())
def test_a_table_comes_back_as_written_or_is_refused(file, dialect):
    written = write(dialect, ROWS)
    file.write_bytes(written.data)
    mapping = Mapping.model_validate(written.mapping)
    refusal, raw = "", {}
    try:
        raw = read_foreign(file, mapping)
    except BenchError as error:
        refusal = str(error)
    event("refused" if refusal else "read")
    if refusal:
        assert f"'{file}'" in refusal
        assert "\n" not in refusal
        return
    for channel, name in zip(mapping.channels, written.values, strict=True):
        check(raw[channel], written, name, dialect)


def check(raw: Raw, written: Written, name: str, dialect: Dialect) -> None:
    """Compare a channel with the truth, row by row as the lines of the file say."""
    assert raw.lines is not None
    assert raw.time is not None
    told = bool(raw.lost or raw.about)
    rows = {line: k for k, line in enumerate(raw.lines)}
    assert set(rows) <= set(written.lines), "rows that are none"
    first = None
    for k, line in enumerate(written.lines):
        truth = math.nan if k in written.bad else written.values[name][k]
        row = rows.get(line)
        value = math.nan if row is None else raw.values[row]
        if math.isnan(value):
            assert told or dialect.ragged != "none", f"line {line} was lost without a word"
            if not math.isnan(truth) and not dialect.sloppy:
                assert k == len(written.lines) - 1, f"line {line} was lost for nothing"
            continue
        assert value == truth, f"line {line}: {value!r} for {truth!r}"
        time = raw.time[row]
        if first is None:
            first = (time, written.time[k])
        unit = {"s": 1.0, "ms": 1e-3, "ns": 1e-9}[written.mapping["time_unit"]]
        elapsed = (time - first[0]) * unit
        assert elapsed == pytest.approx(written.time[k] - first[1], abs=2e-9)
