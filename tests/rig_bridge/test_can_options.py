"""What a rig's file says of a bus: every option of its interface by name, and nothing else."""

import json
from typing import Any

import can
import pytest
from can_rigs import DBC, ends, heard, rig_of, wire
from healthy_rig import EMULATED
from rig_links import FRAME

from rig_bridge.rig_file import RigFile, load_rig
from rig_bridge.transport.can_options import Rates, bus_options, rates, switches
from rig_bridge.transport.registry import check_link, open_link
from rig_bridge.transport.settings import CanSettings, Links
from steering_core.errors import BenchError

SEGMENTS = {"f_clock": 80_000_000, "brp": 10, "tseg1": 11, "tseg2": 4, "sjw": 4}
FD_SEGMENTS = {
    "f_clock": 80_000_000,
    "nom_brp": 2,
    "nom_tseg1": 63,
    "nom_tseg2": 16,
    "nom_sjw": 16,
    "data_brp": 2,
    "data_tseg1": 7,
    "data_tseg2": 2,
    "data_sjw": 2,
}


def settings(**given):
    return CanSettings.model_validate(given)


def rig_text(folder, buses):
    text = EMULATED.read_text()
    old = "  can: {interface: socketcand, channel: can0, host: 127.0.0.1, port: 0}"
    assert old in text
    (folder / "emulated.dbc").write_text(DBC)
    path = folder / "rig.yaml"
    path.write_text(text.replace(old, f"  can: {json.dumps(buses)}"))
    return path


def test_a_file_may_give_one_bus_or_several(tmp_path):
    one = {"interface": "virtual", "fd": True, "bitrate": 500_000, "receive_own_messages": True}
    two = [one, {"interface": "virtual", "channel": 1, "messages": ["Wheel"]}]
    (alone,) = load_rig(rig_text(tmp_path, one)).links.can
    assert (alone.fd, alone.bitrate, alone.more) == (True, 500_000, {"receive_own_messages": True})
    rig = load_rig(rig_text(tmp_path, two))
    assert [bus.channel for bus in rig.links.can] == ["can0", 1]
    assert rig.settings("can")[0]["receive_own_messages"] is True
    written = rig.model_dump(mode="json", by_alias=True, exclude_none=True)["links"]
    assert Links.model_validate(written) == rig.links, "as a bag tells it"


@pytest.mark.parametrize(
    ("buses", "said"),
    [
        ({"bitrate": 0}, "links.can.bitrate: must be greater than 0"),
        ({"data_bitrate": 2_000_000}, "data_bitrate is for CAN FD (fd: true)"),
        ([{"port": 70000}], "port: must be at most 65535"),
        ([], "links.can: "),
        (7, "links.can: "),
        ({"f_clock": 8_000_000, "timing": {"brp": 1}}, "give the bit timing once"),
    ],
)
def test_what_cannot_be_is_refused_with_file_line_and_key(tmp_path, buses, said):
    with pytest.raises(BenchError) as error:
        load_rig(rig_text(tmp_path, buses))
    assert said in str(error.value)
    assert "rig.yaml, line 12" in str(error.value)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"interface": "virtal"}, "unknown CAN interface 'virtal'; did you mean 'virtual'?"),
        ({"interface": "virtual", "chanel": "a"}, "did you mean 'channel'?"),
        ({"interface": "virtual", "recieve_own_messages": 1}, "'receive_own_messages'?"),
        (
            {"interface": "socketcan", "tty_baudrate": 9600},
            "option of the CAN interface 'socketcan'",
        ),
        ({"interface": "slcan", "fd": True}, "'slcan' carries no CAN FD"),
        ({"interface": "socketcan", "timing": SEGMENTS}, "'socketcan' takes no bit timing"),
        ({"interface": "kvaser", "timing": {"f_clock": 1}}, "bit timing: missing 4 required"),
        ({"interface": "kvaser", **SEGMENTS, "brp": 99}, "prescaler (=99) must be in [1...64]"),
        ({"interface": "kvaser", "timing": {**SEGMENTS, "tseg3": 1}}, "argument 'tseg3'"),
        ({"interface": "kvaser", "fd": True, "timing": SEGMENTS}, "needs nom_brp"),
        ({"interface": "kvaser", "timing": FD_SEGMENTS}, "needs brp, tseg1"),
        ({"interface": "pcan", "state": "asleep"}, "unknown state of a CAN bus 'asleep'"),
        ({"interface": "usb2can"}, "'usb2can' cannot be used here"),
    ],
)
def test_an_option_that_cannot_be_is_refused_before_the_run(tmp_path, given, said):
    with pytest.raises(BenchError) as error:
        check_link("can", rig_of(tmp_path, given), tmp_path)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_options_go_to_the_interface_under_their_own_names(tmp_path):
    bus = {"interface": "virtual", "channel": "mine", "receive_own_messages": True}
    with ends(tmp_path, bus) as (bench, rig):
        rig.send_frame(FRAME)
        assert len(heard(rig.buses.buses[0])) == len(heard(bench.buses.buses[0])) == 4
    kvaser = settings(interface="kvaser", channel=0, bitrate=500_000, single_handle=True)
    told = {"channel": 0, "bitrate": 500_000, "single_handle": True, "fd": False}
    assert bus_options(kvaser) == told
    pcan = settings(interface="pcan", state="passive", auto_reset=True)
    assert bus_options(pcan)["state"] is can.BusState.PASSIVE
    assert "bitrate" not in bus_options(settings(bitrate=500_000)), "ip link sets it"


def test_nothing_comes_from_the_user_s_own_files_or_shell(tmp_path, monkeypatch):
    monkeypatch.setenv("CAN_CHANNEL", "elsewhere")
    monkeypatch.setenv("CAN_CONFIG", '{"receive_own_messages": true}')
    bus = {"interface": "virtual", "channel": "here"}
    link: Any = open_link("can", rig_of(tmp_path, bus), tmp_path, bus)
    with wire(bus) as other:
        link.send_frame(FRAME)
        assert len(heard(other)) == 4
        assert heard(link.buses.buses[0]) == []
    link.close()


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, None),
        ({"bitrate": 500_000}, Rates(500_000, 500_000)),
        ({"bitrate": 500_000, "fd": True, "data_bitrate": 2_000_000}, Rates(500_000, 2_000_000)),
        ({"timing": SEGMENTS}, Rates(500_000, 500_000)),
        (SEGMENTS, Rates(500_000, 500_000)),
        ({"fd": True, **FD_SEGMENTS}, Rates(500_000, 4_000_000)),
        ({"timing": {"f_clock": 8_000_000, "btr0": 0, "btr1": 0x14}}, Rates(1_000_000, 1_000_000)),
        (
            {"timing": {"f_clock": 8_000_000, "bitrate": 250_000, "sample_point": 75.0}},
            Rates(250_000, 250_000),
        ),
    ],
)
def test_bit_rates(given, expected):
    assert rates(settings(**given)) == expected
    assert switches(settings(**given)) == bool(given.get("fd"))


def test_the_schema_for_editors_knows_both_forms():
    schema = RigFile.model_json_schema()
    can_schema = schema["$defs"]["Links"]["properties"]["can"]
    forms = {form.get("type", "object") for form in can_schema["anyOf"]}
    assert forms == {"object", "array"}
