"""MATLAB files of any version: channels come back right by MATLAB's addresses, or a line says why.

What MATLAB and Simulink write themselves is rebuilt with the property names of files they wrote.
"""

import re
import string
import warnings
from pathlib import Path

import h5py
import numpy as np
import pandas
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from matlab73 import save73
from scipy.io import savemat
from scipy.sparse import csc_array

from steering_core.errors import BenchError
from steering_diagnosis.data.foreign import read_foreign
from steering_diagnosis.data.foreign.matlab.find import Vectors
from steering_diagnosis.data.foreign.matlab.load import load
from steering_diagnosis.data.foreign.matlab.tree import walk
from steering_diagnosis.data.mapping import load_mapping
from steering_diagnosis.data.read import read_record

with warnings.catch_warnings(action="ignore"):
    import matio
    from matio.utils.matclass import MatlabOpaque

TIME = np.arange(3000) * 1e-3
ANGLE = 20.0 * np.sin(2.0 * np.pi * 0.7 * TIME)
PRESSURE = 5.0 + 3.0 * np.sin(2.0 * np.pi * 0.9 * TIME)
HEAD = "schema: 1\nvalve_system: open_centre\n"


def mapping(folder, angle="angle", pressure="pL", time="time: t\n", more=""):
    path = folder / "mapping.yaml"
    path.write_text(
        f"{HEAD}{time}channels:\n"
        f"  steering_wheel_angle: {{from: '{angle}', unit: deg{more}}}\n"
        f"  left_pressure: {{from: '{pressure}', unit: bar}}\n"
    )
    return path


def is_right(path, *, tolerance=1e-9, **names):
    """Check the record's values and length; return its notes."""
    record = read_record(path, mapping(path.parent, **names))
    assert abs(len(record) - len(TIME)) <= 1
    count = min(len(record), len(TIME))
    found = np.degrees(record["steering_wheel_angle"][:count])
    np.testing.assert_allclose(found, ANGLE[:count], atol=20.0 * tolerance)
    found = record["left_pressure"][:count] * 1e-5
    np.testing.assert_allclose(found, PRESSURE[:count], atol=8.0 * tolerance)
    return record.notes


def refused(path, **names):
    with pytest.raises(BenchError) as caught:
        read_record(path, mapping(path.parent, **names))
    said = str(caught.value)
    assert "\n" not in said
    return said


def vectors(path):
    return Vectors(dict(walk(load(path))), "x")


def save5(path, variables):
    """Write a compressed version 5 file, in which a list of structures is an array of them."""
    savemat(path, {name: _array(value) for name, value in variables.items()}, do_compression=True)


def _array(value):
    if isinstance(value, dict):
        return {name: _array(item) for name, item in value.items()}
    if isinstance(value, np.ndarray) and value.dtype == object:
        return cell(*(_array(item) for item in value.flat))
    if isinstance(value, list):
        rows = [tuple(_array(item) for item in member.values()) for member in value]
        array = np.empty((1, len(rows)), [(name, object) for name in value[0]])
        array[0, :] = rows
        return array
    return value


def save_by_matio(path, variables):
    """Write version 7.3 as another library does."""
    content = {name: _array(value) for name, value in variables.items()}
    with warnings.catch_warnings(action="ignore"):
        matio.save_to_mat(path, content, version="v7.3")


def cell(*values):
    made = np.empty((1, len(values)), object)
    made[0, :] = values
    return made


VARIABLES = {"t": TIME, "angle": ANGLE, "pL": PRESSURE}


