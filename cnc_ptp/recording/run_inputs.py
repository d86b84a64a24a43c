"""What is needed to compute a recorded run again, without reading all of the recording: an hour begins like a second.

Machine file, commands and checkpoints are found by the index of the file; blocks are read when their time comes.
"""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType

from mcap_ros2.decoder import DecoderFactory

from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.recording.mcap_file import METADATA
from cnc_ptp.recording.mcap_index import ChunkPlace, McapIndex
from cnc_ptp.recording.reader import COMMAND, STATE_TYPES, TICK, RawMessage, command_record
from cnc_ptp.recording.writer import CHECKPOINT, CHECKPOINT_TEXT, MACHINE_FILE, PLC_FILE
from cnc_ptp.wire.schemas import full_name
from cnc_ptp.wire.ticks import decode_tick


class RunInputs:
    """An open recording; it is closed at the end of a `with` block.

    machine_yaml  empty if it has none
    commands      in the order of their cycles
    checkpoints   cycles before which there is one
    plc_file      name of the PLC in a file that served the run, empty if none did
    end           the cycle after the last one

    Raises CncError 26001 to 26003.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._index = McapIndex(self.path)
        values: dict[str, str] = {}
        for metadata in self._index.metadata:
            if metadata.name == METADATA:
                values |= metadata.metadata
        self.start_ns = int(values.get("start_ns", "0"))
        self.cycle_time_ns = int(values.get("cycle_time_ns", "1000000"))
        self.machine_yaml = self._attached_text(MACHINE_FILE)
        numbers = [name.removeprefix(CHECKPOINT) for name in self._index.attachments if name.startswith(CHECKPOINT)]
        self.checkpoints = sorted(int(number) for number in numbers if number.isdecimal())
        names = [name for name in self._index.attachments if name.startswith(PLC_FILE)]
        self.plc_file = names[0].removeprefix(PLC_FILE) if names else ""
        self.commands = sorted(self._read_commands(), key=lambda record: record.cycle)
        self.end = self._end()

    def checkpoint(self, cycle: int) -> bytes:
        """The state before one of the cycles of `checkpoints`."""
        return self._index.attached(f"{CHECKPOINT}{cycle}")

    def checkpoint_texts(self) -> dict[str, str]:
        """Long texts of the states by their digests."""
        names = [name for name in self._index.attachments if name.startswith(CHECKPOINT_TEXT)]
        return {
            name.removeprefix(CHECKPOINT_TEXT): self._index.attached(name).decode(errors="surrogatepass")
            for name in names
        }

    def messages(self, types: Collection[str], first_cycle: int = 0) -> Iterator[RawMessage]:
        """Messages of some types in log-time order, from the chunks that may have those of `first_cycle`."""
        wanted = {id: name for id in self._index.channels if (name := self._type_of(id)) in types}
        from_ns = self.start_ns + first_cycle * self.cycle_time_ns
        return self._in_order([chunk for chunk in self._chunks(wanted) if chunk.last_ns >= from_ns], wanted)

    def close(self) -> None:
        self._index.close()

    def __enter__(self) -> RunInputs:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _last(self, channels: Collection[int]) -> Iterator[RawMessage]:
        """The messages of the last chunk with some channels."""
        wanted = {id: self._type_of(id) for id in channels}
        return self._in_order(self._chunks(wanted)[-1:], wanted)

    def _in_order(self, chunks: Sequence[ChunkPlace], wanted: Mapping[int, str]) -> Iterator[RawMessage]:
        """`wanted`: types by channel. Chunks of one time are merged."""
        waiting: list[tuple[int, int, RawMessage]] = []
        serial = 0
        for chunk in chunks:
            while waiting and waiting[0][0] < chunk.first_ns:
                yield heapq.heappop(waiting)[2]
            for run in self._index.runs(chunk, [*wanted]):
                topic, name = self._index.channels[run.channel_id].topic, wanted[run.channel_id]
                for time, content in zip(run.head["log_time"].tolist(), run.contents, strict=True):
                    message = RawMessage(topic, name, time, content.tobytes())
                    heapq.heappush(waiting, (time, serial := serial + 1, message))
        while waiting:
            yield heapq.heappop(waiting)[2]

    def _attached_text(self, name: str) -> str:
        return self._index.attached(name).decode(errors="replace") if name in self._index.attachments else ""

    def _type_of(self, channel_id: int) -> str:
        schema = self._index.schemas.get(self._index.channels[channel_id].schema_id)
        return full_name(schema.name) if schema else ""

    def _chunks(self, channels: Collection[int]) -> list[ChunkPlace]:
        """Those that may have messages of some channels, in the order of their beginnings."""
        found = [
            chunk
            for chunk in self._index.chunks
            if channels and (not chunk.indexes or not chunk.indexes.keys().isdisjoint(channels))
        ]
        return sorted(found, key=lambda chunk: chunk.first_ns)

    def _read_commands(self) -> Iterator[CommandRecord]:
        schema = next((each for each in self._index.schemas.values() if full_name(each.name) == COMMAND), None)
        decode = DecoderFactory().decoder_for("cdr", schema) if schema else None
        if decode is None:
            return
        for message in self.messages([COMMAND]):
            yield command_record(decode(message.cdr))

    def _end(self) -> int:
        """By the time of the last message. One altered number must not make it endless, so others have to confirm it:

        the last tick, or the number of cycles that a unit recorded.
        """
        last_ns = max((chunk.last_ns for chunk in self._index.chunks), default=self.start_ns - 1)
        states = [count for id, count in self._index.counts.items() if self._type_of(id) in STATE_TYPES]
        ticks = [id for id in self._index.channels if self._type_of(id) == TICK]
        ends = [decode_tick(message.cdr) for message in self._last(ticks)]
        confirmed = max([*states, *(tick.first_cycle + tick.count for tick in ends)], default=0)
        return min(max(0, last_ns - self.start_ns + self.cycle_time_ns) // self.cycle_time_ns, confirmed)
