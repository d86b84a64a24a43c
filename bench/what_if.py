"""What-if replay from the middle of a long recording of 8 axes, and what its checkpoints cost."""

from __future__ import annotations

import copy
import statistics
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import NamedTuple

import yaml

from bench.columns import AXES, HOUR, one_second, repeat_second
from bench.figures import Effort, Figure, ShowProgress, Stopwatch, median_of, stopwatch
from bench.jobs import MACHINE, long_program
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.recording.checkpoints import CHECKPOINT_SECONDS
from cnc_ptp.recording.mcap_file import METADATA, McapFile
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.what_if import Change, WhatIf
from cnc_ptp.recording.writer import CHECKPOINT, CHECKPOINT_TEXT, MACHINE_FILE
from cnc_ptp.state.machine_state import StateStore
from cnc_ptp.yaml_text import PARSER

FIRST_COPY = 5
"""Number of the first axis that the mill does not have; 4 is its spindle."""


class Middle(NamedTuple):
    """A run stopped in its middle: the machine, its text and its state there."""

    text: str
    cycle: int
    machine: OfflineMachine
    parameters: MachineParameters
    run_seconds: float


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
    yield Figure("storing it, of the machine time at 10 s", 100.0 * stored / CHECKPOINT_SECONDS, "%")
    share = stored / (stored + middle.run_seconds / middle.cycle * 1e3 * CHECKPOINT_SECONDS)
    yield Figure("storing it, of a run offline without recording", 100.0 * share, "%")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hour.mcap"
        show("writing")
        write_recording(path, seconds, middle, state, store.texts)
        show("reading")
        begin = seconds / 2 + CHECKPOINT_SECONDS / 2
        watches = [timed(path, begin) for _ in range(effort.runs)]
        first = statistics.median(watch.wall for watch in watches)
        length = f"{seconds / 60:.0f} min of {len(AXES)} axes"
        yield Figure(f"what-if from the middle of {length} to its first block", first, "s", goal=2.0, at_most=True)
        yield Figure("its processor time", statistics.median(watch.cpu for watch in watches), "s")


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
        run = WhatIf(recorded, Change(begin, parameters=["x.getriebe.0.kv=8000"], override=60.0))
        next(run.run())
    assert run.note.startswith("computed from the checkpoint")


def run_to_the_middle(seconds: int) -> Middle:
    """Half of the time with all axes in motion, not recorded."""
    text = machine_text()
    parameters = load_machine(text, "eight.yaml")
    load = Command("channel", "load", {"program": "long.nc", "text": program(seconds)})
    entries = [Entry(0.0, load), Entry(0.0, Command("channel", "start", {}))]
    machine = OfflineMachine(parameters, build_units(parameters, scenario=entries, end_when_idle=False))
    started = time.process_time()
    while machine.next_cycle < seconds * 500:
        machine.tick()
    return Middle(text, machine.next_cycle, machine, parameters, time.process_time() - started)


def program(seconds: int) -> str:
    """The long program, the other axes along with X and Y."""
    lines = long_program(seconds).splitlines()
    return "\n".join(f"{line} A1 B2 C3 U4 V5" if line == "G01 Y0" else line for line in lines).replace(
        "X0 Y0 Z2", "X0 Y0 Z2 A0 B0 C0 U0 V0"
    )


def machine_text() -> str:
    """The mill with five more axes like Z in its channel."""
    content = yaml.load(Path(MACHINE).read_text(encoding="utf-8"), PARSER)
    content["/machine"]["ros__parameters"]["axes"] = [*AXES]
    group = content["/channel"]["ros__parameters"]["gruppe"]["0"]
    group["achs_anzahl"] = len(AXES)
    for place, name in enumerate(AXES[3:], start=3):
        number = FIRST_COPY + place - 3
        group["achse"][str(place)] = {"bezeichnung": name.upper(), "log_achs_nr": number}
        axis = content[f"/{name}"] = copy.deepcopy(content["/z"])
        axis["ros__parameters"]["kopf"]["achs_nr"] = number
    return yaml.safe_dump(content, sort_keys=False)


def write_recording(path: Path, seconds: int, middle: Middle, state: bytes, texts: dict[str, str]) -> None:
    """Blocks of an hour, made of one second of them; with a checkpoint of the machine in the middle."""
    begin = partial(announce_run, text=middle.text)
    with tempfile.TemporaryDirectory() as folder:
        second = one_second(Path(folder) / "second.mcap")
        at_middle = partial(store_state, cycle=middle.cycle, state=state, texts=texts)
        repeat_second(second, path, seconds, {0: begin, seconds // 2: at_middle})


def announce_run(file: McapFile, text: str) -> None:
    file.attachment(MACHINE_FILE, "application/yaml", text.encode(), 0)
    file.metadata(METADATA, {"start_ns": "0", "cycle_time_ns": "1000000"})


def store_state(file: McapFile, cycle: int, state: bytes, texts: dict[str, str]) -> None:
    time_ns = cycle * 1_000_000
    for digest, text in texts.items():
        file.attachment(f"{CHECKPOINT_TEXT}{digest}", "text/plain", text.encode(), time_ns)
    file.attachment(f"{CHECKPOINT}{cycle}", "application/octet-stream", state, time_ns)
