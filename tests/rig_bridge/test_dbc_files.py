"""DBC files as they are: faults in messages that the rig does not use never stand in its way."""

import codecs
from typing import Any

import cantools
import pytest
from can_rigs import DBC, FD_ATTRIBUTES, rig_of, virtual

from rig_bridge.transport.dbc import layout_text, load_dbc
from rig_bridge.transport.registry import check_link
from steering_core.errors import BenchError

OTHER = 'BO_ 300 Other: 8 Rig\n SG_ A : 0|8@1+ (1,0) [0|255] "" Bench\n'


def with_message(text):
    return DBC.replace("BO_ 257 Pressure", text + "\n\nBO_ 257 Pressure")


ELSEWHERE = {
    "overlap": with_message(OTHER + ' SG_ B : 4|8@1+ (1,0) [0|255] "" Bench'),
    "beyond the message": with_message(OTHER.replace("8 Rig", "0 Rig")),
    "a signal without bits": with_message(OTHER + ' SG_ B : 9|0@1+ (1,0) [0|1] "" Bench'),
    "an identifier of 12 bits": with_message(OTHER.replace("300", "3000")),
    "an identifier of 30 bits": with_message(OTHER.replace("300", str(1 << 31 | 1 << 29))),
    "a name that begins with a digit": with_message(OTHER + " SG_ 2nd : 9|1@1+ (1,0) [0|1] Bench"),
    "no unit": with_message(OTHER + " SG_ B : 9|1@1+ (1,0) [0|1] Bench"),
    "letters that are no identifier": with_message(OTHER.replace("SG_ A", "SG_ Größe")),
    "half a message": with_message("BO_ 300 Other"),
    "an odd quote": with_message(OTHER + ' SG_ B : 9|1@1+ (1,0) [0|1] " Bench'),
    "multiplexed": with_message(
        OTHER.replace("SG_ A", "SG_ M M") + OTHER[22:].replace("A", "A m1")
    ),
    "longer than CAN carries": with_message(OTHER.replace(": 8 Rig", ": 1785 Rig")),
    "the same name twice": with_message(OTHER + "\n" + OTHER.replace("300", "301")),
    "the same number twice": with_message(OTHER + "\n" + OTHER.replace("Other", "More")),
    "no signals": with_message("BO_ 300 Other: 0 Vector__XXX"),
    "signals in no message": with_message(
        OTHER.replace("300 Other", f"{3 << 30} VECTOR__INDEPENDENT_SIG_MSG")
    ),
    "a value table of nothing": DBC + '\nVAL_ 300 Gone 0 "off" 1 "on" ;\n',
    "a value table of no signal": DBC + '\nVAL_ 257 Gone 0 "off" 1 "on" ;\n',
    "a value table with a fault": DBC + "\nVAL_ 300 Gone 0 off ;\n",
    "a float of nothing": DBC + "\nSIG_VALTYPE_ 300 Gone : 1;\n",
    "a float of no signal": DBC + "\nSIG_VALTYPE_ 257 Gone : 1;\n",
    "an attribute that nobody defined": DBC + '\nBA_ "GenMsgCycleTime" BO_ 300 10;\n',
    "an attribute without a value": DBC + '\nBA_DEF_ BO_ "X" INT 0 1;\nBA_ "X" BO_ 300;\n',
    "a comment without an end": DBC + '\nCM_ SG_ 257 Left "no end\n',
    "a comment of nothing": DBC + '\nCM_ 145 "of what?";\n',
    "a comment over lines": DBC
    + '\nCM_ BO_ 257 "see\nBO_ 257 Pressure: 8\nabove";\nVAL_ 1 G 0 "" ;',
    "words of a later version": DBC + "\nSIG_NEW_ 257 Left 1 2 3;\n",
    "no nodes": DBC.replace("BU_: Bench Rig\n", ""),
    "lines of another machine": DBC.replace("\n", "\r\n"),
}


@pytest.mark.parametrize("what", ELSEWHERE)
def test_a_fault_elsewhere_changes_nothing(tmp_path, what):
    rig = rig_of(tmp_path, virtual())
    (tmp_path / "rig.dbc").write_text(ELSEWHERE[what])
    check_link("can", rig, tmp_path)
    names = [line.split()[2] for line in DBC.splitlines() if line.startswith("BO_ ")]
    used = [load_dbc(tmp_path / "rig.dbc").get_message_by_name(name.rstrip(":")) for name in names]
    shipped: Any = cantools.database.load_string(DBC, "dbc")
    assert layout_text(cantools.database.can.Database(used)) == layout_text(shipped)


