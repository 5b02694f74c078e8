"""Differences that were put in come out."""

import json

import numpy as np
import pytest

from steering_bringup.bags import BagError
from steering_bringup.comparison import compare, summary, verdict, write_page


def test_differences_are_those_put_in(pair):
    result = compare(*pair)
    time = result.time
    wanted = 0.04 * 0.2 * time * np.cos(0.2 * np.pi * time**2)
    assert result.names == ("open-centre", "closed-centre")
    assert np.allclose(result.error("steering_wheel_torque"), wanted, atol=1e-12)
    torque = result.differences["steering_wheel_torque"]
    assert torque.largest == pytest.approx(np.max(np.abs(wanted)))
    assert torque.rms == pytest.approx(np.sqrt(np.mean(wanted**2)))
    assert torque.at == time[np.argmax(np.abs(wanted))]
    assert torque.unit == "N m"
    pressure = result.differences["assistance_pressure"]
    assert pressure.largest == pytest.approx(0.2e5 / 0.04 * torque.largest)
    assert result.differences["supply_pressure"].mean == pytest.approx(164e5)
    assert result.differences["steering_wheel_angle"].largest == 0.0


def test_assistance_pressure_is_right_minus_left(make_run):
    def raise_right(fields, ticks):
        fields["/steering/pressure"]["right"] = fields["/steering/pressure"]["right"] + 3e5

    result = compare(make_run("a"), make_run("b", change=raise_right))
    assert result.differences["assistance_pressure"].mean == pytest.approx(3e5)


def test_the_order_of_the_runs_turns_the_sign(pair):
    there, back = compare(*pair), compare(pair[1], pair[0])
    for key, item in there.differences.items():
        assert back.differences[key].largest == item.largest
        assert back.differences[key].mean == -item.mean
    assert back.names == ("closed-centre", "open-centre")


def test_energy_and_work(pair):
    first, second = compare(*pair).energies
    assert first.supply == pytest.approx(240.0 * 9.999)
    assert second.mean_power == pytest.approx(150.0)
    assert first.duration == pytest.approx(9.999)
    # Second route: the held torque times the way that the steering wheel goes in the tick.
    phase = 0.2 * np.pi * (np.arange(10_000) * 1e-3) ** 2
    way = np.radians(30.0) * np.diff(np.sin(phase))
    assert first.driver_work == pytest.approx(np.sum(3.0 * np.sin(phase[:-1]) * way), abs=1e-3)


def test_runs_of_different_length_are_compared_on_their_common_ticks(make_run):
    result = compare(make_run("a", duration=9.0), make_run("b", closed=True, start=1000))
    assert (result.time[0], result.time[-1], len(result.time)) == (1.0, 8.999, 8000)
    notes = " ".join(result.notes)
    assert "common ticks 1000 to 8999" in notes
    assert "a has 1000 ticks more" in notes
    assert result.energies[0].supply == pytest.approx(240.0 * 7.999)
    assert result.differences["steering_wheel_angle"].largest == 0.0


def test_what_is_missing_is_said_and_left_out(make_run):
    result = compare(
        make_run("a", without=("/driver/torque",)),
        make_run("b", closed=True, without=("/truth/plant",)),
    )
    notes = " ".join(result.notes)
    assert "a does not hold: steering wheel torque" in notes
    assert "b holds no /truth/plant" in notes
    assert "steering_wheel_torque" not in result.differences
    assert result.energies[1].supply is None
    assert result.energies[0].driver_work is None
    assert "not known" in summary(result)


def test_runs_that_share_nothing_are_refused(make_run):
    with pytest.raises(BagError, match="share no signal"):
        compare(make_run("a", without=tuple(_every())), make_run("b"))
    with pytest.raises(BagError, match="share no tick"):
        compare(make_run("c", duration=1.0), make_run("d", start=2000))


def _every():
    return ("/steering/torque", "/steering/pressure", "/steering/rack", "/driver/torque")