def timeseries(values, name="", time=None, unit="", time_unit="seconds"):
    """Return the object as R2023 writes it; a uniform time has no numbers, only its rule."""
    about_time = {
        "Units": time_unit,
        "StartDate": "",
        "Length": float(len(values)),
        "Time_": np.empty((0, 0)) if time is None else time[:, np.newaxis],
        "Increment_": np.nan if time is not None else TIME[1],
        "Start_": 0.0,
    }
    about_data = {"Units": unit, "Version": 10.2}
    return MatlabOpaque(
        {
            "Events": np.empty((0, 0)),
            "Name": name,
            "DataInfo": MatlabOpaque(about_data, "tsdata.datametadata"),
            "TimeInfo": MatlabOpaque(about_time, "tsdata.timemetadata"),
            "Data_": values[:, np.newaxis],
            "Time_": np.empty((0, 0)),
            "IsTimeFirst_": np.array([[True]]),
        },
        "timeseries",
    )


def dataset(*signals):
    """Return Simulink's logsout: signals by name, hidden in the storage of the data set."""
    elements = np.empty((len(signals), 1), object)
    for k, (name, values) in enumerate(signals):
        properties = {"PortIndex": 1.0, "Values": values, "Name": name}
        elements[k, 0] = MatlabOpaque(properties, "Simulink.SimulationData.Signal")
    storage = MatlabOpaque(
        {"Version": 2.0, "Elements": elements}, "Simulink.SimulationData.Storage.RamDatasetStorage"
    )
    properties = {"Version_": 1.0, "Name": "logsout", "Storage_": storage}
    return MatlabOpaque(properties, "Simulink.SimulationData.Dataset")


@pytest.mark.parametrize("version", ["4", "5", "compressed", "7.3", "matio", "plain", "block"])
def test_every_version_is_read(tmp_path, version):
    path = tmp_path / "x.mat"
    if version in ("4", "5", "compressed"):
        columns = {name: array[:, np.newaxis] for name, array in VARIABLES.items()}
        form = "4" if version == "4" else "5"
        savemat(path, columns, format=form, do_compression=version == "compressed")
    elif version == "7.3":
        save73(path, VARIABLES)
    elif version == "matio":
        matio.save_to_mat(path, VARIABLES, version="v7.3")
    else:
        with h5py.File(path, "w", userblock_size=0 if version == "plain" else 512) as file:
            for name, array in VARIABLES.items():
                file["run/" + name] = array
        is_right(path, angle="run.angle", pressure="run.pL", time="time: run.t\n")
        return
    is_right(path)


@pytest.mark.parametrize("write", [save5, save73])
def test_structures_and_arrays_of_them_are_addressed_as_in_matlab(tmp_path, write):
    path = tmp_path / "x.mat"
    log = [{"values": ANGLE, "name": "a"}, {"values": PRESSURE, "name": "p"}]
    write(path, {"run": {"log": log, "t": TIME[:, np.newaxis]}})
    is_right(path, angle="run.log(1).values", pressure="run.log(1, 2).values", time="time: run.t\n")
    is_right(path, angle="run.log(1).values", pressure="p", time="time: run(1).t\n")
    said = refused(path, angle="run.log.values", time="time: run.t\n")
    assert "'run.log(1).values' (a)" in said


@pytest.mark.parametrize("write", [save5, save73])
def test_a_column_of_a_matrix_and_a_row_of_simulinks_to_file_block(tmp_path, write):
    path = tmp_path / "x.mat"
    data = np.stack([TIME, ANGLE, PRESSURE], axis=1)
    write(path, {"data": data, "ans": data.T.copy()})
    is_right(path, angle="data(:,2)", pressure="data(:, 3)", time="time: data(:,1)\n")
    is_right(path, angle="ans(2,:)", pressure="ans(3,:)", time="time: ans(1,:)\n")
    assert "is 3000 x 3 numbers: say which, as 'data(:,1)'" in refused(path, angle="data", time="")
    for wrong in ("data(:,4)", "data(:,0)", "data(:,:)", "data(:,1,1)"):
        assert "no vector of 3000 x 3" in refused(path, angle=wrong, time="")


