"""What-if replay from the middle of a long recording of 8 axes, and what its checkpoints cost.

A program moves seven axes, the eighth one moves from point to point meanwhile, and the override changes: the recording
has the commands of an hour.
"""

from __future__ import annotations

import copy
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import yaml

from bench.columns import AXES, CYCLES, HOUR, one_second, repeat_second
from bench.figures import Effort, Figure, ShowProgress, Stopwatch, median_of, stopwatch
from bench.jobs import MACHINE, long_program
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CommandRecord
from cnc_ptp.recording.mcap_file import METADATA, McapFile
from cnc_ptp.recording.reader import COMMAND
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.what_if import Change, WhatIf
from cnc_ptp.recording.writer import CHECKPOINT, CHECKPOINT_TEXT, MACHINE_FILE, READY, offer
from cnc_ptp.state.machine_state import CHECKPOINT_SECONDS, StateStore
from cnc_ptp.wire.layout import encode
from cnc_ptp.wire.schemas import full_name, load_schema
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.yaml_text import PARSER

FIRST_COPY = 5
"""Number of the first axis that the mill does not have; 4 is its spindle."""
ON_PATH, ALONE = AXES[:-1], AXES[-1]
MOVE_SECONDS, OVERRIDE_SECONDS = 2, 10
"""Between two commands to the axis that is not on the path; between two overrides."""
FAR, VELOCITY = 5.0, 20.0
"""Of its moves, mm and mm/s."""
OVERRIDES = (100.0, 90.0)
CHANNEL = "channel"
CHANGED, OVERRIDE = "x.getriebe.0.kv=8000", 60.0
"""By the what-if replay."""


class Middle(NamedTuple):
    """A run stopped in its middle: the machine, its text, the commands up to there."""

    text: str
    cycle: int
    machine: OfflineMachine
    parameters: MachineParameters
    run_seconds: float
    commands: list[CommandRecord]


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """The goal is one for a whole hour."""
    seconds = effort.scaled(HOUR)
    show("running to the middle")
    middle = run_to_the_middle(seconds)
    store = StateStore(middle.parameters)
    state = store.encode(middle.machine)
    stored = median_of(effort.runs, lambda: processor_seconds(store, middle.machine))
    yield Figure("checkpoint of 8 axes", len(state) / 1e3, "kB")
    yield Figure("storing it, processor time", 1e3 * stored, "ms")
    yield channel_alone(effort, store, middle)
    yield Figure("storing it, of the machine time at 10 s", 100.0 * stored / CHECKPOINT_SECONDS, "%")
    share = stored / (stored + middle.run_seconds / middle.cycle * 1e3 * CHECKPOINT_SECONDS)
    yield Figure("storing it, of a run offline without recording", 100.0 * share, "%")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hour.mcap"
        show("writing")
        write_recording(path, seconds, middle, state, store.texts)
        show("reading")
        begin = seconds / 2 + CHECKPOINT_SECONDS / 2
        commands = number_of_commands(path)
        length = f"{seconds / 60:.0f} min of {len(AXES)} axes with {commands} commands"
        called = [first_block_of_the_command(path, begin) for _ in range(effort.runs)]
        whole, cpu = (statistics.median(column) for column in zip(*called, strict=True))
        name = f"what-if from the middle of {length}: a command that computes one block, with its start"
        yield Figure(name, whole, "s", goal=2.0, at_most=True)
        yield Figure("its processor time", cpu, "s")
        watches = [timed(path, begin) for _ in range(effort.runs)]
        yield Figure("of it to the first block, without imports", statistics.median(each.wall for each in watches), "s")


def channel_alone(effort: Effort, store: StateStore, middle: Middle) -> Figure:
    """What holds up a channel in real time: its blocks are not stored, and their times only once."""
    runners, blocks = middle.machine.parts
    program = blocks[CHANNEL]
    assert isinstance(program, ChannelBlock)

    def seconds() -> float:
        with stopwatch() as watch:
            store.encode_units(middle.cycle, {CHANNEL: runners[CHANNEL]}, {CHANNEL: program})
        return watch.cpu

    name = f"storing its channel alone, a program of {program.blocks_total} blocks, processor time"
    return Figure(name, 1e3 * median_of(effort.runs, seconds), "ms")


def number_of_commands(path: Path) -> int:
    with RunInputs(path) as recorded:
        return len(recorded.commands)


def first_block_of_the_command(path: Path, begin: float) -> tuple[float, float]:
    """Seconds on the clock and of the processors of `cnc_ptp replay`, as a user calls it."""
    part = ["--from", str(begin), "--to", str(begin + 0.01)]
    change = ["--set", CHANGED, "--override", str(OVERRIDE), "-o", str(path.with_name("changed.mcap"))]
    started = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-m", "cnc_ptp", "replay", str(path), *part, *change], stdout=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    assert status == 0
    return time.perf_counter() - started, usage.ru_utime + usage.ru_stime


def timed(path: Path, begin: float) -> Stopwatch:
    with stopwatch() as watch:
        first_block(path, begin)
    return watch


def processor_seconds(store: StateStore, machine: OfflineMachine) -> float:
    with stopwatch() as watch:
        store.encode(machine)
    return watch.cpu


