"""What a diagnosis writes: a page that loads nothing, data for machines, the extended model."""

import json
import os
import xml.etree.ElementTree as ET
from html.parser import HTMLParser

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from balance_diagnosis import (
    BalanceError,
    Extended,
    Model,
    Record,
    between,
    diagnose,
    toleranced,
)
from balance_diagnosis.plain_yaml import to_text
from balance_diagnosis.report import words
from balance_diagnosis.report.svg import Line, plot, reduce, ticks

HOSTILE = "<script>alert('x')</script> & \"q\" ' ]]> </svg>"
VOID = {"meta", "link", "br"}


def predict(p, r):
    v = r["v"]
    rub = p.coulomb * np.tanh(v / 1e-2) + (p.viscous + p.drag * np.abs(v)) * v
    return {"force": rub + p.spring * np.cumsum(v) * 0.01 + p.offset}


MODEL = Model(
    predict,
    parameters={"coulomb": toleranced(5.0, 0.3), "viscous": toleranced(10.0, 0.3)},
    causes={
        f"offset {HOSTILE}": {"offset": (0.0, -20.0, 20.0)},
        "drag": {"drag": (0.0, -50.0, 50.0)},
        "spring": {"spring": (0.0, -50.0, 50.0)},
    },
    units={"coulomb": "N", "viscous": "N s/m", "offset": f"N{HOSTILE}"},
    name=f"axis {HOSTILE}",
)


def record(seed, name, samples=2000, **numbers):
    draw = np.random.default_rng(seed)
    times = 0.01 * np.arange(samples)
    v = np.sin(times * (1.0 + 0.1 * seed)) + 0.3 * np.sin(3.7 * times + seed)
    blank = Record(times, {"v": v, "force": 0.0 * v}, name=name)
    made = MODEL.predicted({"coulomb": 5.2, "viscous": 9.5, **numbers}, blank).outputs["force"]
    noisy = made + 0.05 * draw.standard_normal(samples)
    return Record(times, {"v": v, "force": noisy}, {"force": "N"}, name=name)


@pytest.fixture(scope="module")
def diagnosis():
    fit = record(1, f"monday {HOSTILE}", offset=3.0)
    return diagnose(MODEL, fit=[fit], holdout=[record(2, "tuesday", offset=3.0)])


@pytest.fixture(scope="module")
def written(diagnosis, tmp_path_factory):
    return diagnosis.write(tmp_path_factory.mktemp("written") / "a" / "b").parent


class Reader(HTMLParser):
    """Reads a page: its text, what is open, what it would load."""

    def __init__(self):
        super().__init__()
        self.open, self.text, self.loads, self.tags = [], [], [], set()

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.loads += [v for k, v in attrs if k in ("src", "href", "srcset", "data")]
        if tag not in VOID and tag != "path":
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.add(tag)

    def handle_endtag(self, tag):
        if tag != "path":
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.text.append(data)


def read(page):
    reader = Reader()
    reader.feed(page)
    reader.close()
    assert not reader.open
    return reader


def test_the_page_is_one_file_that_loads_and_runs_nothing(written):
    page = (written / "page.html").read_text("utf-8")
    reader = read(page)
    assert "script" not in reader.tags
    assert not reader.loads
    assert "default-src 'none'" in page
    assert len(page) < 1.5e6
    assert sorted(os.listdir(written)) == ["extended_model.yaml", "page.html", "report.json"]


def test_the_page_tells_verdict_sizes_reasons_records_and_call(written, diagnosis):
    text = " ".join(read((written / "page.html").read_text("utf-8")).text)
    verdict = diagnosis.verdict
    assert verdict.named == (f"offset {HOSTILE}",)
    told = words.size(diagnosis.causes[verdict.named[0]]["offset"], MODEL)
    assert told in text
    for cause in ("drag", "spring"):
        assert cause in text
        assert verdict.refused[cause] in text
    assert f"diagnose(model, fit=['monday {HOSTILE}'"[:20] in text
    assert "held out" in text
    assert "tuesday" in text
    for channel in ("force [N]", "v"):
        assert channel in text
    for foreign in ("steering", "bag", "valve", "torsion"):
        assert foreign not in text


def test_every_drawing_is_well_formed_and_inside_of_its_frame(written):
    page = (written / "page.html").read_text("utf-8")
    drawings = ["<svg" + part.split("</svg>")[0] + "</svg>" for part in page.split("<svg")[1:]]
    assert len(drawings) == 4
    for drawing in drawings:
        root = ET.fromstring(drawing)
        width, height = (float(v) for v in root.attrib["viewBox"].split()[2:])
        curves = [e.attrib["d"] for e in root.iter() if e.attrib.get("class") == "c"]
        assert len(curves) in (2, 3)
        for curve in curves:
            points = np.array([p.split() for p in curve.replace("M", "L").split("L")[1:]], float)
            assert len(points) > 500
            assert np.all((points >= 0.0) & (points <= (width, height)))