def test_cells_and_single_numbers_in_an_array_of_structures(tmp_path):
    path = tmp_path / "x.mat"
    cells = cell(ANGLE, PRESSURE)
    ticks = np.array([(t, a) for t, a in zip(TIME, ANGLE, strict=True)], "O,O")
    ticks.dtype.names = ("t", "angle")
    savemat(path, {"c": cells, "log": ticks, "t": TIME})
    is_right(path, angle="c{1}", pressure="c{2}")
    is_right(path, angle="[log.angle]", pressure="c{2}", time="time: '[log.t]'\n")


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_a_timeseries_brings_its_time_its_name_and_its_unit(tmp_path, version):
    path = tmp_path / "x.mat"
    late = TIME[:2500] * 1e3
    content = {
        "a": timeseries(ANGLE, "steer angle", unit="deg"),
        "p": timeseries(PRESSURE[:2500], time=late, unit="Pa", time_unit="milliseconds"),
    }
    matio.save_to_mat(path, content, version=version)
    record = read_record(path, mapping(tmp_path, angle="steer angle", pressure="p", time=""))
    np.testing.assert_allclose(np.degrees(record["steering_wheel_angle"]), ANGLE[:2500], atol=1e-9)
    np.testing.assert_allclose(record["left_pressure"] * 1e-5, PRESSURE[:2500], atol=1e-9)
    assert any("left_pressure: the file says its unit is 'Pa'" in note for note in record.notes)
    assert not any("steering_wheel_angle: the file says" in note for note in record.notes)


@pytest.mark.parametrize("version", ["v7", "v7.3"])
def test_simulinks_data_set_by_index_and_by_the_signals_names(tmp_path, version):
    path = tmp_path / "x.mat"
    bus = np.empty((1, 1), [("steer", object), ("other", object)])
    bus[0, 0] = timeseries(ANGLE), timeseries(TIME)
    logged = dataset(("vehicle", bus), ("pL", timeseries(PRESSURE)))
    matio.save_to_mat(path, {"logsout": logged}, version=version)
    first = "logsout{1}.Values.steer"
    is_right(path, angle=first, pressure="logsout{2}", time="")
    is_right(path, angle=f"{first}.Data", pressure="logsout{2}.Values.Data", time="")
    is_right(path, angle="vehicle.steer", pressure="pL", time="")
    said = refused(path, angle="vehicle.ster", time="")
    assert "did you mean 'vehicle.steer'" in said
    assert "'logsout{2}.Values.Data' (pL)" in said


@pytest.mark.parametrize("write", [save5, save73])
def test_simulinks_structure_with_time(tmp_path, write):
    path = tmp_path / "x.mat"
    cube = np.stack([PRESSURE, ANGLE])[:, np.newaxis, :]
    signals = [
        {"values": ANGLE[:, np.newaxis], "label": "steer", "dimensions": 1.0},
        {"values": cube, "label": "both", "dimensions": np.array([2.0, 1.0])},
    ]
    write(path, {"yout": {"time": TIME[:, np.newaxis], "signals": signals, "blockName": "m/out"}})
    is_right(path, angle="steer", pressure="yout.signals(2).values(1,1,:)", time="")
    is_right(path, angle="both(2,1,:)", pressure="both(1,1,:)", time="")


@pytest.mark.parametrize("write", [save5, save73])
def test_controldesk_has_an_axis_for_each_signal(tmp_path, write):
    path = tmp_path / "x.mat"
    axes = [{"Data": TIME[::2], "Name": "slow"}, {"Data": TIME, "Name": "fast"}]
    signals = [
        {"Name": '"Model Root"/"SWA [deg]"', "Unit": "rad", "Data": ANGLE, "XIndex": np.int32(2)},
        {"Name": '"Model Root"/"pL"', "Unit": "", "Data": PRESSURE, "XIndex": np.int32(2)},
        {"Name": '"Model Root"/"n"', "Unit": "", "Data": PRESSURE[::2], "XIndex": np.int32(1)},
    ]
    write(path, {"rec_001": {"X": axes, "Y": signals, "Description": "", "Capture": {"n": 1.0}}})
    notes = is_right(path, angle="rec_001.Y(1,1)", pressure="rec_001.Y(2).Data", time="")
    assert any("the file says its unit is 'rad'" in note for note in notes)
    is_right(path, angle="Model Root/SWA [deg]", pressure='"Model Root"/"pL"', time="")
    is_right(path, angle="rec_001.Y(1).Data", pressure="rec_001.Y(2)", time="time: rec_001.X(2)\n")
    raw = read_foreign(path, load_mapping(mapping(tmp_path, "Model Root/n", "rec_001.Y(2)", ""))[0])
    np.testing.assert_array_equal(raw["steering_wheel_angle"].time, TIME[::2])


