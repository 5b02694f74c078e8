"""Slips in a mapping: one line with its place and what to write; the guide lists all channels."""

from pathlib import Path

import pytest

from steering_core.errors import BenchError
from steering_core.naming import unknown
from steering_diagnosis.data.channels import CHANNELS
from steering_diagnosis.data.mapping import load_mapping
from steering_diagnosis.data.units import FACTORS

GUIDE = Path(__file__).parents[2] / "docs" / "diagnosis.md"
HEAD = "schema: 1\nvalve_system: open_centre\ntime: t\nchannels:\n"


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ("from: no", ("from", "false", "in quotes")),
        ("from: 3", ("from", "3", "in quotes")),
        ("from: ''", ("from", "empty")),
        ("from: a, sign: '-'", ("sign", "1 or -1", "'-'")),
        ("from: a, sign: 2", ("sign", "1 or -1")),
        ("from: a, sign: true", ("sign", "1 or -1")),
        ("from: a, scale: 0", ("scale", "not be 0")),
        ("from: a, delay: 20", ("delay", "within 1 s", "seconds", "clocks")),
        ("column: 2", ("column", "`from`")),
        ("from:a", ("unknown key 'from:a'",)),
        ("from: a, unit: bars of gold", ("unit", "bar, mbar")),
    ],
)
def test_a_slip_in_a_channel_is_named_with_line_and_remedy(keys, told, tmp_path):
    path = tmp_path / "mapping.yaml"
    path.write_text(f"{HEAD}  left_pressure: {{{keys}}}\n")
    with pytest.raises(BenchError) as caught:
        load_mapping(path)
    said = str(caught.value)
    for words in (f"{path}, line 5", *told):
        assert words in said, said


def test_a_channel_without_a_name_and_a_gap_that_is_no_number_are_refused(tmp_path):
    path = tmp_path / "mapping.yaml"
    path.write_text(f"{HEAD}  pressure_left: {{from: a, unit: bar}}\n")
    with pytest.raises(BenchError, match="line 5: unknown channel 'pressure_left'; did you mean"):
        load_mapping(path)
    path.write_text(f"{HEAD}  left_pressure: {{from: a, unit: bar}}\nmissing: [no]\n")
    with pytest.raises(BenchError, match=r"line 6: missing.*texts or numbers, got false"):
        load_mapping(path)


def test_the_guide_lists_every_channel_with_its_units_and_sign():
    section = GUIDE.read_text(encoding="utf-8").split("### The channels\n")[1].split("\n###")[0]
    rows = [line.strip("|").split("|") for line in section.splitlines() if line.startswith("| `")]
    listed = {row[0].strip(" `"): [cell.strip() for cell in row[1:]] for row in rows}
    assert list(listed) == list(CHANNELS)
    for name, (unit, accepted, what, positive) in listed.items():
        assert unit == CHANNELS[name].unit
        assert accepted == ", ".join(f"`{known}`" for known in FACTORS[unit])
        assert what
        assert positive


def test_names_that_occur_twice_are_listed_once():
    assert unknown("column", "x", ["F", "t", "F"]) == "unknown column 'x'; known: F, t"
