"""The state of a machine between two blocks as bytes.

    4 bytes CNCS | layout 2 bytes | digest of the kernel's sources 16 bytes | check sum of the rest 16 bytes | rest

The rest is JSON, compressed by zstd: first cycle, value of the root, shapes, rows (encoding.py). A kernel takes the
states of its own sources only: what an attribute means is nowhere but there.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from functools import cache
from hashlib import blake2b
from typing import Any, Final, NamedTuple

import zstandard

from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.channel.running_blocks import RunningBlocks
from cnc_ptp.compiled.sources import hashes, sources
from cnc_ptp.garbage import paused_collector
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.runner import UnitRunner
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.state.decoding import Decoder
from cnc_ptp.state.encoding import Encoder, LongLists
from cnc_ptp.state.faults import damaged, other_version
from cnc_ptp.state.roots import Roots
from cnc_ptp.state.rows import ROW, is_part, require_lists

MAGIC: Final = b"CNCS"
LAYOUT: Final = 1
HEAD: Final = 4 + 2 + 16 + 16
LEVEL: Final = 3
CHECKPOINT_SECONDS: Final = 10.0
"""Machine time between two checkpoints. A replay computes so much more than it was asked for."""
LARGEST: Final = 1 << 30
"""Bytes of JSON; more than that has no machine."""


class MachineState(NamedTuple):
    """What is restored: the runners and the last blocks of the units that were stored."""

    next_cycle: int
    runners: dict[str, UnitRunner]
    blocks: dict[str, CycleBlock]


class StateStore:
    """Makes states of a machine, and units of them.

    texts   the long texts that the states refer to, by digest: programs, mostly
    """

    def __init__(self, machine: MachineParameters) -> None:
        self._roots = Roots({"machine": machine})
        self.texts: dict[str, str] = {}
        self._lists: LongLists = {}

    def encode(self, machine: OfflineMachine, *, with_plc: bool = False) -> bytes:
        """All units but the PLC, whose commands a recording has. Raises CncError 26150.

        `with_plc`: also that; not if it executes a file.
        """
        runners, blocks = machine.parts
        if not with_plc:
            runners = {name: runner for name, runner in runners.items() if name != PLC}
        return self.encode_units(machine.next_cycle, runners, blocks)

    def encode_units(
        self, next_cycle: int, runners: Mapping[str, UnitRunner], blocks: Mapping[str, CycleBlock]
    ) -> bytes:
        """Some units before a cycle, and the last blocks of some. Raises CncError 26150."""
        text = json.dumps(self.content_of_units(next_cycle, runners, blocks), separators=(",", ":"))
        rest = zstandard.compress(text.encode(), LEVEL)
        return MAGIC + LAYOUT.to_bytes(2, "little") + kernel_digest() + check_sum(rest) + rest

    def content_of_units(
        self, next_cycle: int, runners: Mapping[str, UnitRunner], blocks: Mapping[str, CycleBlock]
    ) -> list[Any]:
        """The same before it is compressed: cycle, value of the root, shapes, rows. Raises CncError 26150."""
        encoder = Encoder(self._roots, self.texts, interpreters(runners), self._lists)
        root = encoder.encode([runners, blocks])
        self._lists = encoder.lists
        return [next_cycle, root, encoder.shapes, encoder.rows]

    def restore(self, state: bytes) -> MachineState:
        """New units in a state. Raises CncError 26151 for damaged bytes, 26152 for those of another kernel."""
        content = parsed(read(state))
        if not isinstance(content, list) or len(content) != 4 or type(content[0]) is not int:
            raise damaged("it is no list of cycle, root, shapes and rows")
        next_cycle, root, shapes, rows = content
        require_lists(rows, shapes)
        if not is_part(root, ROW, len(rows)):
            raise damaged("its root is no row")
        with paused_collector():  # a sixth of the time
            found = Decoder(rows, shapes, self._roots, self.texts).decode(root)
        if not is_machine(found):
            raise damaged("its root does not hold units and their blocks")
        return MachineState(next_cycle, *found)


def together(states: Iterable[MachineState], machine: MachineParameters) -> MachineState:
    """The state of a machine of those of its units. Raises CncError 26151 where one is missing or of another cycle."""
    runners: dict[str, UnitRunner] = {}
    blocks: dict[str, CycleBlock] = {}
    cycles = set()
    for state in states:
        cycles.add(state.next_cycle)
        runners |= state.runners
        blocks |= state.blocks
    missing = ", ".join(name for name in unit_kinds(machine) if name not in (blocks if name == PLC else runners))
    if missing:
        raise damaged(f"it lacks {missing}")
    if len(cycles) != 1:
        raise damaged(f"its units are before the cycles {', '.join(map(str, sorted(cycles)))}")
    return MachineState(cycles.pop(), runners, blocks)


def parsed(content: bytes) -> Any:
    """Raises CncError 26151."""
    try:
        return json.loads(content)
    except (ValueError, RecursionError) as error:
        raise damaged(f"it is no JSON: {error}") from error


def is_machine(found: Any) -> bool:
    """Units and their blocks, by name."""
    if not isinstance(found, list) or len(found) != 2 or not all(isinstance(part, dict) for part in found):
        return False
    runners, blocks = found
    return all(isinstance(runner, UnitRunner) for runner in runners.values()) and all(
        isinstance(block, CycleBlock) for block in blocks.values()
    )


def interpreters(runners: Mapping[str, UnitRunner]) -> list[RunningBlocks]:
    """Of the programs that run."""
    units = [runner.unit for runner in runners.values()]
    found = [unit.interpreter for unit in units if isinstance(unit, ChannelUnit)]
    return [each for each in found if each is not None]


def read(state: bytes) -> bytes:
    """The JSON text of a state. Raises CncError 26151, 26152."""
    if len(state) < HEAD or state[:4] != MAGIC:
        raise damaged(f"its {len(state)} bytes do not begin as those of a state")
    layout = int.from_bytes(state[4:6], "little")
    if layout != LAYOUT:
        raise other_version(f"has layout {layout}, this version reads layout {LAYOUT}")
    rest = state[HEAD:]
    if check_sum(rest) != state[22:HEAD]:
        raise damaged("its check sum is wrong")
    if state[6:22] != kernel_digest():
        raise other_version("is that of a kernel with other sources")
    try:
        return zstandard.decompress(rest, max_output_size=LARGEST)
    except zstandard.ZstdError as error:
        raise damaged(str(error)) from error


def check_sum(content: bytes) -> bytes:
    return blake2b(content, digest_size=16).digest()


@cache
def kernel_digest() -> bytes:
    """Of all sources that decide what a state means, compiled or not."""
    together = json.dumps(hashes(sources()), sort_keys=True)
    return check_sum(together.encode())