def test_what_could_not_be_read_is_told(tmp_path):
    rig = rig_of(tmp_path, virtual(), ELSEWHERE["overlap"])
    (note,) = check_link("can", rig, tmp_path)
    assert "1 messages that the rig does not use have faults (Other: The signals" in note


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("SG_ Right : 20|20@1-", "SG_ Right : 10|20@1-", "'Pressure': The signals Right and Left"),
        ("SG_ Right : 20|20@1-", "SG_ Right : 60|20@1-", "does not fit in message Pressure"),
        ("SG_ Right : 20|20@1-", "SG_ Right : 20|20@1", "message 'Pressure': Invalid syntax"),
        ("BO_ 257 P", "BO_ 2570 P", "'Pressure': Standard frame id 0xa0a is more than 11 bits"),
        ("BO_ 257 P", "BO_ 256 P", "Wheel and Pressure have the same CAN identifier"),
        ("BO_ 257 P", "BO_ 512 P", "the CAN message Pressure cannot go both ways"),
        ("BO_ 258 Rack", "BO_ 258 Wheel", "2 messages are called 'Wheel'"),
        ("SG_ Right :", "SG_ Left :", "signals Left and Left are overlapping"),
        ("SG_ Left :", "SG_ Left M :", "message 'Pressure': it is multiplexed ('Left')"),
        ("257 Pressure: 8", "257 Pressure: 12", "'Pressure' has 12 bytes, but the bus virtual"),
        ("257 Pressure: 8", "257 Pressure: 65", "65 bytes are longer than any frame"),
        ("SG_ Right : 20|20@1- (1,", "SG_ Right : 20|20@1- (0,", "Pressure.Right has a scale of 0"),
        (
            "SG_ Counter : 60|4@1+",
            "SG_ Counter : 60|4@1-",
            "Counter must be a whole number without",
        ),
        ("SG_ Clock : 0|32@1+", "SG_ Clock : 0|32@1-", "RigStatus.Clock must be a whole number"),
        ("SG_ Clock : 0|32@1+", "SG_ Clock : 0|8@1+", "Clock must have at least 16 bits, it has 8"),
        ("SG_ Order : 48|2@1+", "SG_ Order : 48|1@1+", "Order must have at least 2 bits"),
    ],
)
def test_a_fault_in_what_is_used_is_refused_before_the_run(tmp_path, old, new, said):
    assert old in DBC
    rig = rig_of(tmp_path, virtual(), DBC.replace(old, new))
    with pytest.raises(BenchError) as error:
        check_link("can", rig, tmp_path)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


def test_a_frame_of_can_fd_on_a_classic_bus_is_refused(tmp_path):
    text = DBC + FD_ATTRIBUTES + 'BA_ "VFrameFormat" BO_ 257 14;\n'
    with pytest.raises(BenchError, match=r"'Pressure' is a CAN FD frame .* set fd: true"):
        check_link("can", rig_of(tmp_path, virtual(), text), tmp_path)
    check_link("can", rig_of(tmp_path, virtual(fd=True), text), tmp_path)


def test_the_format_of_frames_is_read_where_something_else_is_wrong(tmp_path):
    text = ELSEWHERE["overlap"] + FD_ATTRIBUTES + 'BA_ "VFrameFormat" BO_ 257 14;\n'
    (tmp_path / "x.dbc").write_text(text)
    database = load_dbc(tmp_path / "x.dbc")
    assert [message.name for message in database.messages if message.is_fd] == ["Pressure"]
    assert list(database.faults) == ["Other"]


@pytest.mark.parametrize(
    "data",
    [
        codecs.BOM_UTF8 + DBC.encode(),
        DBC.encode("utf-16"),
        codecs.BOM_UTF16_BE + DBC.encode("utf-16-be"),
        DBC.replace('"counts"', '"°"').encode("cp1252"),
        DBC.replace('"counts"', '"°"').encode(),
    ],
)
def test_every_usual_encoding_is_read(tmp_path, data):
    rig = rig_of(tmp_path, virtual())
    (tmp_path / "rig.dbc").write_bytes(data)
    check_link("can", rig, tmp_path)


@pytest.mark.parametrize("kind", ["kcd", "sym"])
def test_other_formats_that_cantools_writes(tmp_path, kind):
    shipped: Any = cantools.database.load_string(DBC, "dbc")
    rig = rig_of(tmp_path, virtual(), dbc=DBC).model_copy(update={"dbc": f"rig.{kind}"})
    cantools.database.dump_file(shipped, tmp_path / f"rig.{kind}")
    check_link("can", rig, tmp_path)


@pytest.mark.parametrize("text", ["", "what is this", "BO_ what\n", "\x00\x01\x02", "<xml/>"])
@pytest.mark.parametrize("name", ["x.dbc", "x.kcd", "x.arxml", "x.sym"])
def test_a_file_that_is_none_is_one_line(tmp_path, text, name):
    rig = rig_of(tmp_path, virtual()).model_copy(update={"dbc": name})
    (tmp_path / name).write_text(text)
    with pytest.raises(BenchError) as error:
        check_link("can", rig, tmp_path)
    assert "\n" not in str(error.value)
    assert "DBC file" in str(error.value)
