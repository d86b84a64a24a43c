"""Compares a recording with a second computation of the same run, bit for bit.

The kernel is re-run from the machine file and the commands of the recording (`cnc_ptp.machine` does that); here every
field of every per-cycle state is compared. Numbers are equal when their bits are: NaN equals the same NaN, 0.0 differs
from -0.0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import ChannelBlock, CycleBlock, PlcBlock
from cnc_ptp.recording.blocks import Cycles, StateBlock, StateKind, block_rows, fill_states, kind_of, thread_kind
from cnc_ptp.recording.origin import RECORD_WHEN, require_computable
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.stored_states import (
    Interval,
    StoredRecording,
    StoredStates,
    cycles_of,
    intervals_of,
    joined_intervals,
    without,
)
from cnc_ptp.recording.writer import topic_of
from cnc_ptp.wire.block_codec import codec_of
from cnc_ptp.wire.layout import Layout, Records
from cnc_ptp.wire.stamps import Stamps

NOT_VERIFIABLE = 26004
Replay = Callable[[Recorded], Iterable[tuple[str, CycleBlock]]]
BATCH_BLOCKS = 500
FIRST_DIFFERENCES = 20


@dataclass(frozen=True, slots=True, order=True)
class Difference:
    """A sample that was not computed as it was recorded."""

    cycle: int
    topic: str
    field: str
    recorded: float
    computed: float

    def __str__(self) -> str:
        recorded, computed = repr(self.recorded), repr(self.computed)
        if recorded == computed:  # NaNs with different bits
            recorded, computed = (
                f"{text} (0x{_bits(value):016x})"
                for text, value in ((recorded, self.recorded), (computed, self.computed))
            )
        return f"{self.topic} cycle {self.cycle} {self.field}: recorded {recorded}, computed {computed}"


@dataclass(slots=True)
class TopicResult:
    """Result of the comparison of one topic.

    `missing`: cycles that were computed but not recorded; `duplicated`: recorded more than once; `surplus`: recorded
    but not computed. `not_recorded`: fields that are computed here and that the recording does not have.
    """

    topic: str
    compared: int = 0
    differences: int = 0
    first: list[Difference] = field(default_factory=list)
    missing: list[int] = field(default_factory=list)
    duplicated: list[int] = field(default_factory=list)
    surplus: list[int] = field(default_factory=list)
    not_recorded: list[str] = field(default_factory=list)

    @property
    def equal(self) -> bool:
        return not (self.differences or self.missing or self.duplicated or self.surplus)

    def lines(self) -> list[str]:
        lines = [str(difference) for difference in self.first]
        if self.differences > len(self.first):
            lines.append(f"{self.topic}: {self.differences - len(self.first)} further differences")
        for what, cycles in (
            ("missing", self.missing),
            ("recorded twice", self.duplicated),
            ("not computed", self.surplus),
        ):
            if cycles:
                lines.append(f"{self.topic}: {len(cycles)} cycles {what}: {ranges_text(cycles)}")
        return lines


@dataclass(slots=True)
class VerifyResult:
    """Result of the comparison of a recording, by topic."""

    path: str
    topics: dict[str, TopicResult]

    @property
    def equal(self) -> bool:
        return bool(self.topics) and all(result.equal for result in self.topics.values())

    @property
    def compared(self) -> int:
        return sum(result.compared for result in self.topics.values())

    @property
    def differences(self) -> int:
        return sum(result.differences for result in self.topics.values())

    @property
    def first(self) -> list[Difference]:
        """The earliest differences of all topics, in the order of their cycles."""
        return sorted(difference for result in self.topics.values() for difference in result.first)[:FIRST_DIFFERENCES]

    def text(self) -> str:
        """One line if all is equal, otherwise one for each finding."""
        if self.equal:
            equal = f"{self.path}: {self.compared} states of {len(self.topics)} topics are equal to the bit"
            return "\n".join([equal, *self._not_compared()])
        if not self.topics:
            return f"{self.path}: holds no per-cycle states, nothing could be compared"
        findings = [line for result in self.topics.values() for line in result.lines()]
        found = f"{self.path}: {self.differences} differences in {self.compared} states"
        return "\n".join([found, *findings, *self._not_compared()])

    def _not_compared(self) -> Iterator[str]:
        """A line for each set of fields that an older version has not recorded."""
        topics: dict[str, list[str]] = {}
        for result in self.topics.values():
            if result.not_recorded:
                topics.setdefault(", ".join(result.not_recorded), []).append(result.topic)
        for fields, names in topics.items():
            yield f"note: recorded without {fields} ({', '.join(names)}): not compared"


def verify(recorded: Recorded, replay: Replay) -> VerifyResult:
    """Compares the recorded states with what `replay(recorded)` computes: pairs of unit name (or topic) and block.

    PLC blocks among them are passed over, they have no per-cycle states.
    An older recording may lack fields or threads that are computed today: what it has is compared, the result names
    the others. Raises CncError 26004 when the recording has no machine file or its states have fields that are not
    computed here. Of a file that was cut off, cycles after the last recorded one are not counted as missing.
    """
    if not recorded.machine_yaml:
        raise CncError(
            NOT_VERIFIABLE,
            f"recording {recorded.path}: holds no attachment machine.yaml",
            "it cannot be verified, record it with cnc_ptp",
        )
    require_computable(recorded.path, recorded.metadata)
    checks = {topic: _Check(topic, states, recorded) for topic, states in stored_states(recorded).items()}
    lacking: set[str] = set()
    for name, block in replay(recorded):
        if isinstance(block, PlcBlock):
            continue
        topic = state_topic(name)
        if topic not in checks:
            checks[topic] = _Check(topic, None, recorded)
        checks[topic].add(block, kind_of(type(block)))
        if isinstance(block, ChannelBlock) and block.thread_lead:
            check = checks.get(topic_of(topic.removesuffix("/state"), "thread"))
            if check is None:
                lacking.add(topic)
            else:
                check.add(block, thread_kind())
    results = {topic: check.finish() for topic, check in checks.items()}
    for topic in lacking:
        results[topic].not_recorded.append(topic_of(topic.removesuffix("/state"), "thread"))
    return VerifyResult(str(recorded.path), results)


def stored_states(recorded: Recorded) -> dict[str, StoredStates]:
    """Those of units and threads by topic, wherever they are."""
    if isinstance(recorded, StoredRecording):
        return recorded.stored | recorded.stored_threads
    rows = recorded.states | {topic_of(name, "thread"): rows for name, rows in recorded.threads.items()}
    return {topic: StoredStates.of_rows(each) for topic, each in rows.items()}


def state_topic(name: str) -> str:
    """`x`, `/x/block` or `/x/state` -> `/x/state`."""
    return topic_of(name.removesuffix("/block").removesuffix("/state"), "state")


class _Check:
    """Compares the states of one topic batch by batch."""

    def __init__(self, topic: str, states: StoredStates | None, recorded: Recorded) -> None:
        self.result = TopicResult(topic)
        self.recorded = recorded
        self.stamps = Stamps(recorded.start_ns, recorded.cycle_time_ns)
        self.states = states
        if states is not None:
            self.result.duplicated = cycles_of(states.repeated())
        self.computed: list[Interval] = []
        self.batch: list[bytes] = []
        self.form: tuple[StateKind, Layout] | None = None

    def add(self, block: StateBlock, states: StateKind) -> None:
        """`states`: which ones of the block."""
        codec = codec_of(type(block))
        data = codec.encode(block, self.stamps)
        layout = codec.layout(data)
        if self.form is None or self.form[1] is not layout:
            self.compare_batch()
            self.form = states, layout
            self.require_fields(self.form[0])
        self.batch.append(data)
        if len(self.batch) >= BATCH_BLOCKS:
            self.compare_batch()

    def finish(self) -> TopicResult:
        self.compare_batch()
        if self.states is not None:
            self.result.surplus = cycles_of(without(self.states.intervals(), self.computed))
        return self.result

    def require_fields(self, kind: StateKind) -> None:
        if self.states is None:
            return
        recorded, computed = self.states.dtype.names or (), kind.layout.dtype.names or ()
        if unknown := [name for name in recorded if name not in computed]:
            raise CncError(
                NOT_VERIFIABLE,
                f"recording {self.recorded.path}: {self.result.topic} has the fields {', '.join(unknown)}, which this "
                "version does not compute",
                "it cannot be verified, use the version that recorded it",
            )
        self.result.not_recorded = [name for name in computed if name not in recorded]

    def compare_batch(self) -> None:
        if self.form is None or not self.batch:
            return
        kind, layout = self.form
        rows, self.batch = block_rows(self.batch, layout), []
        cycles = kind.cycles(rows)
        computed = np.zeros(len(cycles), dtype=kind.layout.dtype)
        computed["cycle"] = cycles
        fill_states(kind, computed, rows, cycles, self.stamps.at_all(cycles))
        self.compare(computed[np.argsort(cycles, kind="stable")])

    def compare(self, computed: Records) -> None:
        """`computed`: rows in the order of their cycles."""
        cycles: Cycles = computed["cycle"]
        self.computed = [*joined_intervals(sorted(chain(self.computed, intervals_of(cycles))))]
        recorded = None if self.states is None else self.states.rows(int(cycles[0]), int(cycles[-1]))
        here = cycles[:0] if recorded is None else recorded["cycle"]
        partner = np.minimum(np.searchsorted(cycles, here), len(cycles) - 1)
        matched = np.flatnonzero(cycles[partner] == here)
        self.note_missing(cycles[~np.isin(cycles, here)])
        self.result.compared += len(matched)
        if recorded is not None and len(matched):
            self.compare_rows(recorded[matched], computed[partner[matched]])

    def note_missing(self, cycles: Cycles) -> None:
        """Not those before a trigger, and behind the end of a file that was cut off."""
        if RECORD_WHEN in self.recorded.metadata:
            first = self.states.first if self.states else np.iinfo(np.int64).max
            cycles = cycles[cycles.astype(np.int64) >= first]
        if not self.recorded.complete:
            last = self.states.last if self.states else -1
            cycles = cycles[cycles.astype(np.int64) <= last]
        self.result.missing.extend(cycles.tolist())

    def compare_rows(self, recorded: Records, computed: Records) -> None:
        found: list[Difference] = []
        for name in recorded.dtype.names or ():
            places = np.flatnonzero(_as_bits(recorded[name]) != _as_bits(computed[name]))
            self.result.differences += len(places)
            found += [
                Difference(
                    int(computed["cycle"][place]),
                    self.result.topic,
                    name,
                    recorded[name][place].item(),
                    computed[name][place].item(),
                )
                for place in places[:FIRST_DIFFERENCES]
            ]
        self.result.first = sorted([*self.result.first, *found], key=lambda difference: difference.cycle)[
            :FIRST_DIFFERENCES
        ]


def ranges_text(numbers: list[int], most: int = 5) -> str:
    """`3-5, 9, 12-20, …`"""
    ranges: list[list[int]] = []
    for number in sorted(numbers):
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    texts = [str(first) if first == last else f"{first}-{last}" for first, last in ranges[:most]]
    return ", ".join(texts + ["…"] * (len(ranges) > most))


def _as_bits(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return np.ascontiguousarray(values).view(f"u{values.dtype.itemsize}")


def _bits(value: float) -> int:
    return int(np.float64(value).view(np.uint64))
