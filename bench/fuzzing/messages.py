"""Messages without nodes: bytes for their decoders, and the commands that requests and goals stand for.

The invariants of checked_machine.py hold for whatever comes.
"""

from __future__ import annotations

import json
import math
import random
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from bench.checked_machine import CheckedMachine
from bench.fuzzing.engine import Broken, Draw, Target
from bench.fuzzing.mutation import HUGE, mutated_bytes, wild
from bench.jobs import ROOT
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.bridge.function_blocks import given_inputs
from cnc_ptp.nodes.topics import BLOCK_CLASSES, SERVICES
from cnc_ptp.nodes.unit.requests import given_arguments, objection
from cnc_ptp.parameters import MachineParameters, read_machine
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.commands import COMMANDS, Argument
from cnc_ptp.wire.block_codec import codec_of, encode_block, has_plain_header, head_of
from cnc_ptp.wire.stamps import Stamps
from cnc_ptp.wire.ticks import decode_tick, encode_tick

MACHINES = ("config/mill.yaml", "config/lathe.yaml", "config/gantry.yaml")
STAMPS = Stamps(0, 1_000_000)
LASTS = 200
"""Inputs of a machine, then it is made anew: it may have come into a state in which it refuses nearly everything."""


def new_machine(machine: MachineParameters) -> CheckedMachine:
    """It has run for some blocks."""
    new = CheckedMachine(machine)
    for _ in range(3):
        new.tick()
    return new


def unbroken(machine: CheckedMachine) -> None:
    """Raises Broken with an invariant that did not hold."""
    if machine.violations:
        raise Broken(machine.violations[0])


def computed(machine: CheckedMachine) -> None:
    """A block; all that units say can be sent and read."""
    for output in machine.tick().values():
        codec_of(type(output.block)).decode(encode_block(output.block, STAMPS))
    unbroken(machine)


# commands and services


class Given(NamedTuple):
    """A command with its arguments; `blocks`: how many are computed then."""

    machine: int
    unit: str
    command: str
    arguments: dict[str, Any]
    blocks: int
    by_service: bool


def commands(_folder: Path) -> Target:
    """Of all units with arguments of every kind, as blocks, scenarios and services bring them."""
    parameters = [read_machine(ROOT / file) for file in MACHINES]
    running = [*map(new_machine, parameters)]

    def renew() -> None:
        running[:] = map(new_machine, parameters)

    def make(draw: random.Random) -> Given:
        number = draw.randrange(len(running))
        unit, kind = draw.choice([*running[number].kinds.items()])
        command = draw.choice([*COMMANDS[kind]])
        by_service = command in SERVICES[kind] and draw.random() < 0.3
        names = [*running[number].kinds]
        arguments = {
            name: drawn(argument, names, draw)
            for name, argument in COMMANDS[kind][command].items()
            if argument.required or draw.random() < 0.4
        }
        if draw.random() < 0.1:
            arguments[draw.choice(("x", "target", "text", "", *arguments))] = wild(draw)
        if draw.random() < 0.02:
            command = draw.choice(("", "step", "command", "__init__", command[:-1], "x" * 1000))
        return Given(number, unit, command, arguments, draw.choice((0, 0, 1, 5)), by_service)

    def call(given: Given) -> None:
        here = running[given.machine]
        kind, arguments, reason = here.kinds[given.unit], given.arguments, ""
        if given.by_service and given.command in SERVICES[kind]:
            request = request_of(SERVICES[kind][given.command], arguments)
            known = COMMANDS[kind][given.command]
            arguments, reason = given_arguments(known, request), objection(given.command, known, request)
        if reason:
            return
        record = here.command(Command(given.unit, given.command, arguments))
        unbroken(here)
        json.loads(record.arguments_json)
        for _ in range(given.blocks):
            computed(here)
        if not record.accepted:
            raise CncError(record.error_id, record.message)

    return Target(make, call, renew=renew, lasts=LASTS)


def drawn(argument: Argument, units: list[str], draw: random.Random) -> Any:
    """A value of an argument: mostly one of its kind."""
    if draw.random() < 0.1:
        return wild(draw)
    if argument.choices:
        return draw.choice((*argument.choices, "", "x"))
    if argument.kind == "number":
        return draw.choice(
            (
                0.0,
                1.0,
                -1.0,
                10.0,
                100.0,
                1e-9,
                1e9,
                draw.uniform(-500, 500),
                draw.uniform(0, 200),
                math.nan,
                math.inf,
                1e300,
            )
        )
    if argument.kind == "integer":
        return draw.choice((0, 1, 2, 3, 7, 54, 255, 2**32 - 1, 2**63, -1))
    if argument.kind == "switch":
        return draw.random() < 0.5
    if argument.kind == "rows":
        return draw.choice(ROWS) if draw.random() < 0.8 else [wild(draw) for _ in range(draw.randrange(4))]
    if argument.kind == "files":
        return {draw.choice(("a.nc", "", "../b.nc")): draw.choice(("M29", "", "x" * HUGE))}
    return draw.choice(
        (
            *units,
            "G1 X10 F500\nM30",
            "M3 S500\nG4 X1\nM30",
            "G0 Y5",
            "getriebe.0.kv",
            "S-0-0047",
            "part.nc",
            "",
            "x" * 300,
        )
    )