def test_the_report_for_machines_is_strict_json_with_the_same_answer(written, diagnosis):
    def never(text):
        raise AssertionError(text)

    told = json.loads((written / "report.json").read_text("utf-8"), parse_constant=never)
    assert told["schema"] == 1
    assert told["verdict"] == diagnosis.verdict.word
    assert told["named"] == list(diagnosis.verdict.named)
    assert told["refused"] == diagnosis.verdict.refused
    found = told["causes"][told["named"][0]]["offset"]
    assert found["low"] < 3.0 < found["high"]
    assert [e["held_out"] for e in told["errors"]] == [False, True]
    assert told["records"][1]["sha256"] == diagnosis.holdout[0].digest()


def test_the_extended_model_is_read_back_and_predicts_the_same(written, diagnosis):
    file = written / "extended_model.yaml"
    assert yaml.safe_load(file.read_text("utf-8")) == json.loads(file.read_text("utf-8"))
    again = Extended.read(MODEL, file)
    held = diagnosis.holdout[0]
    made = again.predicted(held).outputs["force"]
    assert np.array_equal(made, diagnosis.curves[1].extended)
    assert np.array_equal(made, diagnosis.predicted(held).outputs["force"])
    assert np.std(held["force"] - made) < 0.06


def test_an_edited_extended_model_is_read_as_yaml_and_faults_are_named(tmp_path):
    file = tmp_path / "mine.yaml"
    head = "schema: 1\nparameters: {coulomb: 5, viscous: {value: 1e+1}}\n"
    file.write_text("schema: 1\nparameters: {coulomb: 5, viscous: {value: 10.0}}\ncauses:\n"
                    "  drag: {drag: {value: 2.0}}\n")  # fmt: skip
    assert Extended.read(MODEL, file).values == {"coulomb": 5.0, "viscous": 10.0, "drag": 2.0}
    for text, told in {
        "schema: 2": "it has no 'schema: 1'",
        "schema: 1\nparameters: {coulomb: 5}": "has no value of 'viscous'",
        head + "causes: {leak: {leak: 1.0}}": "the model has no cause 'leak'",
        head + "causes: {drag: {darg: 1.0}}": "the model has no 'darg'",
        head.replace("5", "five"): "'coulomb' has no number as its value, but 'five'",
        head + "causes: [drag]": "'causes' has to hold names with their values",
        "schema: [": "is no YAML",
    }.items():
        file.write_text(text.replace("1e+1", "10.0"))
        with pytest.raises(BalanceError) as caught:
            Extended.read(MODEL, file)
        assert told in str(caught.value)
        assert str(file) in str(caught.value)


def test_a_start_that_is_not_known_is_asked_for():
    def level(p, r):
        return {"y": p.gain * r["u"] + p.first + p.offset}

    times = np.arange(100.0)
    model = Model(
        level,
        parameters={"gain": toleranced(1.0, 0.1)},
        starts={"first": toleranced(0.0, plus_minus=5.0)},
        causes={"offset": {"offset": (0.0, -1.0, 1.0)}},
    )
    extended = Extended(model, {"gain": 1.0}, {"known": {"first": 2.0}})
    known, other = (Record(times, {"u": times, "y": times}, name=n) for n in ("known", "other"))
    assert extended.predicted(known).outputs["y"][0] == 2.0
    assert extended.predicted(other, first=1.0).outputs["y"][0] == 1.0
    with pytest.raises(BalanceError, match="record 'other' was not fitted: give its starts"):
        extended.predicted(other)
    with pytest.raises(BalanceError, match="the model has no start 'frist'"):
        extended.predicted(known, frist=1.0)


def test_a_folder_that_cannot_be_written_is_named(diagnosis, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BalanceError, match="cannot be written"):
        diagnosis.write(tmp_path / "file")


def test_many_long_records_stay_a_small_page(diagnosis, tmp_path):
    from dataclasses import replace

    curve = diagnosis.curves[0]
    rng = np.random.default_rng(0)
    long = [
        replace(
            curve,
            record=f"r{k}",
            times=np.arange(2e4),
            measured=rng.standard_normal(20000),
            nominal=rng.standard_normal(20000),
            extended=rng.standard_normal(20000),
        )
        for k in range(30)
    ]
    gains = [replace(diagnosis.gains[0], record=c.record) for c in long]
    many = replace(diagnosis, curves=tuple(long), gains=tuple(gains))
    page = many.write(tmp_path).read_text("utf-8")
    assert len(page) < 1.5e6
    assert "Of 30 outputs the 24 with the largest errors are drawn." in page