def first_block(path: Path, begin: float) -> None:
    with RunInputs(path) as recorded:
        run = WhatIf(recorded, Change(begin, parameters=[CHANGED], override=OVERRIDE))
        next(run.run())
    assert run.note.startswith("computed from the checkpoint")


def run_to_the_middle(seconds: int) -> Middle:
    """Half of the time with all axes in motion, not recorded."""
    text = machine_text()
    parameters = load_machine(text, "eight.yaml")
    load = Command("channel", "load", {"program": "long.nc", "text": program(seconds)})
    entries = [Entry(0.0, load), Entry(0.0, Command("channel", "start", {})), *changes(seconds // 2)]
    machine = OfflineMachine(parameters, build_units(parameters, scenario=entries, end_when_idle=False))
    commands: list[CommandRecord] = []
    started = time.process_time()
    while machine.next_cycle < seconds * 500:
        for output in machine.tick().values():
            commands += output.records
    spent = time.process_time() - started
    assert all(record.accepted for record in commands)
    return Middle(text, machine.next_cycle, machine, parameters, spent, commands)


def changes(seconds: int) -> Iterator[Entry]:
    """What people do meanwhile."""
    for number, second in enumerate(range(1, seconds, MOVE_SECONDS)):
        move = {"target": 0.0 if number % 2 else FAR, "velocity": VELOCITY}
        yield Entry(second, Command(ALONE, "move_absolute", move))
    for number, second in enumerate(range(OVERRIDE_SECONDS, seconds, OVERRIDE_SECONDS)):
        yield Entry(second, Command("channel", "set_override", {"percent": OVERRIDES[number % 2]}))


def of_the_whole_run(middle: Middle) -> list[CommandRecord]:
    """Those of the first half, and as many in the second one, which is not computed."""
    repeated = [record for record in middle.commands if record.command in ("move_absolute", "set_override")]
    return [*middle.commands, *(replace(record, cycle=record.cycle + middle.cycle) for record in repeated)]


def program(seconds: int) -> str:
    """The long program, the other axes along with X and Y."""
    lines = long_program(seconds).splitlines()
    return "\n".join(f"{line} A1 B2 C3 U4" if line == "G01 Y0" else line for line in lines).replace(
        "X0 Y0 Z2", "X0 Y0 Z2 A0 B0 C0 U0"
    )


def machine_text() -> str:
    """The mill with five more axes like Z, the last one not in its channel."""
    content = yaml.load(Path(MACHINE).read_text(encoding="utf-8"), PARSER)
    content["/machine"]["ros__parameters"]["axes"] = [*AXES]
    group = content["/channel"]["ros__parameters"]["gruppe"]["0"]
    group["achs_anzahl"] = len(ON_PATH)
    for place, name in enumerate(AXES[3:], start=3):
        number = FIRST_COPY + place - 3
        if name in ON_PATH:
            group["achse"][str(place)] = {"bezeichnung": name.upper(), "log_achs_nr": number}
        axis = content[f"/{name}"] = copy.deepcopy(content["/z"])
        axis["ros__parameters"]["kopf"]["achs_nr"] = number
    return yaml.safe_dump(content, sort_keys=False)


def write_recording(path: Path, seconds: int, middle: Middle, state: bytes, texts: dict[str, str]) -> None:
    """Blocks of an hour, made of one second of them; its commands, and a checkpoint of the machine in the middle."""
    commands = CommandTopic(of_the_whole_run(middle))

    def before(file: McapFile, index: int) -> None:
        if index == 0:
            announce_run(file, middle.text)
        if index == seconds // 2:
            store_state(file, middle.cycle, state, texts)
        commands.write(file, index)

    with tempfile.TemporaryDirectory() as folder:
        second = one_second(Path(folder) / "second.mcap")
        repeat_second(second, path, seconds, {index: partial(before, index=index) for index in range(seconds)})


class CommandTopic:
    """Commands by their seconds, in chunks as a recording has them."""

    def __init__(self, records: Sequence[CommandRecord]) -> None:
        self._stamps = Stamps(0, 1_000_000)
        self._schema = load_schema(COMMAND)
        self._records: dict[int, list[CommandRecord]] = {}
        for record in records:
            self._records.setdefault(record.cycle // CYCLES, []).append(record)
        self._channel = 0

    def write(self, file: McapFile, second: int) -> None:
        if not self._channel:
            self._channel = file.channel("/commands", full_name(COMMAND), self._schema.text, offer(COMMAND))
        found = [
            (self._stamps.at(record.cycle), encode(self._schema, record, self._stamps.header_of))
            for record in self._records.get(second, ())
        ]
        for rows, times in READY.messages(found, self._stamps):
            file.messages(self._channel, rows, times)
        file.close_chunk()


def announce_run(file: McapFile, text: str) -> None:
    file.attachment(MACHINE_FILE, "application/yaml", text.encode(), 0)
    file.metadata(METADATA, {"start_ns": "0", "cycle_time_ns": "1000000"})


def store_state(file: McapFile, cycle: int, state: bytes, texts: dict[str, str]) -> None:
    time_ns = cycle * 1_000_000
    for digest, text in texts.items():
        file.attachment(f"{CHECKPOINT_TEXT}{digest}", "text/plain", text.encode(), time_ns)
    file.attachment(f"{CHECKPOINT}{cycle}", "application/octet-stream", state, time_ns)
