"""What is needed to compute a recorded run again, without reading all of the recording: an hour begins like a second.

Machine file, commands and checkpoints are found by the index of the file; blocks are read when their time comes.
"""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial
from hashlib import blake2b
from itertools import chain
from pathlib import Path
from types import TracebackType
from typing import Final

from mcap_ros2.decoder import DecoderFactory

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.recording.bag import FILE
from cnc_ptp.recording.mcap_file import METADATA
from cnc_ptp.recording.mcap_index import ChunkPlace, McapIndex, require_chunks
from cnc_ptp.recording.opened import missing_of
from cnc_ptp.recording.origin import NOT_COMPUTABLE, WITHOUT, computable_from, not_computable, notes_of
from cnc_ptp.recording.parts import files_of
from cnc_ptp.recording.reader import COMMAND, STATE_TYPES, TICK, RawMessage, command_record
from cnc_ptp.recording.writer import CHECKPOINT, CHECKPOINT_TEXT, MACHINE_FILE, PLC_FILE
from cnc_ptp.wire.block_codec import BlockCodec, codec_of, codec_of_file
from cnc_ptp.wire.schemas import full_name
from cnc_ptp.wire.ticks import Tick, decode_tick

CHECKPOINTS_OF: Final = "cnc_ptp.checkpoints"
"""Metadata of a file beside a recording: the run that its checkpoints are of."""
NO_MACHINE: Final = 26155


def checkpoint_file(recording: Path) -> Path:
    """Where the checkpoints of a recording are that it does not have itself."""
    root = recording.parent if recording.name == FILE else recording
    return root.with_name(f"{root.name}.checkpoints") if root.name else root / ".checkpoints"


