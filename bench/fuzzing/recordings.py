"""Recordings, as they lie on a disk that has failed: bytes flipped, cut off, replaced; states of a machine in them."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

import zstandard
from mcap.reader import make_reader
from mcap.records import Schema
from mcap.writer import CompressionType, Writer

from bench.fuzzing.engine import Broken, Draw, Target, void
from bench.fuzzing.mutation import mutated_bytes, mutated_text
from cnc_ptp.commands.look.report import report
from cnc_ptp.commands.run.replay import replay
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import load_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.recording.long_recording import read_own
from cnc_ptp.recording.motion_check.check import check_recording
from cnc_ptp.recording.offline_run import OfflineRun
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.reader import iter_messages, read_recording
from cnc_ptp.recording.recovery import recover
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.state.machine_state import HEAD, StateStore, check_sum, read, together

MACHINE = "/machine: {ros__parameters: {axes: [x], block_cycles: 5}}\n/x: {ros__parameters: {getriebe.0.kv: 3000}}\n"
CYCLES = 30
LONGEST_REPLAY = 20_000
"""Cycles; a recording of 30 cycles in which one number has changed must not take longer."""


def small_recording(path: Path) -> None:
    """Of an axis that begins to move; with checkpoints."""
    parameters = load_machine(MACHINE, "m.yaml")
    entries = [Entry(0.0, Command("x", "move_absolute", {"target": 10.0, "velocity": 50.0}))]
    units = build_units(parameters, scenario=entries)
    with OfflineRun(parameters, units, record=str(path), machine_text=MACHINE, checkpoint_seconds=0.01) as run:
        for _ in run.run(cycles=CYCLES):
            pass


def uncompressed(data: bytes) -> bytes:
    """The same recording without compression and check sums, so that every flipped byte is read."""
    stream = BytesIO()
    writer = Writer(stream, compression=CompressionType.NONE, enable_crcs=False, chunk_size=4096)
    reader = make_reader(BytesIO(data))
    summary = reader.get_summary()
    assert summary is not None
    writer.start(reader.get_header().profile, "fuzz")
    schemas = {id: register(writer, schema) for id, schema in summary.schemas.items()}
    channels = {
        id: writer.register_channel(
            channel.topic, channel.message_encoding, schemas[channel.schema_id], channel.metadata
        )
        for id, channel in summary.channels.items()
    }
    for attachment in reader.iter_attachments():
        writer.add_attachment(
            attachment.create_time, attachment.log_time, attachment.name, attachment.media_type, attachment.data
        )
    for metadata in reader.iter_metadata():
        writer.add_metadata(metadata.name, metadata.metadata)
    for _, channel, message in reader.iter_messages():
        writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence)
    writer.finish()
    return stream.getvalue()


def register(writer: Writer, schema: Schema) -> int:
    return writer.register_schema(schema.name, schema.encoding, schema.data)


def both(folder: Path) -> tuple[bytes, bytes]:
    """The small recording as it is written, and uncompressed."""
    path = folder / "small.mcap"
    small_recording(path)
    data = path.read_bytes()
    path.unlink()
    return data, uncompressed(data)


def recordings(reader: Callable[[Path], None], folder: Path) -> Target:
    """Random changes of both forms."""
    forms, file = both(folder), folder / "run.mcap"

    def call(data: bytes) -> None:
        file.write_bytes(data)
        reader(file)

    return Target(lambda draw: mutated_bytes(draw.choice(forms), draw, others=forms), call)


def every_byte(folder: Path) -> Target:
    """Input n is form n mod 2, its byte n / 4 flipped, or the file cut there; 4 · size inputs are all of them."""
    forms, file = both(folder), folder / "run.mcap"

    def make(draw: Draw) -> bytes:
        form = forms[draw.number % 2]
        place = draw.number // 4 % len(form)
        if draw.number // 2 % 2:
            return form[:place]
        return form[:place] + bytes([form[place] ^ draw.choice((0xFF, 1 << draw.randrange(8)))]) + form[place + 1 :]

    def call(data: bytes) -> None:
        file.write_bytes(data)
        refused = [*filter(None, (refusal_of(reader, file) for reader in READERS.values()))]
        if refused:
            raise refused[0]

    return Target(make, call)


def refusal_of(reader: Callable[[Any], object], given: Any) -> CncError | None:
    """What a reader says against it; None if it takes it."""
    try:
        reader(given)
    except CncError as error:
        return error
    return None


def read_all(file: Path) -> None:
    """As rows, and message by message."""
    read_recording(file)
    for _ in iter_messages(file):
        pass


def open_all(file: Path) -> None:
    """All columns of all topics."""
    with OpenRecording(file) as opened:
        for topic, described in opened.topics.items():
            opened.columns(topic, *described.fields)


def recover_all(file: Path) -> None:
    """What was recovered is whole: it can be read, and has what was said."""
    output = file.with_name("out.mcap")
    output.unlink(missing_ok=True)
    try:
        recovered = recover(file, output)
    except CncError:
        if output.exists():
            raise Broken("a file was written in spite of a refusal") from None
        raise
    found = sum(1 for _ in iter_messages(output))
    if found != recovered.messages:
        raise Broken(f"{recovered.messages} messages were saved, {found} are in the file")


def make_report(file: Path) -> None:
    """The data of a report; its page of some."""
    read_own(file, None, None)
    if file.stat().st_size % 16 == 0:
        with redirect_stdout(StringIO()):
            report(str(file), str(file.with_name("r.html")), None, None, ())


def replay_all(file: Path) -> None:
    """Computed again from its machine and commands, by all of its checkpoints."""
    with RunInputs(file) as inputs:
        if inputs.end > LONGEST_REPLAY:
            raise Broken(f"a recording of {CYCLES} cycles would be computed up to cycle {inputs.end}")
        if inputs.machine_yaml:
            machine = inputs.required_machine()
            store = StateStore(machine)
            store.texts.update(inputs.checkpoint_texts())
            for states in inputs.states_before(inputs.end):
                refusal_of(
                    lambda read: together(map(store.restore, read()), machine), states
                )  # an older one is taken where one is damaged
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        replay(str(file), verify=True, publish=False, rate=1.0)


def check_motion(file: Path) -> None:
    """What is wrong with its motion, as a text."""
    check_recording(file).text()


READERS = {
    "read": read_all,
    "open": open_all,
    "recover": recover_all,
    "report": make_report,
    "replay": replay_all,
    "motion": check_motion,
}


def checkpoints(_folder: Path) -> Target:
    """States of a machine: damaged bytes, and forged ones whose check sum is right."""
    parameters = load_machine(MACHINE, "m.yaml")
    run = OfflineRun(
        parameters,
        build_units(
            parameters, scenario=[Entry(0.0, Command("x", "move_absolute", {"target": 10.0, "velocity": 50.0}))]
        ),
    )
    for _ in range(3):
        run.step()
    state = StateStore(parameters).encode(run.machine, with_plc=True)
    content = read(state).decode()
    words = (*("null", "true", "[]", "{}", "-1", "0", "1e999", "NaN", '"x"', "[", "]", ",", "99999999999"),
             *('"cnc_ptp.axis.axis_unit.AxisUnit"', '"os.system"', '"builtins.eval"', '"machine"'))  # fmt: skip

    def make(draw: random.Random) -> bytes:
        kind = draw.randrange(4)
        if kind == 0:
            return mutated_bytes(state, draw)
        text = mutated_text([content], draw, words, longest=10**7) if kind == 1 else forged(content, draw)
        return sealed(state, text)

    return Target(make, lambda given: void(StateStore(parameters).restore(given)))


def sealed(state: bytes, text: str) -> bytes:
    """A state with this content, and the check sum of it."""
    rest = zstandard.compress(text.encode("utf-8", "replace"))
    return state[: HEAD - 16] + check_sum(rest) + rest


def forged(content: str, draw: random.Random) -> str:
    """The JSON of a state with values exchanged, removed or doubled, at any depth."""
    value = json.loads(content)
    for _ in range(draw.choice((1, 1, 2))):
        place: Any = value
        while True:
            inner = [each for each in range(len(place)) if isinstance(place[each], list) and place[each]]
            if not inner or draw.random() < 0.3:
                break
            place = place[draw.choice(inner)]
        index, kind = draw.randrange(len(place)), draw.randrange(4)
        if kind == 0:
            place[index] = draw.choice(
                (None, True, -1, 0, 1, 7, 10**9, 0.5, "x", "machine", [], [0], [[]], {}, {"a": 1})
            )
        elif kind == 1:
            del place[index]
        elif kind == 2:
            place.insert(index, place[index])
        else:
            other = draw.randrange(len(place))
            place[index], place[other] = place[other], place[index]
        if not value:
            break
    return json.dumps(value)


def kinds() -> dict[str, Callable[[Path], Target]]:
    return {f"mcap-{name}": partial(recordings, reader) for name, reader in READERS.items()}
