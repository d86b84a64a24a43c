"""`python -m bench.random_commands [STEPS] [SEED]`: random commands in random states; no invariant may break.

A machine runs offline. Each step is a command with random arguments, good and bad ones, to an axis, a spindle, a
channel or the PLC, or some blocks of time. What must hold:

- the invariants of each command and block (checked_machine.py); what the PLC passes on and is refused in its block
  leaves everything as in a twin that did not get it,
- the motion keeps to its limits and has no step, what is stopped stays stopped (recording/motion_check),
- the run computed again from its recorded commands is equal to the bit.

A machine lives for some hundred steps; its seed is printed with each violation and makes it again.
"""

from __future__ import annotations

import math
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import fields
from functools import cache, partial
from typing import Any

import numpy as np

from bench.checked_machine import CheckedMachine
from bench.jobs import ROOT
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.blocks import AxisBlock, Command, CommandRecord, SpindleBlock
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL, THROUGH_PLC, Argument
from cnc_ptp.protocol.control_units import CONTROL_UNITS
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.recording.computed_again import commands_by_cycle, computed_again, fresh_machine
from cnc_ptp.recording.motion_check.check import check_motion
from cnc_ptp.recording.motion_check.inputs import (
    AXIS_FIELDS,
    SPINDLE_FIELDS,
    Columns,
    MotionInputs,
    in_order,
    orders_by_unit,
)
from cnc_ptp.wire.block_codec import encode_block
from cnc_ptp.wire.stamps import Stamps

NO_STAMPS = Stamps(0, 0)
TWO_CHANNELS = "examples/spindles/two_channels.yaml"
MACHINES = ("config/mill.yaml", "config/lathe.yaml", "config/ptp.yaml", "config/gantry.yaml", TWO_CHANNELS)
LIFE = 300
"""Steps of a machine."""
POWERED = 0.9
"""Share of axes and spindles that have power from the start."""
MOST_STOPPING = 10
"""Seconds of machine time, 100 blocks each, in which all units must rest."""
TWINS = 0.3
"""Share of commands through the PLC that are compared with a machine that did not get them."""
BLOCKS_AFTER = 3
FREED = 0.03
"""Share of steps that set all units free first: otherwise most of a life is spent at a standstill."""
LEFT_OUT = INTERNAL | {"write_drive_parameter", "read_drive_parameter", "write_parameter", "serve", "set_life_sign"}
"""Commands of other units, and those that change what the checker takes from the machine file."""
BAD = (math.nan, math.inf, -math.inf, 1e300, -1e300, 0.0, -0.0, "1", None, True, [], {})
PLACES = ("target", "position", "activation_position", "master_position", "slave_position")
NUMBERS: Mapping[str, tuple[float, float]] = {
    **dict.fromkeys(PLACES, (-150.0, 150.0)),
    **dict.fromkeys(("acceleration", "deceleration"), (50.0, 4000.0)),
    **dict.fromkeys(("factor_num", "factor_den"), (1.0, 3.0)),
    "distance": (-80.0, 80.0),
    "velocity": (1.0, 400.0),
    "jerk": (1000.0, 90_000.0),
    "percent": (0.0, 120.0),
    "velocity_difference": (1.0, 50.0),
    "speed_rpm": (1.0, 4000.0),
    "position_deg": (-720.0, 720.0),
    "factor": (-2.0, 2.0),
    "acc_bound": (100.0, 9000.0),
    "difference_limit": (0.1, 20.0),
    "length": (1.0, 60.0),
    "difference": (-10.0, 10.0),
    "process_velocity": (1.0, 200.0),
    "velocity_increase": (1.0, 100.0),
    "max_speed_rpm": (100.0, 5000.0),
    "min_speed_rpm": (0.0, 50.0),
    "max_acceleration": (1000.0, 30_000.0),
}
PROGRAMS = (
    "N10 G01 X10 F1000\nN20 G01 X-10 Z-5\nN30 G00 X0 Z0\nM30\n",
    "N10 G00 X5\nN20 M03 S500\nN30 G04 0.1\nN40 G01 X20 F3000\nN50 M05\nM30\n",
    "N10 G02 X10 I5 F2000\nN20 M00\nN30 G01 X0\nM30\n",
    "N10 G01 X1e9\n",
    "N10 G01 X[\n",
    "N10 G18 G00 X30 Z60\nN20 M03 S400\nN30 G33 Z40 K2\nN40 G00 X40\nN50 M05\nM30\n",
    "N10 M19 S.POS=0 M3 S100\nN20 G63 Z-8 F250 S200\nN30 Z5 S-200\nN40 M05 G01 X5 F1000\nM30\n",
    "N10 G00 X40\nN20 M19 S.POS=0 S200\nN30 #CAX [S, C]\nN40 G01 X20 C90 F2000\nN50 C-45\nN60 #CAX OFF\nM30\n",
    "N10 S[M03 REV1000]\nN20 G01 X50 F4000\nN30 G95 F0.2 X45\nN40 S[M19 REV200 POS90]\nM30\n",
    "N10 S1[M04 REV800]\nN20 G01 Y50 F3000\nN30 S1[M19 REV200 POS90]\nN40 S3[M05]\nM30\n",
)


