"""Reads MCAP files as `cargobay export` and `cargobay drive --record` write them: chunks that are
not compressed, channels of JSON. https://mcap.dev/spec says what each byte is.

Everything that can be checked is: checksums, and that the index leads to the messages.
"""

from __future__ import annotations

import dataclasses
import struct
import zlib
from collections.abc import Iterator

MAGIC = b"\x89MCAP0\r\n"

_FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _MESSAGE_INDEX, _CHUNK_INDEX = 2, 3, 4, 5, 6, 7, 8
_STATISTICS, _DATA_END = 0x0B, 0x0F


class Damaged(ValueError):
    """The file is not what was written."""


@dataclasses.dataclass(frozen=True, slots=True)
class Message:
    """One message: the topic of its channel, when it was, and its JSON."""

    topic: str
    time_ns: int
    json: bytes


class _Fields:
    """The values of a record, one after the other."""

    def __init__(self, data: memoryview) -> None:
        self._data = data
        self._at = 0

    def number(self, size: int) -> int:
        return int.from_bytes(self.take(size), "little")

    def text(self) -> str:
        return str(self.take(self.number(4)), "utf-8")

    def block(self) -> memoryview:
        return self.take(self.number(4))

    def take(self, size: int) -> memoryview:
        if size > len(self._data) - self._at:
            raise Damaged("a record is shorter than it says")
        self._at += size
        return self._data[self._at - size:self._at]

    def rest(self) -> memoryview:
        return self._data[self._at:]


def _records(data: memoryview, at: int) -> Iterator[tuple[int, int, memoryview]]:
    """Offset, opcode and content of each; ends before one that is not all there."""
    while at + 9 <= len(data):
        opcode, length = struct.unpack_from("<BQ", data, at)
        if length > len(data) - at - 9:
            return
        yield at, opcode, data[at + 9:at + 9 + length]
        at += 9 + length


class File:
    """A whole file, checked when it is made.

    finished: False if whoever wrote it did not come to its end. Then it holds the messages of its
    whole chunks.
    """

    def __init__(self, data: bytes) -> None:
        if not data.startswith(MAGIC):
            raise Damaged("not an MCAP file")
        self._data = memoryview(data)
        self._topics: dict[int, str] = {}
        self._chunks: dict[int, memoryview] = {}  # by their offset in the file: the messages
        self._indexes: dict[int, tuple[int, int]] = {}  # offset: channel, number of messages
        self.finished = False
        try:
            self._read()
        except struct.error as error:
            raise Damaged(f"a record is not as long as it should be: {error}") from None

    def _read(self) -> None:
        for offset, opcode, content in _records(self._data, len(MAGIC)):
            if opcode == _CHANNEL:
                self._add_channel(content)
            elif opcode == _CHUNK:
                self._chunks[offset] = self._checked_chunk(content, offset)
            elif opcode == _MESSAGE_INDEX:
                self._check_message_index(content, offset)
            elif opcode == _DATA_END:
                self._check_data(content, offset)
                self.finished = True
                break
        if self.finished:
            self._check_summary()

    def messages(self) -> Iterator[Message]:
        """All of them, in the order of the file."""
        for chunk in self._chunks.values():
            for offset, opcode, content in _records(chunk, 0):
                if opcode != _MESSAGE:
                    continue
                if len(content) < 22:
                    raise Damaged(f"the message at byte {offset} of a chunk is too short")
                channel, _, time_ns, _ = struct.unpack_from("<HIQQ", content)
                if channel not in self._topics:
                    raise Damaged(f"a message is of channel {channel}, which there is not")
                yield Message(self._topics[channel], time_ns, bytes(content[22:]))

    def _add_channel(self, content: memoryview) -> None:
        fields = _Fields(content)
        number = fields.number(2)
        fields.number(2)
        topic, encoding = fields.text(), fields.text()
        if encoding != "json":
            raise Damaged(f"{topic} is not JSON but {encoding}")
        self._topics[number] = topic

    @staticmethod
    def _checked_chunk(content: memoryview, offset: int) -> memoryview:
        fields = _Fields(content)
        fields.take(16)
        size, checksum, compression = fields.number(8), fields.number(4), fields.text()
        if compression:
            raise ValueError(f"its chunks are compressed; undo that: mcap compress --compression "
                             f"none ({compression})")
        records = fields.take(fields.number(8))
        if len(records) != size or zlib.crc32(records) != checksum:
            raise Damaged(f"the chunk at byte {offset} is not what was written: wrong checksum")
        return records

    def _check_message_index(self, content: memoryview, offset: int) -> None:
        fields = _Fields(content)
        channel, entries = fields.number(2), fields.block()
        chunk = next(reversed(self._chunks.values()), memoryview(b""))
        for time_ns, at in struct.iter_unpack("<QQ", entries):
            found = chunk[at:at + 31]
            if len(found) < 31 or found[0] != _MESSAGE:
                raise Damaged(f"the index at byte {offset} leads to no message")
            if struct.unpack_from("<HIQ", found, 9)[::2] != (channel, time_ns):
                raise Damaged(f"the index at byte {offset} leads to another message")
        self._indexes[offset] = (channel, len(entries) // 16)

    def _check_data(self, content: memoryview, offset: int) -> None:
        checksum = _Fields(content).number(4)
        if checksum and zlib.crc32(self._data[:offset]) != checksum:
            raise Damaged("its data are not what was written: wrong checksum")

    def _check_summary(self) -> None:
        if bytes(self._data[-len(MAGIC):]) != MAGIC:
            raise Damaged("its end is missing")
        footer = len(self._data) - len(MAGIC) - 29
        if footer < 0 or self._data[footer] != _FOOTER:
            raise Damaged("its footer is missing")
        begin, _, checksum = struct.unpack_from("<QQI", self._data, footer + 9)
        if checksum and zlib.crc32(self._data[begin:footer + 25]) != checksum:
            raise Damaged("its index is not what was written: wrong checksum")
        seen: set[int] = set()
        for _, opcode, content in _records(self._data, begin):
            if opcode == _CHUNK_INDEX:
                seen.add(self._check_chunk_index(content))
            elif opcode == _STATISTICS:
                self._check_statistics(content)
        if seen != set(self._chunks):
            raise Damaged("its index does not have all chunks")

    def _check_chunk_index(self, content: memoryview) -> int:
        fields = _Fields(content)
        fields.take(16)
        chunk = fields.number(8)
        if chunk not in self._chunks:
            raise Damaged(f"its index says that a chunk is at byte {chunk}: there is none")
        fields.number(8)
        for channel, at in struct.iter_unpack("<HQ", fields.block()):
            if self._indexes.get(at, (None, 0))[0] != channel:
                raise Damaged(f"its index says that one of channel {channel} is at byte {at}")
        return chunk

    def _check_statistics(self, content: memoryview) -> None:
        messages = _Fields(content).number(8)
        indexed = sum(count for _, count in self._indexes.values())
        if messages != indexed:
            raise Damaged(f"it should have {messages} messages, and has {indexed}")
