"""Bus logs in MDF files: frames that were never decoded are named, or decoded by a database."""

from pathlib import Path
from typing import Any

import cantools
import numpy as np
from asammdf import Signal, Source
from asammdf.blocks import v4_constants as v4
from mdf_files import ANGLE, LEFT, RIGHT, N, T, check, read, refused, signal, written

DBC = """\
VERSION ""
NS_ :
BS_:
BU_: Rig
BO_ 291 Steering: 8 Rig
 SG_ Angle : 0|16@1- (0.01,0) [-300|300] "deg" Rig
 SG_ PressL : 23|16@0+ (0.001,0) [0|60] "bar" Rig
BO_ 2566844671 Pressure: 8 Rig
 SG_ PressR : 8|12@1+ (0.005,1) [0|20] "bar" Rig
VAL_ 291 PressL 65535 "SNA" ;
"""


def bus_log(folder: Path, dbc: Path) -> Path:
    """Frames packed by cantools, as CAN loggers store them, beside an analogue channel."""
    database: Any = cantools.database.load_file(dbc)
    frames = [
        ("CAN_DataFrame.BusChannel", "u1"),
        ("CAN_DataFrame.ID", "<u4"),
        ("CAN_DataFrame.IDE", "u1"),
        ("CAN_DataFrame.DLC", "u1"),
        ("CAN_DataFrame.DataLength", "u1"),
        ("CAN_DataFrame.DataBytes", "u1", (8,)),
    ]
    rows = np.zeros(2 * N, frames)
    rows["CAN_DataFrame.BusChannel"] = 1
    rows["CAN_DataFrame.DLC"] = rows["CAN_DataFrame.DataLength"] = 8
    for k in range(N):
        left = LEFT[k] if not 500 <= k < 520 else "SNA"
        steering = database.encode_message("Steering", {"Angle": ANGLE[k], "PressL": left})
        pressure = database.encode_message("Pressure", {"PressR": RIGHT[k]})
        for row, data in ((rows[2 * k], steering), (rows[2 * k + 1], pressure)):
            row["CAN_DataFrame.DataBytes"] = np.frombuffer(data, np.uint8)
    rows["CAN_DataFrame.ID"][0::2] = 291
    rows["CAN_DataFrame.ID"][1::2] = 2566844671 & 0x1FFFFFFF
    rows["CAN_DataFrame.IDE"][1::2] = 1
    source = Source(name="CAN 1", path="CAN1", comment="", source_type=2, bus_type=2)
    bus = Signal(rows, np.repeat(T, 2), name="CAN_DataFrame", source=source)
    options = {"acq_source": source, "acq_name": "CAN1", "common_timebase": True}

    def change(file):
        file.groups[0].channel_group.flags |= v4.FLAG_CG_BUS_EVENT | v4.FLAG_CG_PLAIN_BUS_EVENT

    return written(folder, ([bus], options), [signal(LEFT * 0, "aux", "V")], change=change)


def test_bus_frames_are_decoded_by_a_database_or_named(tmp_path):
    dbc = tmp_path / "rig.dbc"
    dbc.write_text(DBC)
    path = bus_log(tmp_path, dbc)
    text = """\
channels:
  steering_wheel_angle: {from: Angle, unit: deg}
  left_pressure: {from: Steering.PressL}
  right_pressure: {from: PressR, unit: bar}
"""
    said = refused(path, text, "unknown channel 'Angle'", f"{2 * N} CAN frames in group 0")
    assert "'database: FILE.dbc'" in said
    whole = text.replace("from: Angle", "from: CAN_DataFrame")
    refused(path, whole, "'CAN_DataFrame' is whole bus frames", "'database: FILE.dbc'")
    record = read(path, "database: rig.dbc\n" + text)
    check(record, range(500, 520), tolerance=1e-3)
    assert any("'SNA' (20)" in note for note in record.notes)
    refused(path, "database: other.dbc\n" + text, "no CAN database", "other.dbc")
    dbc.write_text(DBC.replace("BO_ 291", "BO_ 292").replace("BO_ 2566844671", "BO_ 293"))
    refused(path, "database: rig.dbc\n" + text, "no frame of it is in the CAN database")