@cache
def machine_of(path: str) -> MachineParameters:
    return read_machine(str(ROOT / path))


class CommandedMachine(CheckedMachine):
    """A machine with the commands, blocks and violations of its run."""

    def __init__(self, seed: int, machine: str = "", *, freed: float = FREED) -> None:
        """`machine`: file below the repository; the seed chooses one of MACHINES without it."""
        self.seed, self.random = seed, random.Random(seed)
        self._chance_to_free, self._freed = random.Random(f"free {seed}"), freed
        super().__init__(machine_of(machine or self.random.choice(MACHINES)))
        self.blocks: dict[str, list[Any]] = {name: [] for name in self.units}
        self.records: list[CommandRecord] = []
        self.counts: Counter[str] = Counter()
        for name, kind in self.kinds.items():
            if kind in ("axis", "spindle") and self.random.random() < POWERED:
                self.offline.runner(name).command(Command(name, "power", {"enabled": True}))

    # steps

    def step(self) -> None:
        """A command, or time."""
        if self._chance_to_free.random() < self._freed:
            self.set_free()
        if self.random.random() < 0.3:
            self.run(self.random.choice((1, 1, 2, 5, 20, 60)))
        else:
            self.random_command()

    def set_free(self) -> None:
        """As somebody would who wants to go on: nothing is held any more, errors are reset, the power is on."""
        give = partial(self.give, looked_at=False)  # they are always the same: not worth half of the time
        for unit, kind in self.kinds.items():
            commands = COMMANDS[kind]
            for control in CONTROL_UNITS.get(kind, ()):
                give(unit, "overlay", {"control_unit": control.name, "enabled": False})
            for command in ("hold_stop", "feed_hold", "set_emergency_stop"):
                if command in commands:
                    give(unit, command, {"enabled": False})
            if "set_feed_release" in commands:
                give(unit, "set_feed_release", {"forward": True, "backward": True})
            if "set_override" in commands:
                give(unit, "set_override", {"percent": 100.0})
        self.run(1)
        for unit, kind in self.kinds.items():
            if kind != "spindle":  # it would stop
                give(unit, "reset", {})
            if "power" in COMMANDS[kind]:
                give(unit, "power", {"enabled": True})

    def random_command(self) -> None:
        unit = self.random.choice([*self.kinds])
        kind = self.kinds[unit]
        command = self.random.choice([name for name in COMMANDS[kind] if name not in LEFT_OUT])
        self.give(unit, command, self.arguments(unit, command))

    def arguments(self, unit: str, command: str) -> dict[str, Any]:
        """Random ones: mostly good, sometimes missing, surplus or of another type."""
        chance, given = self.random, {}
        for name, argument in COMMANDS[self.kinds[unit]][command].items():
            if not argument.required and chance.random() < 0.6:
                continue
            given[name] = chance.choice(BAD) if chance.random() < 0.04 else self.value(unit, name, argument)
        if chance.random() < 0.02 and given:
            given.pop(chance.choice([*given]))
        if chance.random() < 0.01:
            given["surplus"] = 1
        return given

    def value(self, unit: str, name: str, argument: Argument) -> Any:
        """A good value of one argument."""
        chance, kind = self.random, argument.kind
        if argument.choices:
            return chance.choice(argument.choices)
        if kind == "number":
            low, high = NUMBERS.get(name, (-10.0, 10.0))
            return chance.choice((0.0, low, high, chance.uniform(low, high), chance.uniform(low, high)))
        if kind == "integer":
            return chance.choice((0, 1, 2, 3, 7))
        if kind == "switch":
            return chance.random() < 0.6
        if kind == "rows":
            return self.rows(unit, name)
        return self.text(unit, name)

    def text(self, unit: str, name: str) -> Any:
        chance = self.random
        if name == "text":
            return chance.choice(PROGRAMS)
        if name == "master":
            return chance.choice([other for other in self.kinds if self.kinds[other] == self.kinds[unit]])
        if name in ("source", "owner"):
            return chance.choice([PLC, *self.machine.channels, "nobody"])
        if name == "axis":
            return chance.choice(["X", "Y", "Z"])
        return chance.choice(["", "x", "part.nc"])

    def rows(self, unit: str, name: str) -> list[Any]:
        chance = self.random
        if name == "axes":
            return [chance.choice([*self.machine.axes])]
        if name == "points":
            return [[0.2 * n, [chance.uniform(-1.0, 1.0)], [0.0]] for n in range(3)]
        if name == "setpoints":
            begin, place = self.offline.next_cycle + 20, self.position(unit)
            return [[begin + n, place + 0.001 * n * n, 0.002 * n / 0.001, 0.0, 1] for n in range(5)]
        if name == "table":
            return [[0.0, 0.0], [10.0, 5.0], [20.0, 0.0], [40.0, 1.0]]
        return []

    def position(self, unit: str) -> float:
        blocks = self.blocks[unit]
        return float(blocks[-1].set_position[-1]) if blocks and isinstance(blocks[-1], AxisBlock) else 0.0

    def give(self, unit: str, command: str, arguments: dict[str, Any], *, looked_at: bool = True) -> None:
        """One command; what goes through the PLC is carried out in the next block."""
        asked = Command(unit, command, arguments)
        self.counts["commands"] += 1
        if self.kinds[unit] != "axis" or command not in THROUGH_PLC:
            self.counts["refused"] += not self.command(asked, looked_at=looked_at).accepted
        elif self.random.random() < TWINS and not self.plc._end_when_idle:  # a command would be time that is not idle
            self.give_with_twin(asked)
        else:
            self.plc.input(asked)

    def give_with_twin(self, asked: Command) -> None:
        """A command through the PLC and its block; if it is refused, this and the next blocks are those without it."""
        before = self.state()
        self.plc.input(asked)
        given = len(self.records)
        self.run(1)
        answers = [
            each for each in self.records[given:] if (each.target, each.command) == (asked.target, asked.command)
        ]
        if len(answers) != 1 or answers[0].accepted:
            return
        self.counts["refused"] += 1
        self.counts["compared with a twin"] += 1
        said = f"{asked.target} {asked.command} {asked.arguments}: {answers[0].message}"
        blocks = [{name: of_unit[-1] for name, of_unit in self.blocks.items()}]
        twin, again = self.twin(before), self.twin(self.state())
        blocks += [{name: output.block for name, output in again.tick().items()} for _ in range(BLOCKS_AFTER)]
        for expected in blocks:
            for name, output in twin.tick().items():
                if name != PLC:
                    self.compare(output.block, expected[name], f"{name} after the refused {said}")

    def run(self, blocks: int) -> None:
        """Time goes on."""
        for _ in range(blocks):
            self.counts["blocks"] += 1
            for name, output in self.tick().items():
                self.blocks[name].append(output.block)
                self.records += output.records
                self.counts["blocks of units in motion"] += moves(output.block)

    def require(self, holds: bool, text: str) -> None:
        super().require(holds, f"seed {self.seed} cycle {self.offline.next_cycle}: {text}")

    def finish(self) -> list[str]:
        """Comes to rest, then motion and replay are checked; all violations of the run."""
        self.offline.stop()
        self.come_to_rest()
        result = check_motion(inputs_of(self.machine, self.blocks, self.records))
        self.violations += [f"seed {self.seed}: {violation}" for violation in result.violations]
        self.check_replay()
        return self.violations

    def come_to_rest(self) -> None:
        """After a stop of all units; the slowest ramp of a command takes 8 s."""
        for _ in range(MOST_STOPPING):
            self.run(100)
            moving = [name for name, blocks in self.blocks.items() if blocks and moves(blocks[-1])]
            if not moving:
                return
        self.require(False, f"still in motion after a stop: {', '.join(moving)}")

    def check_replay(self) -> None:
        """The same blocks again from the recorded commands."""
        commands = commands_by_cycle(self.records, self.machine)
        again = computed_again(fresh_machine(self.machine), commands, self.offline.next_cycle)
        for number, outputs in enumerate(again):
            for name, output in outputs.items():
                if name != PLC:
                    self.compare(self.blocks[name][number], output.block, f"replay of {name}")
            if self.violations:
                return

    def compare(self, first: Any, second: Any, what: str) -> None:
        """Bit by bit; answers are for the PLC that has given the commands, which is not there in a replay."""
        if without_answers(first) == without_answers(second):
            return
        names = [each.name for each in fields(first) if each.name != "answers"]
        parted = [each for each in names if written(getattr(first, each)) != written(getattr(second, each))]
        self.require(not parted, f"{what} differs from cycle {first.first_cycle} in {', '.join(parted)}")