class RunInputs:
    """An open recording, in one file or in parts; it is closed at the end of a `with` block.

    machine_yaml  empty if it has none
    commands      in the order of their cycles
    checkpoints   cycles before which there is one that is a beginning, also in the file beside the recording
    from_0        whether the run can be computed from 0
    beside        why the file beside it does not count, empty if it does or if there is none
    plc_file      name of the PLC in a file that served the run, empty if none did
    begin, end    the first cycle whose blocks are recorded, and that after the last one

    Raises CncError 26001 to 26003, 26014, 26016 (newer format), 26018 (commands are missing), 26224 (nothing is left).
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._parts = [_Part(file) for file in files_of(self.path)]
        self._beside: list[_Part] = []
        records = chain.from_iterable(part.index.metadata for part in self._parts)
        values = notes_of(self.path, (record.metadata for record in records if record.name == METADATA))
        self.missing = missing_of(values, (part.index for part in self._parts))
        """What the recording lacks; empty for one that is whole."""
        require_chunks(self.path, self.missing, [part.index for part in self._parts])
        first = computable_from(self.path, values)
        self.from_0 = not first
        self._without = values.get(WITHOUT, "")
        self.start_ns = int(values.get("start_ns", "0"))
        self.cycle_time_ns = int(values.get("cycle_time_ns", "1000000"))
        self._attachments = {name: part for part in self._parts for name in part.index.attachments}
        self.machine_yaml = self._attached(MACHINE_FILE).decode(errors="replace")
        commands = chain.from_iterable(part.commands() for part in self._parts)
        self.commands = sorted(commands, key=lambda record: record.cycle)
        self.beside = self._take_beside(checkpoint_file(self.path))
        names = [name.removeprefix(CHECKPOINT) for name in self._attachments if name.startswith(CHECKPOINT)]
        numbers = {name.partition("/")[0] for name in names}
        self.checkpoints = sorted(cycle for cycle in map(int, filter(str.isdecimal, numbers)) if cycle >= first)
        names = [name for name in self._attachments if name.startswith(PLC_FILE)]
        self.plc_file = names[0].removeprefix(PLC_FILE) if names else ""
        self.begin = min((tick.first_cycle for part in self._parts[:1] for tick in part.ticks(0)), default=0)
        self.end = self._end()

    def required_machine(self) -> MachineParameters:
        """Raises CncError 26155 where there is no machine file, ParameterError for one that is wrong."""
        if not self.machine_yaml:
            reason = f"recording {self.path}: holds no attachment machine.yaml"
            raise CncError(NO_MACHINE, reason, "nothing was computed, record it with cnc_ptp")
        return load_machine(self.machine_yaml, f"{self.path}:{MACHINE_FILE}")

    def require_from_0(self) -> None:
        """Raises CncError 26018."""
        if not self.from_0:
            raise not_computable(self.path, self._without)

    def no_beginning(self, begin: int, why: str) -> CncError:
        """26018: neither 0 nor a checkpoint up to `begin` is a beginning; `why`: those that are there do not count."""
        first = min(self.checkpoints, default=-1)
        if first < 0:
            lack = f"recording {self.path}: {self._without}, and it has no checkpoint"
            remedy = "keep more seconds (--keep) than lie between two checkpoints (--checkpoints)"
            return CncError(NOT_COMPUTABLE, lack, f"nothing was computed, {remedy}")
        if first <= begin:
            damage = f"recording {self.path}: {self._without}, and its checkpoints do not count: {why}"
            return CncError(NOT_COMPUTABLE, damage, "nothing was computed, its states can be read and drawn")
        second = self.cycle_time_ns * 1e-9
        reason = f"recording {self.path}: {self._without}, and it has no checkpoint up to --from {begin * second:g} s"
        return CncError(NOT_COMPUTABLE, reason, f"nothing was computed, its first one is at {first * second:g} s")

    def run_id(self) -> str:
        """A digest of all that decides the run: the machine and the commands."""
        digest = blake2b(self.machine_yaml.encode(errors="surrogatepass"), digest_size=16)
        for record in self.commands:
            words = (record.cycle, record.target, record.command, record.accepted, record.arguments_json)
            digest.update(repr(words).encode(errors="surrogatepass"))
        return digest.hexdigest()

    def states_before(self, cycle: int) -> Iterator[Callable[[], list[bytes]]]:
        """Reads the checkpoints at or before a cycle, the newest first; each may raise CncError 26003.

        A checkpoint is one state of all units, or one of each (of the graph).
        """
        for first in sorted((first for first in self.checkpoints if first <= cycle), reverse=True):
            name = f"{CHECKPOINT}{first}"
            for part in [*self._beside, *self._parts]:
                if name in part.index.attachments:
                    yield partial(part.attached, [name])
            if of_units := [each for each in self._attachments if each.startswith(f"{name}/")]:
                yield partial(self._read, of_units)

    def checkpoint_texts(self) -> dict[str, str]:
        """Long texts of the states by their digests."""
        names = [name for name in self._attachments if name.startswith(CHECKPOINT_TEXT)]
        return {
            name.removeprefix(CHECKPOINT_TEXT): self._attached(name).decode(errors="surrogatepass") for name in names
        }

    def messages(self, types: Collection[str], first_cycle: int = 0) -> Iterator[RawMessage]:
        """Messages of some types in log-time order, from the chunks that may have those of `first_cycle`."""
        from_ns = self.start_ns + first_cycle * self.cycle_time_ns
        return chain.from_iterable(part.messages(types, from_ns) for part in self._parts)

    def codec(self, block_class: type) -> BlockCodec:
        """For its blocks, which may be from before a change of their message. Raises CncError 26005."""
        name = f"cnc_ptp/msg/{block_class.__name__}"
        definition = next(filter(None, (part.definition(name) for part in self._parts)), None)
        return codec_of(block_class) if definition is None else codec_of_file(block_class, definition)

    def close(self) -> None:
        for part in [*self._parts, *self._beside]:
            part.index.close()

    def __enter__(self) -> RunInputs:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _take_beside(self, file: Path) -> str:
        """The attachments of the file beside the recording; why they do not count."""
        if not file.is_file():
            return ""
        try:
            part = _Part(file)
        except CncError as error:
            return str(error)
        self._beside.append(part)
        runs = [each.metadata.get("run") for each in part.index.metadata if each.name == CHECKPOINTS_OF]
        if runs != [self.run_id()]:
            return f"{file} has the checkpoints of another run"
        self._attachments = dict.fromkeys(part.index.attachments, part) | self._attachments
        return ""

    def _read(self, names: Iterable[str]) -> list[bytes]:
        """Raises CncError 26003."""
        return [self._attached(name) for name in names]

    def _attached(self, name: str) -> bytes:
        """Empty if there is none of this name."""
        return self._attachments[name].index.attached(name) if name in self._attachments else b""

    def _end(self) -> int:
        """By the time of the last message in any chunk that may have states.

        One altered number must not make it endless, so others have to confirm it: the last tick, or the number of
        cycles that a unit recorded.
        """
        times = [chunk.last_ns for part in self._parts for chunk in part.state_chunks()]
        states: Counter[str] = Counter()
        for part in self._parts:
            states.update(dict(part.state_counts()))
        ends = [tick.first_cycle + tick.count for part in self._parts for tick in part.ticks(-1)]
        last_ns, confirmed = max(times, default=self.start_ns - 1), max([*states.values(), *ends], default=0)
        return min(max(0, last_ns - self.start_ns + self.cycle_time_ns) // self.cycle_time_ns, confirmed)


class _Part:
    """A file of the recording."""

    def __init__(self, file: Path) -> None:
        self.index = McapIndex(file)

    def attached(self, names: Iterable[str]) -> list[bytes]:
        """Raises CncError 26003."""
        return [self.index.attached(name) for name in names]

    def messages(self, types: Collection[str], from_ns: int = 0) -> Iterator[RawMessage]:
        """Messages of some types in log-time order, from the chunks that may have those of `from_ns` or later."""
        wanted = {id: name for id in self.index.channels if (name := self._type_of(id)) in types}
        return self._in_order([chunk for chunk in self._chunks(wanted) if chunk.last_ns >= from_ns], wanted)

    def definition(self, type_name: str) -> bytes | None:
        """Of a type, where the file has one."""
        return next((each.data for each in self.index.schemas.values() if full_name(each.name) == type_name), None)

    def commands(self) -> Iterator[CommandRecord]:
        schema = next((each for each in self.index.schemas.values() if full_name(each.name) == COMMAND), None)
        if schema is None:
            return
        try:
            decode = DecoderFactory().decoder_for("cdr", schema)
            assert decode is not None
            yield from [command_record(decode(message.cdr)) for message in self.messages([COMMAND])]
        except CncError:
            raise
        except Exception as error:  # whatever the generated decoder raises
            raise self.index.corrupt(0, f"the commands cannot be read: {error!r}") from error

    def state_chunks(self) -> list[ChunkPlace]:
        """Those that may have states."""
        return self._chunks({id for id in self.index.channels if self._type_of(id) in STATE_TYPES})

    def state_counts(self) -> Iterator[tuple[str, int]]:
        """Topics of states and the numbers of their messages."""
        for id, count in self.index.counts.items():
            if self._type_of(id) in STATE_TYPES:
                yield self.index.channels[id].topic, count

    def ticks(self, place: int) -> Iterator[Tick]:
        """Those of one of the chunks that have ticks, 0: the first, -1: the last one."""
        wanted = {id: TICK for id in self.index.channels if self._type_of(id) == TICK}
        chunks = self._chunks(wanted)
        for message in self._in_order(chunks[place:][:1], wanted):
            yield decode_tick(message.cdr)

    def _in_order(self, chunks: Sequence[ChunkPlace], wanted: Mapping[int, str]) -> Iterator[RawMessage]:
        """`wanted`: types by channel. Chunks of one time are merged."""
        waiting: list[tuple[int, int, RawMessage]] = []
        serial = 0
        for chunk in chunks:
            while waiting and waiting[0][0] < chunk.first_ns:
                yield heapq.heappop(waiting)[2]
            for run in self.index.runs(chunk, [*wanted]):
                topic, name = self.index.channels[run.channel_id].topic, wanted[run.channel_id]
                for time, content in zip(run.head["log_time"].tolist(), run.contents, strict=True):
                    message = RawMessage(topic, name, time, content.tobytes())
                    heapq.heappush(waiting, (time, serial := serial + 1, message))
        while waiting:
            yield heapq.heappop(waiting)[2]

    def _type_of(self, channel_id: int) -> str:
        schema = self.index.schemas.get(self.index.channels[channel_id].schema_id)
        return full_name(schema.name) if schema else ""

    def _chunks(self, channels: Collection[int]) -> list[ChunkPlace]:
        """Those that may have messages of some channels, in the order of their beginnings."""
        found = [chunk for chunk in self.index.chunks if channels and chunk.may_hold(channels)]
        return sorted(found, key=lambda chunk: chunk.first_ns)