ROWS: tuple[list[Any], ...] = (
    [[0, 0], [10, 5.5], [20, 0]], [[0.0, 0.0], [10.0, math.nan]], [[10, 0], [0, 0]], [["x", "y"]], ["x", "y"], ["x"],
    [[0.5, [1, 2], [0, 0]], [1.0, [2, 3]]], [[0.1, [1.0]], [0.2, [1.1]]],
    [[100, 1.0, 0.0, 0.0, 1], [110, 1.1, 0.0, 0.0, 1]],
    [[10**400, 0, 0, 0, 1]], [[1, 1, 1]] * 2000, [[1e308, -1e308], [1.7e308, 1e308]], [1.0, 2.0], [],
)  # fmt: skip


def request_of(service: Any, arguments: Mapping[str, Any]) -> Any:
    """A request with these fields, as far as its types have them: below DDS there are no others."""
    request = service.Request()
    for name, value in arguments.items():
        for field, content in ((name, value), (f"has_{name}", True)):
            if hasattr(request, field):
                try:
                    setattr(request, field, content)
                except (AssertionError, TypeError, ValueError, OverflowError, UnicodeError):
                    continue
    return request


def function_blocks(_folder: Path) -> Target:
    """Goals of the action function_block, called on the PLC unit of a mill."""
    from cnc_ptp import action
    from cnc_ptp.plc.called_blocks import CalledBlocks
    from cnc_ptp.plc.plcopen.catalogue import BLOCK_TYPES

    parameters = read_machine(ROOT / MACHINES[0])
    running: list[tuple[CheckedMachine, CalledBlocks]] = []

    def renew() -> None:
        machine = new_machine(parameters)
        blocks = CalledBlocks(machine.kinds, parameters.sets, machine.plc.is_lost)
        machine.plc.outside.append(blocks.cycle)
        running[:] = [(machine, blocks)]

    renew()
    kinds = running[0][0].kinds
    fields = action.FunctionBlock.Goal.get_fields_and_field_types()

    def make(draw: Draw) -> FunctionBlockGoal:
        unit, kind = draw.choice([(unit, kind) for unit, kind in kinds.items() if kind in BLOCK_TYPES])
        name = draw.choice([*BLOCK_TYPES[kind], "MC_Nothing", ""])
        chosen = draw.sample([*fields], k=draw.randint(0, 8))
        values = {field: drawn(Argument(OF_FIELD.get(fields[field], "rows")), [*kinds], draw) for field in chosen}
        return FunctionBlockGoal(unit, name, values, draw.number % 3 == 0)

    def call(given: FunctionBlockGoal) -> None:
        machine, blocks = running[0]
        goal = request_of(GoalOf, given.values)
        try:
            call = blocks.start(given.unit, given.name, given_inputs(goal, f"{given.unit}: {given.name} refused"))
            if given.cancelled:
                blocks.cancel(call)
        finally:
            computed(machine)

    class GoalOf:
        Request = action.FunctionBlock.Goal

    return Target(make, call, renew=renew, lasts=LASTS)


class FunctionBlockGoal(NamedTuple):
    """A block with the fields of its goal."""

    unit: str
    name: str
    values: dict[str, Any]
    cancelled: bool


OF_FIELD = {
    "double": "number",
    "boolean": "switch",
    "string": "text",
    "int32": "integer",
    "uint32": "integer",
    "uint8": "integer",
    "int64": "integer",
}


# bytes


def blocks(_folder: Path) -> Target:
    """Blocks and ticks as they come over a topic or lie in a recording."""
    machine = new_machine(read_machine(ROOT / MACHINES[0]))
    machine.plc.input(Command("channel", "mdi", {"text": "M3 S500 G1 X10 F500"}))
    told = [output.block for _ in range(40) for output in machine.tick().values()]
    sent = [(type(block), encode_block(block, STAMPS)) for block in told]
    sent += [(type(None), encode_tick(10, 10, 0, 10_000_000))] * 20
    others = [data for _, data in sent]

    def make(draw: random.Random) -> tuple[type, bytes]:
        of, data = draw.choice(sent)
        return of, draw.choice(others) if draw.random() < 0.05 else mutated_bytes(data, draw, others=others)

    def call(given: tuple[type, bytes]) -> None:
        of, data = given
        if of is type(None):
            decode_tick(data)
            return
        block = codec_of(of).decode(data)
        if has_plain_header(data):
            head_of(data)
        encode_block(block, STAMPS)

    assert {of for of, _ in sent} == {*BLOCK_CLASSES.values(), type(None)}
    return Target(make, call)
