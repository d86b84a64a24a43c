"""Machines with several spindles and channels, and questions to their runs."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

from machine_support import MILL, MachineBench

from cnc_ptp.parameters import ChannelParameters, ChannelSpindle, MachineParameters, SpindleParameters, Synchronisation
from cnc_ptp.protocol.blocks import HandshakeRequest

NO_SYNCH = Synchronisation.NO_SYNCH
MOS, MVS_SVS, MVS_SNS, MNS_SNS, MNE_SNS, MVS_SLM, MVS_SLP, PLC_INFO = Synchronisation
CHANNEL = MILL.channels["channel"]
MANUAL = "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}\n"
"""The PLC acknowledges nothing automatically."""


def channel_spindle(
    name: str, node: str, number: int, kind: Synchronisation = MVS_SVS, **changes: Any
) -> ChannelSpindle:
    """A spindle whose M functions are all of one type, its S function of MOS."""
    return ChannelSpindle(name, node, kind, kind, kind, kind, MOS, own_name=name, number=number)._replace(**changes)


def three(kind: Synchronisation = MVS_SVS, **main: Any) -> tuple[ChannelSpindle, ...]:
    """S1 (node s, 6) as main spindle S, S2 (t, 11), S3 (u, 30); `main` changes S1."""
    first = channel_spindle("S", "s", 6, kind)._replace(**{"own_name": "S1", **main})
    return first, channel_spindle("S2", "t", 11, kind), channel_spindle("S3", "u", 30, kind)


def machine_of(
    *spindles: ChannelSpindle, units: dict[str, SpindleParameters] | None = None, **channel: Any
) -> MachineParameters:
    """The mill with these spindles; `units` has other parameters of some nodes, `channel` of the channel."""
    nodes = {spindle.node: replace(MILL.spindles["s"], name=spindle.node) for spindle in spindles if spindle.node}
    with_spindles = replace(CHANNEL, **{"spindles": spindles, "main_spindle": spindles[0].name, **channel})
    return replace(MILL, spindles={**nodes, **(units or {})}, channels={"channel": with_spindles})


def two_channels(**first: Any) -> MachineParameters:
    """Channel `channel` with X, `second` with Y; both have the spindles S1 (s, main) and S2 (t)."""
    spindles = three()[:2]
    one: ChannelParameters = replace(CHANNEL, axes=CHANNEL.axes[:1], spindles=spindles, **first)
    other = replace(CHANNEL, name="second", axes=CHANNEL.axes[1:2], spindles=spindles)
    return replace(machine_of(*spindles), channels={"channel": one, "second": other})


def run(program: str, machine: MachineParameters, scenario: str = "", **options: Any) -> MachineBench:
    """A program to its end."""
    return MachineBench(f"%P\n{program}\nM30", scenario, machine=machine, **options).run()


def told(bench: MachineBench, unit: str = "s") -> list[tuple[str, dict[str, Any]]]:
    """What a unit has accepted, without who said so and how a stop counts."""
    of_unit = [record for record in bench.records if record.target == unit and record.accepted]
    records = [record for record in of_unit if record.command != "reset_feedforward"]
    arguments = [json.loads(record.arguments_json) for record in records]
    for words in arguments:
        words.pop("source", None)
        for name in ("own", "homes"):
            words.pop(name, None)
    return [(record.command, words) for record, words in zip(records, arguments, strict=True)]


def told_at(bench: MachineBench, command: str, unit: str = "s") -> int:
    """Cycle of the first such command."""
    return next(record.cycle for record in bench.records if record.target == unit and record.command == command)


def requests(bench: MachineBench, channel: str = "channel") -> list[HandshakeRequest]:
    return [request for block in bench.blocks[channel] for request in block.requests]


def moves(bench: MachineBench, unit: str = "channel") -> list[tuple[int, int]]:
    """(first, last) cycle of each stretch in which the path moves."""
    stretches: list[tuple[int, int]] = []
    for cycle, velocity in enumerate(bench.column(unit, "path_velocity")):
        if not velocity:
            continue
        if stretches and stretches[-1][1] == cycle - 1:
            stretches[-1] = (stretches[-1][0], cycle)
        else:
            stretches.append((cycle, cycle))
    return stretches


def reported(bench: MachineBench, node: str, column: str, since: int) -> int:
    """First cycle of the block after the first one from `since` on that ends with a true value."""
    block = next(b for b in bench.blocks[node] if b.first_cycle >= since and getattr(b, column)[-1])
    return int(block.first_cycle + block.count)