def without_answers(block: Any) -> bytes:
    """A block as it is sent."""
    answers, block.answers = block.answers, []
    message = encode_block(block, NO_STAMPS)
    block.answers = answers
    return message


def written(value: Any) -> str:
    """Every bit of a field; arguments of commands in any order."""
    if isinstance(value, list) and value and isinstance(value[0], Command):
        return str([(each.target, each.command, each.arguments_json, each.id) for each in value])
    return repr(value)


def moves(block: Any) -> bool:
    """Of an axis or a spindle with a setpoint of velocity."""
    if isinstance(block, AxisBlock):
        return any(block.set_velocity)
    return isinstance(block, SpindleBlock) and any(block.set_speed_rpm)


def inputs_of(
    machine: MachineParameters, blocks: Mapping[str, list[Any]], records: list[CommandRecord]
) -> MotionInputs:
    """A run as the checker reads it from a recording; `blocks` by unit."""
    commands = [(r.cycle, r.target, r.command, r.arguments_json, r.accepted) for r in records]
    inputs = MotionInputs(machine, machine.cycle_time_us * 1e-6, orders=orders_by_unit(machine, commands))
    for name in machine.axes:
        inputs.axes[name] = columns_of(blocks[name], AXIS_FIELDS)
    for name in machine.spindles:
        inputs.spindles[name] = columns_of(blocks[name], SPINDLE_FIELDS)
    for name in machine.channels:
        inputs.channels[name] = columns_of(blocks[name], ("cycle",))["cycle"]
    return inputs


