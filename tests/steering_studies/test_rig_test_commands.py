"""The commands of the rig tests, one after the other, as a user would."""

import json

import pytest

from steering_bringup.cli import main


def test_record_identify_and_validate(tmp_path, capsys):
    bags, mine = tmp_path / "rig", tmp_path / "mine"
    assert main(["rig-test", "stiffness", "system", "--out", str(bags)]) == 0
    numbers = tmp_path / "numbers.json"
    options = ["--out", str(mine), "--name", "gear", "--json", str(numbers)]
    assert main(["identify", str(bags), *options]) == 0
    found = json.loads(numbers.read_text())
    assert found["mechanics.torsion_bar_stiffness"]["value"] == pytest.approx(60.734, rel=0.01)
    assert "no test 'inertia'" in capsys.readouterr().out
    gear = ["--parameter-set", str(mine / "gear.yaml"), "--out", str(tmp_path / "validation")]
    assert main(["validate", str(bags / "system"), *gear]) == 0
    assert (tmp_path / "validation" / "validation.html").exists()
    assert (mine / "identification.html").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["rig-test", "boost_curv"], "did you mean 'boost_curve'"),
        (["rig-test", "--set", "mechanics.rack_mas=3"], "did you mean 'mechanics.rack_mass'"),
        (["identify", "nowhere"], "no bag or folder 'nowhere'"),
        (["validate", "nowhere"], "there is no bag 'nowhere'"),
    ],
)
def test_wrong_calls_are_one_line(arguments, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 1
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