@pytest.mark.parametrize("version", ["v7", "v7.3"])
@pytest.mark.parametrize("since", [None, "2024-03-01T12:00:00"])
def test_timetables_and_instants(tmp_path, version, since):
    path = tmp_path / "x.mat"
    rows = np.round(TIME * 1e9).astype("m8[ns]")
    rows = rows if since is None else np.datetime64(since, "ns") + rows
    index = pandas.Index(rows, name="Time")
    table = pandas.DataFrame({"angle": ANGLE, "pL": PRESSURE}, index=index)
    with warnings.catch_warnings(action="ignore"):
        matio.save_to_mat(path, {"tt": table, "when": rows, "a": ANGLE}, version=version)
    # A double holds the milliseconds since 1970 to 0.2 microseconds.
    is_right(path, angle="tt.angle", pressure="tt.pL", time="", tolerance=1e-5)
    is_right(path, angle="a", pressure="tt.pL", time="time: when\n", tolerance=1e-5)
    is_right(path, angle="a", pressure="tt.pL", time="time: when\ntime_unit: ms\n", tolerance=1e-5)


def test_a_channel_may_name_its_own_time_and_integers_their_scale(tmp_path):
    path = tmp_path / "x.mat"
    raw = np.round(ANGLE * 1000.0).astype(np.int16)
    matrix = np.stack([TIME[::2], PRESSURE[::2]], axis=1)
    savemat(path, {"angle": raw, "angle_t": TIME, "pL": matrix, "t": TIME[::2]})
    own = ", time: angle_t, scale: 0.001"
    is_right(path, angle="angle", pressure="pL(:,2)", more=own, tolerance=1e-4)
    said = refused(path, pressure="pL(:,2)")
    assert "'angle' has 3000 values, 't' 1500: name the channel's own time with 'time'" in said


def test_a_time_that_contradicts_the_signals_own_is_refused(tmp_path):
    path = tmp_path / "x.mat"
    content = {"t": TIME + 0.3, "t0": TIME, "angle": timeseries(ANGLE), "pL": PRESSURE}
    matio.save_to_mat(path, content, version="v7")
    assert "has a time of its own in the file, which is 0.3 s away from 't'" in refused(path)
    is_right(path, time="time: t0\n")
    is_right(path, time="rate: 1000.0\n")


def test_date_numbers_are_days(tmp_path):
    path = tmp_path / "x.mat"
    savemat(path, VARIABLES | {"t": 738_000.0 + TIME / 86400.0})
    assert "'t' looks like MATLAB's date numbers, which are days" in refused(path)
    # A double holds a date number to ten microseconds.
    is_right(path, time="time: t\ntime_unit: d\n", tolerance=1e-4)


@pytest.mark.parametrize(
    ("value", "why"),
    [
        (np.exp(1j * TIME), "'angle' holds complex numbers"),
        ("20 deg", "'angle' is a text"),
        (np.array(3.0), "'angle' is a single number, 3.0"),
        (np.empty((0, 0)), "'angle' is empty"),
        ({"a": "text"}, "there is no 'angle'"),
        ({"a": ANGLE, "b": ANGLE}, "'angle' is no vector: in it are 'angle.a', 'angle.b'"),
        (csc_array((1 << 20, 1 << 20)), "'angle' is a sparse matrix of 1048576 x 1048576"),
        (np.zeros((30, 40)), "'angle' is 30 x 40 numbers: say which, as 'angle(1,:)'"),
        (ANGLE[:10], "'angle' has 10 values, 't' 3000"),
    ],
)
def test_what_is_no_vector_is_told(tmp_path, value, why):
    path = tmp_path / "x.mat"
    savemat(path, VARIABLES | {"angle": value})
    said = refused(path)
    assert why in said
    assert str(path) in said


