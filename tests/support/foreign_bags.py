"""Small bags as other tools leave them: MCAP by the mcap package, SQLite by hand."""

import sqlite3
import struct
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import yaml
from mcap.writer import CompressionType, Writer

FLOAT = ("std_msgs/msg/Float64", "ros2msg", "float64 data\n")
TEXT = ("std_msgs/msg/String", "ros2msg", "string data\n")
T0 = 1_700_000_000 * 10**9
STEP = 10**7


def number(value: float) -> bytes:
    return b"\0\1\0\0" + struct.pack("<d", value)


def text(value: str) -> bytes:
    data = value.encode() + b"\0"
    return b"\0\1\0\0" + struct.pack("<I", len(data)) + data


def numbers(count: int = 20, start: int = T0, step: int = STEP) -> list[tuple[int, bytes]]:
    return [(start + k * step, number(k)) for k in range(count)]


def profile(
    durability: str | int = "transient_local", depth: int = 1, history: str | int = "keep_last"
) -> dict[str, Any]:
    infinite = {"sec": 9223372036, "nsec": 854775807}
    return {
        "history": history,
        "depth": depth,
        "reliability": 1,
        "durability": durability,
        "deadline": infinite,
        "lifespan": {"sec": -1, "nsec": 0},
        "liveliness": 1,
        "liveliness_lease_duration": infinite,
        "avoid_ros_namespace_conventions": False,
    }


def write_mcap(
    path: Path,
    channels: Iterable[Sequence[Any]],
    packing: str = "zstd",
    chunks: bool = True,
    chunk_size: int = 1 << 20,
) -> Path:
    """channels: (topic, schema or None, rows, options); options: encoding, metadata."""
    path.parent.mkdir(parents=True, exist_ok=True)
    kinds = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "": CompressionType.NONE}
    with path.open("wb") as file:
        writer = Writer(file, chunk_size, kinds[packing], use_chunking=chunks)
        writer.start("ros2", "another tool")
        rows = []
        for topic, schema, own, *options in channels:
            encoding, more = ("cdr", {}) if not options else options[0]
            name, form, definition = schema or ("", "", "")
            key = writer.register_schema(name, form, definition.encode()) if schema else 0
            channel = writer.register_channel(topic, encoding, key, more)
            rows += [(stamp, channel, data) for stamp, data in own]
        for stamp, channel, data in sorted(rows, key=lambda row: row[0]):
            writer.add_message(channel, stamp, data, stamp)
        writer.finish()
    return path


def write_db3(
    path: Path,
    topics: Iterable[tuple[str, str, str, list[tuple[int, bytes]]]],
    version: int = 3,
    definitions: Iterable[Sequence[str]] = (),
) -> Path:
    """topics: (name, type, offered profiles as text, rows). ``version``: of the table's columns."""
    path.parent.mkdir(parents=True, exist_ok=True)
    columns = ["id INTEGER PRIMARY KEY", "name TEXT", "type TEXT", "serialization_format TEXT"]
    columns += ["offered_qos_profiles TEXT"] * (version >= 2)
    columns += ["type_description_hash TEXT"] * (version >= 4)
    connection = sqlite3.connect(path)
    make = connection.execute
    make("PRAGMA synchronous = OFF")
    make(f"CREATE TABLE topics({', '.join(columns)})")
    make(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
    )
    make("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    if version >= 3:
        make("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)")
        make("INSERT INTO schema VALUES (?, 'humble')", (version,))
    if version >= 4:
        make(
            "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT, "
            "encoding TEXT, encoded_message_definition TEXT, type_description_hash TEXT)"
        )
        for row in definitions:
            make("INSERT INTO message_definitions VALUES (NULL, ?, 'ros2msg', ?, '')", row)
    for key, (name, kind, qos, rows) in enumerate(topics, 1):
        values = [key, name, kind, "cdr", qos, ""][: len(columns)]
        make(f"INSERT INTO topics VALUES ({', '.join('?' * len(columns))})", values)
        query = "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)"
        connection.executemany(query, [(key, stamp, data) for stamp, data in rows])
    connection.commit()
    connection.close()
    return path


def write_metadata(
    folder: Path,
    files: Iterable[str],
    topics: Iterable[tuple[str, str, Any]] = (),
    count: int = 20,
    start: int = T0,
    **more: Any,
) -> Path:
    """topics: (name, type, offered profiles as YAML text or as a list)."""
    information = {
        "version": 9,
        "storage_identifier": "mcap",
        "duration": {"nanoseconds": 190_000_000},
        "starting_time": {"nanoseconds_since_epoch": start},
        "message_count": count,
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": name,
                    "type": kind,
                    "serialization_format": "cdr",
                    "offered_qos_profiles": qos,
                },
                "message_count": count,
            }
            for name, kind, qos in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": list(files),
        "files": [{"path": name, "message_count": count} for name in files],
        **more,
    }
    file = Path(folder) / "metadata.yaml"
    file.write_text(yaml.safe_dump({"rosbag2_bagfile_information": information}))
    return file
