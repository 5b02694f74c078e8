"""The bag writer: rosbag2 MCAP, cheap per message, on disk as the run goes."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import yaml
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode
from rosbags.rosbag2.errors import WriterError

from steering_bringup.bags.definitions import definition, definition_of
from steering_bringup.bags.errors import BagError
from steering_bringup.bags.places import RUN_FILE, remove_bag
from steering_bringup.bags.storage import FlushedMcap, FlushedWriter

RUN_KEY = "steering_run"
OUTCOME_KEY = "steering_outcome"
STARTED_KEY = "steering_started"
"""Wall-clock time of the start; the stamps in a bag are the run's own and begin at 0."""
COMPLETE, BROKEN_OFF = "complete", "broken off"
BROKEN_OFF_KEY = "broken_off"
"""Of why, in the run's metadata: known when all of it is over."""
CHUNK_BYTES = 1 << 20
FLUSH_SECONDS = 0.5


class BagWriter:
    """Writes one bag folder `path`: NAME.mcap, metadata.yaml at the end, run.yaml at the start.

    topics: topic -> message type. run: whatever is needed to repeat the run (`run_metadata`).
    A killed run loses at most what came in since the last flush: `flush_seconds` of wall time or
    `chunk_bytes`, whichever is less, counted at each message; `flush` any time. Flushed means
    handed to the operating system: a power failure may take more.
    definitions: message type -> definition text, for types that are not installed here.
    compress: chunks by Zstandard, as `ros2 bag` does with its preset zstd_fast.

    Raises BagError, naming the path, if the folder exists and `overwrite` is not set, if it cannot
    be made, and when a write fails (full disk). What had been flushed stays readable.
    Use as a context manager; an exception in the body is noted in the bag as its outcome.
    """

    def __init__(
        self,
        path: str | Path,
        topics: Mapping[str, str],
        run: Mapping[str, Any] | None = None,
        *,
        overwrite: bool = False,
        compress: bool = False,
        flush_seconds: float = FLUSH_SECONDS,
        chunk_bytes: int = CHUNK_BYTES,
        definitions: Mapping[str, str] | None = None,
    ) -> None:
        self.path = Path(path)
        self._definitions = {t: definition_of(t, definitions) for t in set(topics.values())}
        self.outcome = COMPLETE
        self._run = dict(run or {})
        self._flush_seconds = flush_seconds
        self._chunk_bytes = chunk_bytes
        self._failure: BagError | None = None
        self._open(overwrite, compress)
        self._channels: dict[str, int] = {}
        for topic, msgtype in topics.items():
            self.add_topic(topic, msgtype)
        self._append = self._storage.append
        self._due = time.monotonic() + flush_seconds

    def _open(self, overwrite: bool, compress: bool) -> None:
        if overwrite:
            remove_bag(self.path)
        try:
            self._writer = FlushedWriter(self.path)
            if compress:
                self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
            self._writer.open()
            text = yaml.safe_dump(self._run, sort_keys=False, allow_unicode=True)
            (self.path / RUN_FILE).write_text(text, encoding="utf-8")
        except WriterError as error:
            raise BagError(
                f"bag '{self.path}' exists already and is not overwritten: "
                "name another folder, or ask for overwriting"
            ) from error
        except OSError as error:
            raise BagError(f"bag '{self.path}' cannot be made: {error.strerror}") from error
        storage = self._writer.storage
        assert isinstance(storage, FlushedMcap)
        self._storage = storage

    def add_topic(self, topic: str, msgtype: str) -> None:
        """Announce one more topic; BagError if it is there already or its type is unknown."""
        if msgtype not in self._definitions:
            self._definitions[msgtype] = definition(msgtype)
        text, digest = self._definitions[msgtype]
        try:
            connection = self._writer.add_connection(topic, msgtype, msgdef=text, rihs01=digest)
        except WriterError as error:
            raise BagError(f"bag '{self.path}': topic {topic} is announced twice") from error
        self._channels[topic] = connection.id

    def write(self, topic: str, stamp_ns: int, data: bytes | memoryview) -> None:
        """Write one message's CDR bytes (encapsulation header included)."""
        try:
            channel = self._channels[topic]
        except KeyError:
            raise BagError(f"bag '{self.path}': topic {topic} was not announced") from None
        size = self._append(channel, stamp_ns, data)
        if size >= self._chunk_bytes or time.monotonic() >= self._due:
            self.flush()

    def write_block(self, stamps_ns: np.ndarray, payloads: Mapping[str, np.ndarray]) -> None:
        """Write n messages of each topic at once, interleaved stamp by stamp.

        stamps_ns: (n,) integers. payloads: topic -> (n, size) uint8 CDR payloads; the order of
        the topics is their order within a tick.
        """
        unknown = [topic for topic in payloads if topic not in self._channels]
        if unknown:
            raise BagError(f"bag '{self.path}': topic {unknown[0]} was not announced")
        rows = {self._channels[t]: np.ascontiguousarray(p) for t, p in payloads.items()}
        width = sum(64 + p.shape[1] for p in rows.values())
        step = max(1, self._chunk_bytes // max(1, width))
        for k in range(0, len(stamps_ns), step):
            part = {channel: p[k : k + step] for channel, p in rows.items()}
            size = self._storage.append_block(stamps_ns[k : k + step], part)
            if size >= self._chunk_bytes // 2 or time.monotonic() >= self._due:
                self.flush()

    def flush(self) -> None:
        """Put everything written so far on disk as one chunk."""
        if self._failure:
            raise self._failure
        self._due = time.monotonic() + self._flush_seconds
        if not any(self._storage.index.values()):
            return
        try:
            self._storage.close_chunk()
        except OSError as error:
            self._failure = BagError(
                f"bag '{self.path}' cannot be written on: {error.strerror}; {self._extent()}"
            )
            self.outcome = f"failed: {self._failure}"
            raise self._failure from error

    def broken_off(self, ticks: int, planned: int) -> None:
        """Note that the run was broken off after so many of its ticks."""
        if self.outcome == COMPLETE:
            self.outcome = f"{BROKEN_OFF} after {ticks} of {planned} ticks"

    @property
    def message_count(self) -> int:
        """Messages on disk (flushed)."""
        return sum(self._storage.channel_stats.values())

    def _extent(self) -> str:
        last = self._storage.last_stamp
        if last is None:
            return "nothing had been written yet"
        return f"the {self.message_count} messages up to t = {last * 1e-9:.3f} s stay readable"

    def close(self) -> None:
        """Write index and metadata.yaml; the bag is complete after it. May be called twice.

        Raises BagError if that fails, unless an earlier write has failed and said so already.
        """
        if self._writer.storage is None:
            return
        self._writer.set_custom_data(RUN_KEY, json.dumps(self._run, allow_nan=True))
        if "started" in self._run:
            self._writer.set_custom_data(STARTED_KEY, str(self._run["started"]))
        known = self._failure
        if known is None:
            with suppress(BagError):
                self.flush()
        if self._failure is not None:
            # A smaller chunk may fit where one failed, which would leave a hole in the record.
            self._storage.discard_chunk()
        self._writer.set_custom_data(OUTCOME_KEY, self.outcome)
        try:
            self._finish()
        except OSError as error:
            self._writer.abort()
            self._failure = self._failure or BagError(
                f"bag '{self.path}' cannot be closed: {error.strerror}; {self._extent()}"
            )
        if known is None and self._failure is not None:
            raise self._failure

    def _finish(self) -> None:
        writer, storage = self._writer, self._storage
        writer.counts.update(storage.channel_stats)
        writer.min_timestamp = storage.message_start_time if self.message_count else 0
        writer.max_timestamp = storage.message_end_time
        writer.close()

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if isinstance(error, KeyboardInterrupt) and self.outcome == COMPLETE:
            self.outcome = f"{BROKEN_OFF}: interrupted"
        if error is not None and self.outcome == COMPLETE:
            self.outcome = f"failed: {kind.__name__ if kind else ''}: {error}"
        try:
            self.close()
        except BagError:
            if error is None:
                raise