def test_objects_that_only_matlab_can_read_cost_themselves_alone(tmp_path):
    path = tmp_path / "x.mat"
    inside = MatlabOpaque({"ANGLE_": ANGLE}, "my.Logger")
    matio.save_to_mat(path, VARIABLES | {"log": inside}, version="v7")
    is_right(path, angle="log.ANGLE")
    found = Vectors(dict(walk({"a": ANGLE, "o": MatlabOpaque(None, "java.io.File")})), "x")
    assert len(found["a"].values) == len(ANGLE)
    with pytest.raises(BenchError, match=r"'o' is an object of class java\.io\.File, which only"):
        found["o"]


def test_an_unknown_name_lists_what_there_is(tmp_path):
    path = tmp_path / "x.mat"
    savemat(path, VARIABLES | {"s": {"text": "x"}, "many": {f"c{k}": TIME for k in range(60)}})
    said = refused(path, angle="angel")
    assert "there is no 'angel'; did you mean 'angle'?" in said
    assert "'t', 'angle', 'pL', 'many.c0'" in said
    assert "'s.text'" not in said
    assert "and 33 more" in said


def test_a_name_that_several_signals_have_is_not_guessed(tmp_path):
    path = tmp_path / "x.mat"
    signals = [{"label": "a", "values": ANGLE}, {"label": "a", "values": PRESSURE}]
    save5(path, {"y": {"time": TIME, "signals": signals}})
    said = refused(path, angle="a", pressure="y.signals(2).values", time="")
    assert "2 vectors are called 'a': say which, y.signals(1).values, y.signals(2).values" in said
    one = {"time": TIME, "signals": [signals[0], {"label": "b", "values": PRESSURE}]}
    save5(path, {"y": one, "z": one})
    said = refused(path, angle="a", pressure="y.signals(2).values", time="")
    assert "2 vectors are called 'a': say which, y.signals(1).values, z.signals(1).values" in said


def damage(kind, data):
    middle = len(data) // 2
    return {
        "empty": b"",
        "text": b"t,angle,pL\n0,1,2\n",
        "zip": b"PK\x03\x04" + data,
        "header": data[:100],
        "cut": data[: middle + 1],
        "end": data[:-3],
        "zeros": data[:middle] + bytes(400) + data[middle + 400 :],
    }[kind]


@pytest.mark.parametrize("kind", ["empty", "text", "zip", "header", "cut", "end", "zeros"])
@pytest.mark.parametrize("version", ["4", "compressed", "7.3"])
def test_a_broken_file_is_named_with_what_is_wrong(tmp_path, kind, version):
    path = tmp_path / "x.mat"
    if version == "7.3":
        save73(path, VARIABLES)
    else:
        savemat(path, VARIABLES, format=version[0].replace("c", "5"), do_compression=True)
    whole = path.read_bytes()
    path.write_bytes(damage(kind, whole))
    if version == "4" and kind == "zeros":
        return  # numbers without a checksum: nobody can tell
    said = refused(path)
    assert f"'{path}' cannot be read as a MAT file: " in said or "is damaged" in said
    wrong = {
        "empty": "it is empty",
        "text": "it is a text file",
        "zip": "it is a zip archive",
        "cut": "cut off",
        "zeros": "damaged",
    }
    assert wrong.get(kind, "") in said


