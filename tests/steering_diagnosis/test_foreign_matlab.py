"""MATLAB files of any version: what a mapping can point at, and what is said where it cannot."""

import re
import warnings

import h5py
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign.matlab.content import load
from steering_diagnosis.data.foreign.matlab.walk import walk
from steering_diagnosis.data.read import read_record

N = 2600
T = np.arange(N) * 1e-3
ANGLE = 20.0 * np.sin(2.0 * np.pi * 0.7 * T)
LEFT, RIGHT = 5.0 + np.sin(T), 6.0 - np.cos(3.0 * T)
with warnings.catch_warnings():
    # It sets an option of pandas that has become the default.
    warnings.simplefilter("ignore")
    import matio

VERSIONS = ("v5", "v7", "v7.3")


def write(path, content, version="v5"):
    if version == "v5":
        savemat(path, content, do_compression=True)
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            matio.save_to_mat(str(path), content, version=version)
    return path


def record(path, angle, left, right, time=""):
    mapping = path.with_suffix(".yaml")
    rows = [
        "schema: 1",
        "valve_system: open_centre",
        *([f"time: '{time}'"] if time else []),
        "channels:",
        f"  steering_wheel_angle: {{from: '{angle}', unit: deg}}",
        f"  left_pressure: {{from: '{left}', unit: bar}}",
        f"  right_pressure: {{from: '{right}', unit: bar}}",
    ]
    mapping.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return read_record(path, mapping)


def check(found):
    assert abs(len(found) - N) <= 1
    n = min(len(found), N)
    np.testing.assert_allclose(found["steering_wheel_angle"][:n], np.radians(ANGLE)[:n], atol=1e-9)
    np.testing.assert_allclose(found["left_pressure"][:n], 1e5 * LEFT[:n], atol=1e-3)
    np.testing.assert_allclose(found["right_pressure"][:n], 1e5 * RIGHT[:n], atol=1e-3)


def cell(*values):
    made = np.empty((1, len(values)), dtype=object)
    made[0, :] = values
    return made


@pytest.mark.parametrize("version", VERSIONS)
def test_vectors_columns_structures_and_cells(tmp_path, version):
    content = {
        "log": {"t": T, "data": np.column_stack([ANGLE, RIGHT])},
        "c": cell(LEFT, "operator"),
    }
    path = write(tmp_path / "x.mat", content, version)
    check(record(path, "log.data(:,1)", "c{1}", "log.data(:,2)", "log.t"))


@pytest.mark.parametrize("version", VERSIONS)
def test_simulinks_structure_with_time_is_found_by_place_and_by_label(tmp_path, version):
    signals = np.empty((1, 3), dtype=[("values", object), ("label", object)])
    for k, (values, label) in enumerate(((ANGLE, "angle"), (LEFT, "pL"), (RIGHT, "pR"))):
        signals[0, k] = (values.reshape(-1, 1), label)
    path = write(tmp_path / "x.mat", {"yout": {"time": T, "signals": signals}}, version)
    check(record(path, "yout.signals(1).values", "pL", "pR"))


@pytest.mark.parametrize("version", VERSIONS)
def test_controldesks_signals_have_the_axis_that_they_name(tmp_path, version):
    x = np.empty((1, 2), dtype=[("Name", object), ("Data", object)])
    x[0, 0], x[0, 1] = ("slow", T[::2]), ("fast", T)
    y = np.empty((1, 3), dtype=[("Name", object), ("Data", object), ("XIndex", object)])
    for k, (values, label) in enumerate(((ANGLE, "Model Root/Angle"), (LEFT, "pL"), (RIGHT, "pR"))):
        y[0, k] = (label, values, np.array([[2.0]]))
    path = write(tmp_path / "x.mat", {"exp1": {"X": x, "Y": y}}, version)
    check(record(path, "Model Root/Angle", "exp1.Y(2).Data", "pR"))


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_a_timeseries_and_a_timetable_bring_their_own_time(tmp_path, version):
    series = matio.utils.MatlabOpaque(
        properties={"Name": "wheel", "Data_": ANGLE.reshape(-1, 1), "Time_": T.reshape(-1, 1)},
        classname="timeseries",
    )
    index = pd.to_timedelta(np.arange(N), unit="ms").as_unit("ms")
    table = pd.DataFrame({"pL": LEFT, "pR": RIGHT}, index=index)
    path = write(tmp_path / "x.mat", {"wheel": series, "run": table}, version)
    check(record(path, "wheel", "run.pL", "run.pR"))


def test_what_other_programs_write_as_hdf5_is_walked_by_its_groups(tmp_path):
    path = tmp_path / "x.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["log/t"], file["log/angle"] = T, ANGLE.astype(np.float64)
        file["log/p"] = np.column_stack([LEFT, RIGHT])
    check(record(path, "log.angle", "log.p(:,1)", "log.p(:,2)", "log.t"))


