"""From the bytes of unit blocks to arrays: many blocks of one form become their per-cycle state messages at once."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np
import numpy.typing as npt

from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, SpindleBlock
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.layout import Layout, Records, fixed_layout
from cnc_ptp.wire.schemas import load_schema
from cnc_ptp.wire.stamps import Stamps, Times

OF_THE_BLOCK = ("modulo_begin", "modulo_length", "torque_digits")
"""Scalars of an AxisBlock from which its state messages have positions in the modulo range and digits of the drive."""
THREAD = "thread_"
"""Begin of the fields of a ChannelBlock that are those of ThreadState."""
StateBlock = AxisBlock | SpindleBlock | ChannelBlock
ALL = slice(None)
Cycles = npt.NDArray[np.uint64]


class StateKind:
    """A kind of unit whose blocks hold one state message per cycle: `Axis`, `Spindle` or `Channel`."""

    leaf = "state"
    """Last part of their topic."""

    def __init__(self, name: str) -> None:
        self.state = load_schema(f"cnc_ptp/msg/{name}State")
        self.layout = fixed_layout(self.state)
        names = [field.name for field in self.state.fields if field.name not in ("header", "cycle")]
        held = {field.name for field in load_schema(f"cnc_ptp/msg/{name}Block").fields}
        self.columns = {name: name for name in names if name in held}
        """Field of the state -> field of the block."""
        self.derived = tuple(name for name in names if name not in held)
        """Fields of the state that follow from others of the block."""

    def cycles(self, rows: Records) -> Cycles:
        """Of the states in blocks (n,)."""
        return cycles_of(rows)


class ThreadKind(StateKind):
    """The states of threads, which a channel's block holds of the cycles before it."""

    leaf = "thread"

    def __init__(self) -> None:
        self.state = load_schema("cnc_ptp/msg/ThreadState")
        self.layout = fixed_layout(self.state)
        names = [field.name for field in self.state.fields if field.name not in ("header", "cycle")]
        self.columns = {name: THREAD + name for name in names}
        self.derived = ()

    def cycles(self, rows: Records) -> Cycles:
        return cycles_before(rows, rows[f"{THREAD}lead"].shape[1])


_KINDS: dict[type, StateKind] = {}


def kind_of(block_class: type) -> StateKind:
    kind = _KINDS.get(block_class)
    if kind is None:
        kind = _KINDS[block_class] = StateKind(block_class.__name__.removesuffix("Block"))
    return kind


@cache
def thread_kind() -> ThreadKind:
    return ThreadKind()


def kinds_in(block_class: type, layout: Layout) -> list[StateKind]:
    """What blocks of this layout hold states of."""
    kinds = [kind_of(block_class)]
    return [*kinds, thread_kind()] if f"{THREAD}lead" in (layout.dtype.names or ()) else kinds


def block_rows(blocks: Iterable[bytes], layout: Layout) -> Records:
    """Messages of blocks that have this layout as an array (n,)."""
    return np.frombuffer(b"".join(blocks), dtype=layout.dtype)


def cycles_of(rows: Records) -> Cycles:
    """Cycle numbers (n * count,) of blocks (n,) of `count` cycles each."""
    cycles: Cycles = rows["first_cycle"][:, None] + np.arange(rows["count"][0], dtype=np.uint64)
    return cycles.reshape(-1)


def cycles_before(rows: Records, count: int) -> Cycles:
    """Numbers (n * count,) of the `count` cycles before each of the blocks (n,)."""
    cycles: Cycles = rows["first_cycle"][:, None] - np.arange(count, 0, -1, dtype=np.uint64)
    return cycles.reshape(-1)


def fill_states(kind: StateKind, messages: Records, rows: Records, cycles: Cycles, stamps_ns: Times) -> None:
    """Sets the state messages (n * count,) of blocks (n,)."""
    set_stamps(messages, stamps_ns)
    messages["cycle"] = cycles
    for name, column in kind.columns.items():
        messages[name] = rows[column].reshape(-1)
    if kind.derived:
        fill_derived(messages, rows)


@np.errstate(invalid="ignore")
def fill_derived(messages: Records, rows: Records) -> None:
    """Sets the fields that follow from the others; infinities and NaN are unchanged, NaN has direction 0."""
    count = rows["set_position"].shape[1]
    begin, length, digits = (np.repeat(rows[name], count) for name in OF_THE_BLOCK)
    for name in ("set_position", "actual_position"):
        messages[f"{name}_modulo"] = within_modulo(messages[name], begin, length)
    messages["actual_torque_digits"] = messages["actual_torque"] * digits
    velocity = messages["set_velocity"]
    messages["set_direction"] = (velocity > 0.0).astype(np.int8) - (velocity < 0.0)


def state_messages(block: StateBlock, stamps: Stamps, wanted: slice = ALL) -> list[bytes]:
    """CDR of the `wanted` states of a block, cycle by cycle."""
    codec, kind = codec_of(type(block)), kind_of(type(block))
    data = codec.encode(block, stamps)
    rows = block_rows([data], codec.layout(data))
    messages = kind.layout.empty(block.count)
    cycles = cycles_of(rows)
    fill_states(kind, messages, rows, cycles, stamps.at_all(cycles))
    return [message.tobytes() for message in messages[wanted]]


def within_modulo(
    position: npt.NDArray[np.float64], begin: npt.NDArray[np.float64], length: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Positions within begin ... begin + length (excluded); the position itself if the length is 0. Shapes (n,)."""
    turn = np.where(length > 0.0, length, 1.0)
    within = begin + np.mod(position - begin, turn)
    within = np.where(within >= begin + turn, begin, within)  # a tiny negative remainder rounds up to a whole turn
    return np.where(length > 0.0, within, position)


def set_stamps(messages: Records, stamps_ns: Times) -> None:
    seconds, nanoseconds = np.divmod(stamps_ns, np.uint64(1_000_000_000))
    messages["header.stamp.sec"] = seconds
    messages["header.stamp.nanosec"] = nanoseconds