def test_one_damaged_variable_does_not_cost_the_others(tmp_path):
    path = tmp_path / "x.mat"
    savemat(
        path,
        VARIABLES | {"noise": np.random.default_rng(1).normal(size=40000)},
        do_compression=True,
    )
    data = bytearray(path.read_bytes())
    data[-9000:-8900] = bytes(100)
    path.write_bytes(data)
    is_right(path)
    assert "'noise' is damaged" in refused(path, angle="noise")


@pytest.mark.parametrize(
    ("header", "why"),
    [
        ((0, -1, 1, 0, 2), "begins no variable"),
        ((0, 2**31 - 1, 2**31 - 1, 0, 2), "cut off in 'x'"),
        ((2000, 1, 1, 0, 2), "VAX or a Cray"),
    ],
)
def test_a_damaged_length_neither_hangs_nor_fills_the_memory(tmp_path, header, why):
    path = tmp_path / "x.mat"
    first = np.array((0, 1, 1, 0, 2), "<i4").tobytes() + b"a\0" + bytes(8)
    path.write_bytes(first + np.array(header, "<i4").tobytes() + b"x\0" + bytes(8))
    assert why in refused(path)


def test_a_data_set_that_claims_more_than_the_file_holds(tmp_path):
    path = save73(tmp_path / "x.mat", VARIABLES)
    with h5py.File(path, "r+") as file:
        file.create_dataset("huge", (1 << 40, 8), "f8", chunks=(1 << 10, 8), compression="gzip")
    assert "'huge' claims 70,368,744,177,664 bytes, more than the file holds" in refused(path)


NAMES = st.text(string.ascii_letters, min_size=1, max_size=6)
TREES = st.recursive(
    st.integers(2, 5),
    lambda inner: (
        st.dictionaries(NAMES, inner, min_size=1, max_size=3)
        | st.tuples(NAMES, st.lists(inner, min_size=2, max_size=3))
    ),
    max_leaves=8,
)


def grown(tree, address, found):
    """Return what a drawn tree stands for; its vectors go into ``found`` by MATLAB's address."""
    if isinstance(tree, int):
        found[address] = np.arange(tree) + 100.0 * len(found)
        return found[address]
    if isinstance(tree, dict):
        return {name: grown(inner, f"{address}.{name}", found) for name, inner in tree.items()}
    if isinstance(tree, list):
        return cell(*(grown(inner, f"{address}{{{k}}}", found) for k, inner in enumerate(tree, 1)))
    field, members = tree
    return [
        {field: grown(inner, f"{address}({k}).{field}", found)}
        for k, inner in enumerate(members, start=1)
    ]


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.dictionaries(NAMES, TREES, min_size=1, max_size=3),
    st.sampled_from([save5, save73, save_by_matio]),
)
def test_any_nest_of_structures_comes_back_right(tmp_path, trees, write):
    path = tmp_path / "x.mat"
    found: dict[str, np.ndarray] = {}
    write(path, {name: grown(tree, name, found) for name, tree in trees.items()})
    read = vectors(path)
    for address, values in found.items():
        np.testing.assert_array_equal(read[address].values, values)
    with pytest.raises(BenchError, match=re.escape(next(iter(found)))):
        read["nothing_of_that_name"]


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.data(), st.sampled_from([save5, save73]))
def test_any_damage_is_read_right_or_refused(tmp_path, data, write):
    path: Path = tmp_path / "x.mat"
    write(
        path, {"a": {"t": TIME[:300], "x": ANGLE[:300]}, "b": [{"y": ANGLE[:9]}, {"y": TIME[:9]}]}
    )
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(content) - 1))
        content[place : place + 4] = data.draw(st.binary(min_size=4, max_size=4))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    said = str(path)
    try:
        dict(walk(load(path)))
    except BenchError as error:
        said = str(error)
    assert "\n" not in said
    assert str(path) in said


def test_only_channels_of_matlab_files_have_a_time_of_their_own(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("t,angle,pL\n0,1,2\n1,2,3\n")
    assert "only channels of MATLAB files have a 'time'" in refused(path, more=", time: t")
