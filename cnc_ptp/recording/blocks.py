"""From unit blocks to arrays: blocks are packed when they arrive and turned into messages many at a time.

Packing a block is one `struct.pack` of all its numbers (3 µs for an axis): it copies them, and checks their number and
range. Rows packed alike become one array of per-cycle state messages and one of block messages.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from operator import attrgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, SpindleBlock
from cnc_ptp.recording.layout import Layout, Records, fixed_layout
from cnc_ptp.recording.schemas import PRIMITIVES, Schema, load_schema

OF_THE_BLOCK = ("modulo_begin", "modulo_length", "torque_digits")
"""Scalars of an AxisBlock from which its state messages have positions in the modulo range and digits of the drive."""
StateBlock = AxisBlock | SpindleBlock | ChannelBlock
ALL = slice(None)
Cycles = npt.NDArray[np.uint64]
Times = npt.NDArray[np.uint64]


class StateKind:
    """A kind of unit whose blocks hold one state message per cycle: `Axis`, `Spindle` or `Channel`."""

    def __init__(self, name: str) -> None:
        self.state = load_schema(f"cnc_ptp/msg/{name}State")
        self.block = load_schema(f"cnc_ptp/msg/{name}Block")
        self.layout = fixed_layout(self.state)
        names = [field.name for field in self.state.fields if field.name not in ("header", "cycle")]
        held = {field.name for field in self.block.fields}
        self.columns = tuple(name for name in names if name in held)
        self.derived = tuple(name for name in names if name not in held)
        """Fields of the state that follow from others of the block."""
        self._packers: dict[int, Packer] = {}

    def packer(self, count: int) -> Packer:
        """Packs what the state messages of a block of `count` cycles need."""
        if count not in self._packers:
            codes = {place.name: place.code for place in self.layout.places}
            columns = [(name, codes[name], count) for name in self.columns]
            scalars = [("first_cycle", "Q"), ("count", "I")]
            scalars += [(name, "d") for name in OF_THE_BLOCK] if self.derived else []
            self._packers[count] = Packer(scalars, columns)
        return self._packers[count]


@cache
def state_kind(name: str) -> StateKind:
    return StateKind(name)


def kind_of(block: StateBlock) -> StateKind:
    kind = _KINDS.get(type(block))
    if kind is None:
        kind = _KINDS[type(block)] = state_kind(type(block).__name__.removesuffix("Block"))
    return kind


_KINDS: dict[type, StateKind] = {}


class Packer:
    """Packs the numbers of blocks shaped like one block into rows of bytes; `dtype` describes a row."""

    def __init__(self, scalars: Sequence[tuple[str, str]], arrays: Sequence[tuple[str, str, int]]) -> None:
        codes = [code for _, code in scalars] + [f"{n}{code}" for _, code, n in arrays]
        self._struct = struct.Struct("<" + "".join(codes))
        self._scalars = _tuple_getter([name for name, _ in scalars])
        self._arrays = _tuple_getter([name for name, _, _ in arrays])
        formats = [(name, f"<{code}") for name, code in scalars]
        self.dtype = np.dtype(formats + [(name, f"<{code}", (n,)) for name, code, n in arrays])

    def pack(self, block: Any) -> bytes:
        """Raises CncError 26006 when the block holds another number of values or one beyond its field's range."""
        try:
            numbers = [*self._scalars(block)]
            for column in self._arrays(block):
                numbers += column
            return self._struct.pack(*numbers)
        except (struct.error, TypeError) as error:
            raise misfit(block, str(error)) from error

    def rows(self, packed: Iterable[bytes]) -> Records:
        return np.frombuffer(b"".join(packed), dtype=self.dtype)


def misfit(block: Any, reason: str) -> CncError:
    return CncError(
        26006,
        f"recording: {type(block).__name__} with first cycle {block.first_cycle}, count {block.count} does not fit its "
        f"message: {reason}",
        "it was not recorded",
    )


def require_shape(kind: StateKind, block: StateBlock) -> None:
    """Refuses blocks whose per-cycle fields do not hold `count` values, or whose setpoints differ in length."""
    setpoints = len(block.set_position) if isinstance(block, ChannelBlock) else 0
    for field in kind.block.fields:
        if field.length is None or field.type not in PRIMITIVES:
            continue
        count = len(getattr(block, field.name))
        if count != (block.count if field.name in kind.columns else setpoints):
            raise misfit(block, f"{field.name} holds {count} values")


class BlockLayout:
    """Layout and packer of block messages shaped like `prototype`."""

    def __init__(self, schema: Schema, prototype: Any) -> None:
        self.layout = Layout(schema, prototype)
        places = [place for place in self.layout.places if not place.name.startswith("header.")]
        self.packer = Packer(
            [(place.name, place.code) for place in places if place.count is None],
            [(place.name, place.code, place.count) for place in places if place.count is not None],
        )

    def fill(self, messages: Records, rows: Records, stamps_ns: Times) -> None:
        set_stamps(messages, stamps_ns)
        for name in self.packer.dtype.names or ():
            messages[name] = rows[name]


def cycles_of(rows: Records, count: int) -> Cycles:
    """Cycle numbers (n * count,) of packed rows (n,) of `count` cycles each."""
    cycles: Cycles = rows["first_cycle"][:, None] + np.arange(count, dtype=np.uint64)
    return cycles.reshape(-1)


def fill_states(kind: StateKind, messages: Records, rows: Records, cycles: Cycles, stamps_ns: Times) -> None:
    """Sets the state messages (n * count,) of packed rows (n,)."""
    set_stamps(messages, stamps_ns)
    messages["cycle"] = cycles
    for name in kind.columns:
        messages[name] = rows[name].reshape(-1)
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


def state_messages(block: StateBlock, start_ns: int, cycle_ns: int, wanted: slice = ALL) -> list[bytes]:
    """CDR of the `wanted` states of a block, cycle by cycle; `start_ns` is the stamp of cycle 0."""
    kind = kind_of(block)
    packer = kind.packer(block.count)
    rows = packer.rows([packer.pack(block)])
    messages = kind.layout.empty(block.count)
    cycles = cycles_of(rows, block.count)
    fill_states(kind, messages, rows, cycles, np.uint64(start_ns) + cycles * np.uint64(cycle_ns))
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


def _tuple_getter(names: Sequence[str]) -> Callable[[Any], tuple[Any, ...]]:
    if len(names) == 0:
        return lambda _block: ()
    if len(names) == 1:
        single = attrgetter(names[0])
        return lambda block: (single(block),)
    return attrgetter(*names)