def test_values_that_are_no_numbers_are_said_and_left_out(make_run, tmp_path):
    def spoil(fields, ticks):
        fields["/driver/torque"]["torque"][100:103] = np.nan

    result = compare(make_run("a"), make_run("b", closed=True, change=spoil))
    assert "steering_wheel_torque" not in result.differences
    assert any("b: steering wheel torque is left out, 3 values" in n for n in result.notes)
    write_page(result, tmp_path / "page.html")
    json.dumps(result.to_dict(), allow_nan=False)


def test_a_single_common_tick_is_enough(make_run, tmp_path):
    result = compare(make_run("a", duration=1.0), make_run("b", closed=True, start=999))
    assert len(result.time) == 1
    assert result.growths["steering_wheel_torque"] is None
    assert "not known" in summary(result)
    write_page(result, tmp_path / "page.html")
    json.dumps(result.to_dict(), allow_nan=False)


def test_bags_of_one_name_are_told_apart_by_their_folders(make_run):
    result = compare(make_run("on_centre-1/run"), make_run("on_centre-2/run", kind="weave"))
    assert result.names == ("on_centre-1/run", "on_centre-2/run")


def test_identical_runs_are_called_so(make_run):
    result = compare(make_run("a"), make_run("b"))
    assert result.identical
    assert verdict(result).sentence == "a and b are the same run, bit for bit."


def test_limits_hold_for_the_pair_they_were_set_for(pair, make_run):
    assert verdict(compare(*pair)).good is True

    def worse(fields, ticks):
        fields["/driver/torque"]["torque"] = fields["/driver/torque"]["torque"] * 1.05

    bad = verdict(compare(pair[0], make_run("worse", closed=True, change=worse)))
    assert bad.good is False
    assert "limit 0.1 N m" in bad.sentence
    assert "not within" in bad.sentence
    same = verdict(compare(pair[0], make_run("other_open", change=worse)))
    assert same.good is None
    park = [make_run(f"park{c}", closed=c, load="dry_park") for c in (False, True)]
    assert verdict(compare(*park)).good is None


def test_parameters_that_differ_are_listed(pair, make_run):
    other = make_run("heavy", closed=True, parameters={"mechanics.rack_mass": 30.0})
    changed = compare(pair[0], other).changed
    assert changed == [("parameters.mechanics.rack_mass", 24.0, 30.0)]


def test_the_dictionary_is_json_in_si(pair):
    data = json.loads(json.dumps(compare(*pair).to_dict(), allow_nan=False))
    assert data["differences"]["assistance_pressure"]["unit"] == "Pa"
    assert data["differences"]["assistance_pressure"]["largest"] == pytest.approx(40e3, rel=0.02)
    assert [run["system"] for run in data["runs"]] == ["open-centre", "closed-centre"]
    assert data["growth"]["steering_wheel_torque"]["with_frequency_only"] is True


def test_the_summary_is_aligned_and_fits_a_terminal(pair):
    text = summary(compare(*pair))
    lines = text.splitlines()
    assert max(len(line) for line in lines) <= 100
    torque = next(line for line in lines if line.startswith("steering wheel torque "))
    assert "0.080" in torque
    assert torque.endswith("0.1 N m")
    power = next(line for line in lines if line.startswith("mean hydraulic power"))
    assert power.split()[-4:] == ["240", "W", "150", "W"]


def test_a_cut_bag_is_compared_as_far_as_it_goes(pair):
    path = pair[1].path
    (path / "metadata.yaml").unlink()
    with next(path.glob("*.mcap")).open("r+b") as file:
        file.truncate(file.seek(0, 2) // 2)
    from steering_bringup.bags import read_bag

    result = compare(pair[0], read_bag(path))
    assert 4.0 < result.duration < 6.0
    assert any("recovered" in note for note in result.notes)
    assert result.differences["steering_wheel_angle"].largest == 0.0
