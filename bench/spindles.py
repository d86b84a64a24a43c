"""Spindles: 16 of them with two channels offline, at steady speeds and in ramps, with paths, with recording."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from itertools import cycle, islice
from pathlib import Path
from typing import Any

import yaml

from bench.figures import Effort, Figure, ShowProgress, stopwatch
from bench.jobs import MACHINE
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.recording.offline_run import write
from cnc_ptp.recording.writer import Recording

CHANNELS = {"one": "x", "two": "z"}
SPINDLES = 16
SECONDS = 10.0
GOAL = 30.0
STEADY, RAMPS = (500, 1500, 2500, 3500), (6000, 500)
"""Speeds in rpm; from one to the other of the ramps takes 0.9 s."""
STROKE, STROKE_TIME = 10, 0.4
"""mm back and forth at F2000, and about how long one takes, s."""


def machine_file(path: Path) -> str:
    """The mill with 16 spindles: two channels, each with an axis and eight spindles."""
    source = yaml.load(Path(MACHINE).read_text(), yaml.BaseLoader)
    own = {name: part["ros__parameters"] for name, part in source.items()}
    names = [f"s{number}" for number in range(1, SPINDLES + 1)]
    units = {"machine": own["/machine"] | {"channels": [*CHANNELS], "axes": [*CHANNELS.values()], "spindles": names}}
    for index, (channel, axis) in enumerate(CHANNELS.items()):
        units[channel] = own["/channel"] | channel_lists(axis, own[f"/{axis}"], range(8 * index + 1, 8 * index + 9))
        units[axis] = own[f"/{axis}"]
    units |= {name: own["/s"] | {"kopf": {"achs_nr": str(10 + n)}} for n, name in enumerate(names, 1)}
    path.write_text(plain_yaml({f"/{name}": {"ros__parameters": part} for name, part in units.items()}))
    return str(path)


def channel_lists(name: str, axis: dict[str, Any], numbers: range) -> dict[str, Any]:
    """An axis and the spindles of these numbers, the first of them the main spindle."""
    axis_list = {"bezeichnung": name.upper(), "log_achs_nr": axis["kopf"]["achs_nr"]}
    kinds = {"s_synch": "MOS", "m3_synch": "MOS", "m4_synch": "MOS"}
    spindles = {
        str(index): kinds | {"bezeichnung": f"S{number}", "log_achs_nr": str(10 + number)}
        for index, number in enumerate(numbers)
    }
    return {
        "gruppe": {"0": {"achs_anzahl": "1", "achse": {"0": axis_list}}},
        "spdl_anzahl": str(len(numbers)),
        "main_spindle_ax_nr": str(10 + numbers[0]),
        "spindel": spindles,
    }


def plain_yaml(parts: dict[str, Any]) -> str:
    """Numbers without quotes."""
    return yaml.dump(parts, Dumper=NoAliases).replace("'", "")


class NoAliases(yaml.SafeDumper):
    """Writes what occurs twice twice."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def program(axis: str, numbers: range, speeds: Sequence[int], hold: float, seconds: float) -> str:
    """Every `hold` s all spindles get the next of `speeds`, every other one in the opposite direction.

    Meanwhile `axis` moves back and forth; without one the path waits.
    """
    names = ["S", *(f"S{number}" for number in numbers[1:])]
    strokes = [f"G01 {axis.upper()}{STROKE * (n % 2)} F2000" for n in range(1, 1 + round(hold / STROKE_TIME))]
    meanwhile = strokes if axis else [f"G04 {hold}"]
    lines = []
    for speed in islice(cycle(speeds), 2 + int(seconds / hold)):
        words = [f"{name}[REV{speed + 10 * n} M{3 + n % 2}]" for n, name in enumerate(names)]
        lines += [" ".join(words), *meanwhile]
    return "\n".join(["%SPINDLES", *lines, "M30", ""])


def entries(speeds: Sequence[int], hold: float, seconds: float, *, paths: bool = False) -> list[Entry]:
    """Both programs, loaded and started."""
    found = []
    for index, (channel, axis) in enumerate(CHANNELS.items()):
        text = program(axis if paths else "", range(8 * index + 1, 8 * index + 9), speeds, hold, seconds)
        load = Command(channel, "load", {"program": "spindles.nc", "text": text})
        found += [Entry(0.0, load), Entry(0.0, Command(channel, "start", {}))]
    return found


def times_real_time(
    machine: MachineParameters, scenario: Sequence[Entry], seconds: float, record: Path | None
) -> float:
    """Machine time over wall time; the first second, in which all spindles run up, is not counted."""
    offline = OfflineMachine(machine, build_units(machine, scenario=scenario))
    block = machine.block_cycles * machine.cycle_time_us * 1e-6
    for _ in range(round(1.0 / block)):
        offline.tick()
    with stopwatch() as watch, ExitStack() as stack:
        recording = stack.enter_context(Recording(record, "", 0, machine.cycle_time_us * 1000)) if record else None
        for _ in range(round(seconds / block)):
            outputs = offline.tick()
            if recording:
                write(recording, outputs)
    return seconds / watch.wall


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """All rates, the best of several runs."""
    seconds = SECONDS * effort.size
    with tempfile.TemporaryDirectory() as folder:
        machine = read_machine(machine_file(Path(folder) / "spindles.yaml"))
        for name, speeds, hold in (("at steady speeds", STEADY, 5.0), ("in ramps", RAMPS, 0.8)):
            for doing, paths, record in (
                ("the axes stand", False, None),
                ("the axes on their paths", True, None),
                ("the same with full recording", True, Path(folder) / "run.mcap"),
            ):
                show(f"{SPINDLES} spindles {name}, {doing}")
                scenario = entries(speeds, hold, seconds, paths=paths)
                rate = max(times_real_time(machine, scenario, seconds, record) for _ in range(effort.runs))
                title = f"{SPINDLES} spindles and 2 channels offline, {name}, {doing} (best)"
                yield Figure(title, rate, "x real time", goal=GOAL)