@given(
    st.lists(st.floats(-1e6, 1e6) | st.just(float("nan")), min_size=1, max_size=400),
    st.integers(1, 50),
)
def test_what_a_screen_shows_keeps_extremes_and_order(values, columns):
    x, y = np.arange(len(values), dtype=float), np.array(values)
    thin_x, thin_y = reduce(x, y, columns)
    assert len(thin_x) == len(thin_y) <= max(2 * columns, 2)
    assert np.all(np.diff(thin_x) >= 0.0)
    if np.isfinite(y).any():
        assert np.nanmax(thin_y) == np.nanmax(y)
        assert np.nanmin(thin_y) == np.nanmin(y)
    else:
        assert np.isnan(thin_y).all()


@given(st.floats(-1e9, 1e9), st.floats(1e-6, 1e9))
def test_ticks_are_round_inside_and_few(low, span):
    high = low + span
    if not high - low > 1e-9 * max(abs(low), abs(high)):
        return
    made = ticks(low, high, 5)
    assert len(made) <= 6
    assert all(low - 1e-6 * span <= t <= high + 1e-6 * span for t in made)


@pytest.mark.parametrize("y", [np.zeros(60), np.full(60, np.nan), np.full(60, -3.0)])
def test_a_constant_or_missing_curve_is_drawn(y):
    ET.fromstring(plot([Line(np.arange(60.0), y, "y")], "y", "time [s]", "y", 100))


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
        | st.text(st.characters(codec="ascii", exclude_categories=["Cc"])),
        lambda inner: st.lists(inner) | st.dictionaries(st.text("ab: #'\""), inner),
        max_leaves=12,
    )
)  # fmt: skip
def test_what_is_written_is_the_same_to_readers_of_json_and_of_yaml(data):
    text = to_text(data)
    assert json.loads(text) == data
    assert yaml.safe_load(text) == data


def test_numbers_are_written_as_people_do():
    assert [words.number(v) for v in (1237.4, -0.00123, 3.1e-7, 2.5e7, float("nan"))] == [
        "1240", "−0.00123", "3.1e−07", "2.5e+07", "none",
    ]  # fmt: skip
    assert words.probability(0.9999999) == "above 0.999"
    assert words.percent(0.99999) == "above 99.9 %"


def test_a_number_at_its_bound_is_said_so():
    from balance_diagnosis.intervals import Estimate

    cause = next(iter(MODEL.causes))
    assert words.size(Estimate("offset", cause, 20.0, 15.0, 20.0), MODEL).endswith("at its bound")
    assert "at its bound" not in words.size(Estimate("offset", cause, 0.0, -1.0, 1.0), MODEL)
    assert "at its bound" not in words.size(Estimate("offset", cause, 19.0, 15.0, 20.0), MODEL)


def test_an_interval_is_told_with_the_digits_that_it_is_worth():
    from balance_diagnosis.intervals import Estimate

    narrow = Estimate("spring", "spring", 12.00412, 11.99817, 12.01007)
    assert words.spread(narrow, "N/m") == ("12.004 N/m", "11.998 to 12.01 N/m")
    assert words.spread(Estimate("spring", "", 3.1, 2.0, 4.2), "") == ("3.1", "2 to 4.2")
    assert words.spread(Estimate("spring", "", 5.0, 5.0, 5.0), "")[1] == "5 to 5"


def test_an_extended_model_that_is_worse_is_said_to_be(diagnosis):
    from dataclasses import replace

    from balance_diagnosis.held_out import Gain

    told = words.gained(diagnosis, {"force": "N"})
    assert told.startswith("On held-out data the rms error of force falls from ")
    assert told.endswith(" N.")
    gains = (Gain("a", "force", 1.0, 0.9, True), Gain("b", "force", 1.0, 1.5, True))
    worse = words.gained(replace(diagnosis, gains=gains), {"force": "N"})
    assert worse == (
        "On held-out data the rms error of force grows from 1 to 1.24 N (worse on 1 of 2 records)."
    )


def test_what_was_known_before_is_told_and_what_is_no_better_known():
    from balance_diagnosis.intervals import Estimate

    mass, wide = toleranced(95.0, 0.2), between(0.2, 20.0)
    assert words.known(mass) == "95 ± 19"
    assert words.known(wide) == "0.2 to 20"
    assert not words.undetermined(Estimate("m", "", 95.0, 94.0, 96.0), mass)
    assert words.undetermined(Estimate("m", "", 95.0, 77.0, 113.0), mass)
    assert not words.undetermined(Estimate("k", "", 2.0, 1.0, 4.0), wide)
    assert words.undetermined(Estimate("k", "", 2.0, 0.2, 20.0), wide)