def test_what_matlab_writes_as_version_7_3_is_read(tmp_path):
    """As MATLAB lays it out: transposed, classes as attributes, cells by reference."""
    path = tmp_path / "x.mat"
    with h5py.File(path, "w", userblock_size=512) as file:

        def put(group, name, values, kind):
            made = group.create_dataset(name, data=values)
            made.attrs["MATLAB_class"] = np.bytes_(kind)
            return made

        put(file, "t", T.reshape(1, -1), "double")
        put(file, "angle", ANGLE.astype(np.float64).reshape(1, -1), "double")
        refs = file.create_group("#refs#")
        inside = [
            put(refs, name, values.reshape(1, -1), "double")
            for name, values in (("b", LEFT), ("c", RIGHT))
        ]
        put(file, "p", np.array([[i.ref] for i in inside], dtype=h5py.ref_dtype), "cell")
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan  1 2024 HDF5 schema 1.00 ."
    with path.open("r+b") as raw:
        raw.write(head.ljust(116) + bytes(8) + b"\x00\x02IM")
    check(record(path, "angle", "p{1}", "p{2}", "t"))


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("angel", "did you mean 'angle'"),
        ("note", "holds text, no vector"),
        ("wave", "complex numbers"),
        ("both", "give a column"),
        ("one", "1 number"),
        ("short", "'short' has 5 values, 't' 2600"),
        ("p", "several vectors are called 'p'"),
    ],
)
def test_what_is_no_channel_is_named_with_what_there_is(tmp_path, source, said):
    same = np.empty((1, 2), dtype=[("name", object), ("values", object)])
    same[0, 0], same[0, 1] = ("p", LEFT), ("p", RIGHT)
    content = {
        "t": T,
        "angle": ANGLE,
        "note": "cold oil",
        "wave": np.exp(1j * T),
        "both": np.column_stack([LEFT, RIGHT]),
        "one": 3.0,
        "short": np.arange(5.0),
        "sensors": same,
    }
    path = write(tmp_path / "x.mat", content)
    with pytest.raises(BenchError, match=re.escape(said)):
        record(path, source, "angle", "angle", "t")


@pytest.mark.parametrize("version", VERSIONS)
def test_damage_of_any_kind_is_one_line(tmp_path, version):
    whole = write(tmp_path / "good.mat", {"t": T, "angle": ANGLE}, version).read_bytes()
    random = np.random.default_rng(3)
    damaged = [b"", b"t,angle\n0,1\n", whole[:100], whole[: len(whole) // 2], b"\0" * 300]
    for _ in range(12):
        at, length = int(random.integers(128, len(whole) - 200)), int(random.integers(1, 200))
        damaged.append(whole[:at] + random.bytes(length) + whole[at + length :])
    said = []
    for data in damaged:
        path = tmp_path / "x.mat"
        path.write_bytes(data)
        try:
            load(path)
        except BenchError as error:
            said.append(str(error))
    assert len(said) >= 4
    assert all(re.search(r"x\.mat'.*MAT file", text) and "\n" not in text for text in said)


NAMES = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True).filter(
    lambda name: name.lower() not in ("x", "y", "data", "values", "properties")
)
VECTORS = st.integers(2, 9).map(lambda n: np.arange(float(n)) + 0.5 * n)
TREES = st.recursive(
    VECTORS,
    lambda inner: (
        st.dictionaries(NAMES, inner, min_size=1, max_size=3)
        | st.lists(inner, min_size=2, max_size=3)
    ),
    max_leaves=6,
)


def leaves(at, tree):
    """Yield the address that MATLAB would write, and the vector there."""
    if isinstance(tree, dict):
        for name, value in tree.items():
            yield from leaves(f"{at}.{name}" if at else name, value)
    elif isinstance(tree, list):
        for k, value in enumerate(tree, start=1):
            yield from leaves(f"{at}{{{k}}}", value)
    else:
        yield at, tree


def as_matlab(tree):
    if isinstance(tree, dict):
        return {name: as_matlab(value) for name, value in tree.items()}
    return cell(*map(as_matlab, tree)) if isinstance(tree, list) else tree


@settings(max_examples=40, deadline=None)
@given(st.dictionaries(NAMES, TREES, min_size=1, max_size=3), st.sampled_from(VERSIONS))
def test_every_vector_stands_at_its_address(tmp_path_factory, content, version):
    path = write(tmp_path_factory.mktemp("mat") / "x.mat", as_matlab(content), version)
    found = walk(load(path))
    for address, vector in leaves("", content):
        values = found[address].values
        assert values is not None
        np.testing.assert_array_equal(values, vector)
