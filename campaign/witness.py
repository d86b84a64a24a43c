"""`python -m campaign.witness MACHINE FILE`: who sees axes, spindles and their drives when no recorder does any more.

A program of its own on the domain of a machine that runs. It writes to FILE (.npz) what it has seen when its standard
input is closed.
"""

from __future__ import annotations

import os
import select
import subprocess
import sys
import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import rclpy

from cnc_ptp import msg
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes import process
from cnc_ptp.nodes.topics import BLOCK_CLASSES, BLOCK_TYPES, BLOCKS, DRIVE_STOPS, EVENTS, block_topic
from cnc_ptp.parameters import read_machine
from cnc_ptp.recording.reader import DriveStop, Recorded
from cnc_ptp.wire.block_codec import codec_of

COLUMNS = {
    "axis": ("set_position", "set_velocity", "actual_position", "actual_velocity"),
    "spindle": ("set_position_deg", "set_speed_rpm", "actual_position_deg", "actual_speed_rpm"),
}
STOP = "drive_stop "
"""Name of the values of a drive that has stopped on its own: this, and the unit."""
START, PATIENCE = 30.0, 60.0
"""Seconds for the start of the program; for the first block of all units, and for its end."""


class Witness:
    """Runs the program; what it has seen comes as a recording of states and stops of drives alone."""

    def __init__(self, machine: Path, file: Path, domain: int) -> None:
        self._file = file
        words = [sys.executable, "-m", "campaign.witness", str(machine), str(file)]
        environment = os.environ | {"ROS_DOMAIN_ID": str(domain)}
        self._process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment
        )

    def __enter__(self) -> Witness:
        return self

    def __exit__(self, _type: type | None, _error: BaseException | None, _trace: TracebackType | None) -> None:
        self._process.kill()
        self._process.communicate()

    def wait(self) -> None:
        """Until it has seen all units, for PATIENCE at most, or has ended."""
        select.select([self._process.stdout], [], [], START + PATIENCE)

    def seen(self) -> Recorded:
        """Nothing where it has ended before or does not end."""
        with suppress(subprocess.TimeoutExpired):
            self._process.communicate(timeout=PATIENCE)
        found = Recorded(self._file)
        if not self._file.exists():
            return found
        with np.load(self._file) as values:
            for name in values.files:
                if name.startswith(STOP):
                    rows = values[name]
                    unit, first_cycle = name.removeprefix(STOP), int(rows[0, 0])
                    found.drive_stops.append(DriveStop(unit, first_cycle, rows[1:, 0], rows[1:, 1]))
                else:
                    found.states[f"/{name}/state"] = values[name]
        return found


def rows_of(kind: str, blocks: list[Any]) -> Any:
    """The cycles of blocks as a recording has them."""
    names = COLUMNS[kind]
    rows = np.zeros(sum(block.count for block in blocks), [("cycle", np.uint64), *((name, float) for name in names)])
    rows["cycle"] = [cycle for each in blocks for cycle in range(each.first_cycle, each.first_cycle + each.count)]
    for name in names:
        rows[name] = [value for block in blocks for value in getattr(block, name)]
    return rows


def stop_rows(stop: Any) -> Any:
    """Its first cycle, then positions and velocities."""
    return np.array([[stop.first_cycle, 0.0], *zip(stop.actual_position, stop.actual_velocity, strict=True)])


def main(machine_file: str, file: str) -> None:
    process.initialise()
    kinds = {name: kind for name, kind in unit_kinds(read_machine(machine_file)).items() if kind in COLUMNS}
    node = rclpy.create_node("witness", enable_rosout=False, start_parameter_services=False)
    blocks: dict[str, list[Any]] = {unit: [] for unit in kinds}
    stops: list[Any] = []
    decoders = {kind: codec_of(BLOCK_CLASSES[kind]).decode for kind in COLUMNS}
    for unit, kind in kinds.items():
        node.create_subscription(BLOCK_TYPES[kind], block_topic(unit), partial(keep, blocks[unit], decoders[kind]),
                                 BLOCKS, raw=True)  # fmt: skip
    node.create_subscription(msg.DriveStop, DRIVE_STOPS, stops.append, EVENTS)
    executor = process.EventsExecutor()
    executor.add_node(node)
    told, patient = False, time.monotonic() + PATIENCE
    while not select.select([sys.stdin], [], [], 0.0)[0]:
        executor.spin_once(timeout_sec=0.05)
        if not told and (all(blocks.values()) or time.monotonic() > patient):
            told = True
            print("there", flush=True)
    seen = {unit: rows_of(kinds[unit], each) for unit, each in blocks.items() if each}
    np.savez(file, **seen, **{f"{STOP}{stop.unit}": stop_rows(stop) for stop in stops})
    executor.shutdown()
    rclpy.try_shutdown()


def keep(blocks: list[Any], decode: Any, data: bytes) -> None:
    blocks.append(decode(data))


if __name__ == "__main__":
    main(*sys.argv[1:])
