"""The page of a diagnosis shows verdict, proof, gain and rivals, and opens offline."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from steering_diagnosis.engine.reporting import sentence
from steering_diagnosis.engine.structure import FreeForm
from steering_diagnosis.pages import diagnosis_page
from steering_diagnosis.pages.shown import probability
from steering_diagnosis.report import (
    BalanceError,
    Cause,
    Diagnosis,
    Estimate,
    Overlay,
    Refitted,
    Report,
    Rival,
    Signal,
    Source,
    Unexplained,
)
from steering_diagnosis.writing import tell

TIME = np.arange(0.0, 8.0, 1e-3)


def report(**changes) -> Report:
    cause = Cause(
        effect="cross_piston_leakage",
        balance="chamber continuity",
        parameters={"leakage": Estimate(value=2e-12, low=1.8e-12, high=2.2e-12, unit="m3/(s Pa)")},
        p_value=1e-4,
        delta_bic=240.0,
        gain={"left_pressure": 0.91},
    )
    signal = Signal(
        unit="Pa",
        noise=2e3,
        rmse_nominal=9e3,
        rmse_refitted=8e3,
        rmse_extended=2.1e3,
        noise_holdout=2e3,
        rmse_nominal_holdout=9e3,
        rmse_refitted_holdout=8e3,
        rmse_extended_holdout=2.4e3,
    )
    values: dict[str, Any] = {
        "bag": Source(path="drive/run_7", sha256="0" * 64),
        "software": "0.1.0",
        "verdict": "named",
        "sentence": "Oil leaks past the piston <seal>.",
        "causes": [cause],
        "rivals": [Rival(effect="entrained_air", score=3.1, why_not="its lag grows elsewhere")],
        "signals": {"left_pressure": signal},
    }
    return Report(**(values | changes))


def diagnosis(**changes) -> Diagnosis:
    measured = 5e5 + 1e5 * np.sin(TIME)
    overlay = Overlay("Pa", measured, measured - 8e3, measured - 7e3, measured - 1e3)
    balance = BalanceError(
        "chamber continuity",
        "m3/s",
        0.8,
        6.0,
        1e-6 * np.sin(TIME),
        1e-7 * np.sin(TIME),
        {"pressure": (np.linspace(0.0, 1e6, 5), np.linspace(1e-7, 1e-6, 5))},
    )
    held = TIME % 2.0 < 0.5
    return Diagnosis(report(**changes), TIME, {"left_pressure": overlay}, (balance,), held)


def test_the_page_shows_the_verdict_and_escapes_it():
    text = diagnosis_page(diagnosis()).render()
    assert "Oil leaks past the piston &lt;seal&gt;." in text
    for word in ("cross piston leakage", "entrained air", "its lag grows elsewhere", "run_7"):
        assert word in text
    assert "src=" not in text.split("<script>")[0]


def test_the_gain_is_the_share_of_energy_above_the_noise():
    text = diagnosis_page(diagnosis()).render()
    share = 1.0 - (2.4e3**2 - 2e3**2) / (8e3**2 - 2e3**2)
    assert f"{100.0 * share:.0f} %" in text


@pytest.mark.parametrize("verdict", ["clean", "unexplained", "insufficient_excitation"])
def test_a_page_without_causes_is_whole(verdict):
    left = [Unexplained(balance="rack force", band_hz=(15.0, 40.0), region="above 5 mm", share=0.4)]
    text = diagnosis_page(diagnosis(verdict=verdict, causes=[], unexplained=left)).render()
    assert "15 to 40 Hz" in text


def test_a_free_form_term_is_told_in_words():
    left = [Unexplained(balance="rack force", band_hz=(1.0, 3.0), region="above 5 mm", share=0.4)]
    term = FreeForm(
        "left_pressure", "rack force", "rack position [m]", (0.0, 1e-3), (0.0, 1.0), 0.6
    )
    made = diagnosis(verdict="unexplained", causes=[], unexplained=left)
    text = diagnosis_page(replace(made, free_form=asdict(term))).render()
    assert "a curve over rack position [m] takes 60 % off left pressure" in text


def test_the_report_reads_back_and_refuses_what_is_unknown_or_infinite():
    made = report()
    again = Report.model_validate(json.loads(made.model_dump_json()))
    assert again == made
    assert json.loads(made.model_dump_json())["schema"] == 1
    with pytest.raises(ValidationError):
        Report.model_validate({**made.model_dump(), "cause": "x"})
    with pytest.raises(ValidationError):
        Estimate(value=float("nan"), low=0.0, high=1.0, unit="1")
    with pytest.raises(ValidationError):
        report(causes=[{**made.causes[0].model_dump(), "ambiguous_with": ["a", "b", "c"]}])


@pytest.mark.parametrize(("p", "text"), [(0.0, "below 1e-300"), (3.2e-5, "3.2e-05")])
def test_a_certain_cause_has_no_probability_of_zero(p, text):
    assert probability(p) == text


def test_a_tolerance_that_is_used_up_is_told_on_page_and_terminal():
    moved = {
        "mechanics.rack_mass": Refitted(nominal=24.0, refitted=26.4, tolerance=2.4),
        "oil.density": Refitted(nominal=850.0, refitted=851.0, tolerance=17.0),
    }
    made = diagnosis(nuisance=moved)
    (warned,) = [line for line in tell(made, [Path("page")]) if "end of their tolerance" in line]
    assert "mechanics.rack_mass" in warned
    assert "oil.density" not in warned
    text = diagnosis_page(made).render()
    assert "at the end of their tolerance: mechanics.rack_mass;" in text
    assert text.count("(at its end)") == 1


def test_the_score_of_a_rival_is_explained_and_how_the_file_was_read_is_told():
    made = diagnosis(notes=["read as: utf-8, separator comma", "something else"])
    assert "Score: by how much" in diagnosis_page(made).render()
    assert "read as: utf-8, separator comma" in diagnosis_page(made).render()
    lines = tell(made, [Path("page")])
    assert "read as: utf-8, separator comma" in lines
    assert "note: something else" in lines


@pytest.mark.parametrize(
    ("noise", "told"),
    [(1.0, "down to the noise."), (0.95, "down to the noise."), (0.25, "4 times the noise in x")],
)
def test_a_clean_record_is_explained_as_far_as_its_errors_say(noise, told):
    output, errors = SimpleNamespace(name="x"), SimpleNamespace(refitted=1.0, noise=noise)
    found: Any = SimpleNamespace(
        causes=(), unexplained=(), verdict="clean", outputs=(output,), fitted={"x": errors}
    )
    assert sentence(found).startswith("Clean: ")
    assert told in sentence(found)