def columns_of(blocks: list[Any], names: tuple[str, ...]) -> Columns:
    """Of the blocks of one unit."""
    cycles = [np.arange(block.first_cycle, block.first_cycle + block.count) for block in blocks]
    columns = {name: np.array([v for b in blocks for v in getattr(b, name)]) for name in names if name != "cycle"}
    return in_order({"cycle": np.concatenate(cycles), **columns})


def lives(steps: int, seed: int) -> Iterator[CommandedMachine]:
    """Machines one after the other until `steps` are done; each was checked."""
    for begin in range(0, steps, LIFE):
        machine = CommandedMachine(seed + begin // LIFE)
        for _ in range(min(LIFE, steps - begin)):
            machine.step()
        machine.finish()
        yield machine


def main(arguments: list[str]) -> int:
    """Status 1 with a violation."""
    steps, seed = (int(word) for word in (*arguments, *("3000", "1")[len(arguments) :]))
    begin, total, found = time.monotonic(), Counter[str](), 0
    for machine in lives(steps, seed):
        total += machine.counts
        for text in machine.violations[:5]:
            print(text, flush=True)
        found += bool(machine.violations)
    seconds = time.monotonic() - begin
    counted = ", ".join(f"{number} {name}" for name, number in sorted(total.items()))
    print(f"{steps} steps from seed {seed} in {seconds:.0f} s: {counted}; machines with a violation: {found}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
