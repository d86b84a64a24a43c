"""Recordings that begin and end while a machine runs, and snapshots of its last seconds, from memory.

A file has every block of every unit from a first to a last cycle. What was asked for is carried out when the blocks up
to its last cycle are there, and a moment later, because commands and events may come after the blocks of their cycle.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CommandRecord, CycleBlock, CycleTick, Event, Severity
from cnc_ptp.recording.memory import (
    BLOCK,
    RAW,
    TICK,
    History,
    Item,
    LastSeconds,
    LastStates,
    StatesOfUnits,
    write_record,
)
from cnc_ptp.recording.origin import COMPUTABLE_FROM, RECORD_WHEN, WITHOUT, origin
from cnc_ptp.recording.settings import Settings
from cnc_ptp.recording.trigger import Condition
from cnc_ptp.recording.writer import Recording
from cnc_ptp.recording.writing_place import require_new
from cnc_ptp.wire.block_codec import codec_of, head_of
from cnc_ptp.wire.stamps import Stamps

RECORDER = "recorder"
ENDED_EARLY = 26015
ALREADY_RECORDING = 26190
NOT_RECORDING = 26191
NOTHING_KEPT = 26193
SNAPSHOT_TAKEN = 26194
SNAPSHOT_FAILED = 26195
BAD_SECONDS = 26197
RECORDING_BEGUN = 26220
REFUSED = f"{RECORDER}: snapshot refused"
LONGEST = 86400.0
"""Seconds that may be asked for."""
NOT_CHANGED = "nothing was changed"
SETTLE = 0.2
"""Seconds after the last block in which commands and events of its cycles may still come."""
PATIENCE = 2.0
"""Seconds for the blocks of a unit that may be lost."""
AFTER = 0.5
"""Seconds of the machine behind an error or a trigger that its snapshot has."""
MARGIN = 1.0
"""Seconds that are kept beyond those that may be asked for, because a snapshot waits for its last block."""
MOST_SNAPSHOTS = 100
"""That a run takes automatically."""


@dataclass(frozen=True, slots=True)
class Answer:
    """To a start, a stop or a snapshot."""

    cycle: int = 0
    warning: str = ""
    error: CncError | None = None


Done = Callable[[Answer], None]


@dataclass(slots=True)
class Job:
    """Something that is carried out when all is there up to the cycle `end`, which it does not have."""

    end: int
    carry_out: Callable[[], Future[Answer]]
    done: Done
    deadline: float = math.inf
    """Set at the first look."""
    settled_at: float = math.inf


@dataclass(frozen=True, slots=True)
class Snapshots:
    """`keep`: seconds in memory. `folder`: for snapshots at errors, and when the condition `when` becomes true."""

    keep: float = 0.0
    folder: Path | None = None
    when: Condition | None = None


class Kept(NamedTuple):
    """What a snapshot has: commands and events, checkpoints with their texts, all else."""

    records: list[CommandRecord | Event]
    states: dict[int, StatesOfUnits]
    texts: dict[str, str]
    items: list[Item]

    def write(self, recording: Recording) -> None:
        for record in self.records:
            write_record(recording, record)
        write_states(recording, self.texts, self.states)
        for item in self.items:
            item.write(recording)


class OnDemand:
    """Takes what a recording takes; hands it on to the one that is being written, if any.

    Raises CncError of Recording.
    """

    def __init__(
        self,
        machine_yaml: str,
        stamps: Stamps,
        units: Iterable[str],
        *,
        current: Recording | None = None,
        first_cycle: int = 0,
        settings: Settings,
        snapshots: Snapshots,
        publish: Callable[[Event], None],
    ) -> None:
        """`current`: a recording from the start of the run on. `first_cycle`: of the first tick. `publish`: events."""
        self.stamps = stamps
        self.current = current
        self._machine_yaml, self._settings, self._snapshots = machine_yaml, settings, snapshots
        self._publish = publish
        self.failure: CncError | None = None
        """Why the recording ended that nobody has stopped."""
        self._first_cycle = first_cycle
        self._begin, self._end = 0, math.inf
        """Cycles that the present recording has."""
        self._next = dict.fromkeys(units, first_cycle)
        self._tick_end = self._tick_begin = first_cycle
        self._history = History()
        keeps = snapshots.keep > 0.0
        self._kept = LastSeconds(self._cycles(snapshots.keep + MARGIN)) if keeps else None
        self._states = LastStates(self._next)
        self._texts: dict[str, str] = {}
        """Long ones of states, by digest."""
        self._jobs: list[Job] = []
        self._writing: list[tuple[Future[Answer], Done]] = []
        self._writer = ThreadPoolExecutor(max_workers=1, thread_name_prefix="snapshot")
        self._taken_by_itself = 0
        self._covered = -1
        """Cycle up to which the last snapshot of its own goes."""
        self._held_before = True  # a condition that is true at the start has not become true

    # what a recording takes

    def tick(self, tick: CycleTick, scheduled_monotonic_ns: int = 0) -> None:
        self._tick_begin, self._tick_end = tick.first_cycle, tick.first_cycle + tick.count
        if self._kept is not None:
            self._kept.add(tick.first_cycle, 100, TICK, tick, scheduled_monotonic_ns)
        if self.current is not None and self._begin <= tick.first_cycle < self._end:
            self.current.tick(tick, scheduled_monotonic_ns)

    def block(self, name: str, block: CycleBlock, *, handshakes: bool = True) -> None:
        if self._kept is not None:
            self.encoded_block(name, type(block), codec_of(type(block)).encode(block, self.stamps))
            return
        self._next[name] = block.first_cycle + block.count
        if self.current is not None and self._begin <= block.first_cycle < self._end:
            self.current.block(name, block, handshakes=handshakes)

    def encoded_block(self, name: str, block_class: type, data: bytes) -> None:
        """`data` has a plain header (with_plain_header)."""
        _, cycle, count = head_of(data)
        self._next[name] = cycle + count
        if self._kept is not None:
            self._kept.add(cycle, len(data), BLOCK, name, block_class, data)
        if self.current is not None and self._begin <= cycle < self._end:
            self.current.encoded_block(name, block_class, data)
        when = self._snapshots.when
        if when is not None and when.unit == name:
            self._look_for(when.holds(codec_of(block_class).decode(data)), cycle)

    def event(self, event: Event) -> None:
        self._history.add(event)
        if self.current is not None and event.cycle < self._end:
            self.current.event(event)
        if event.severity == Severity.ERROR and event.source != RECORDER:
            self._snapshot_by_itself("error", event.cycle)

    def command(self, record: CommandRecord) -> None:
        self._history.add(record)
        if self.current is not None and record.cycle < self._end:
            self.current.command(record)

    def raw(self, topic: str, type_name: str, cdr: bytes, log_time_ns: int) -> None:
        if self._kept is not None:
            self._kept.add(self._tick_begin, len(cdr), RAW, topic, type_name, cdr, log_time_ns)
        if self.current is not None and self._tick_begin < self._end:
            self.current.raw(topic, type_name, cdr, log_time_ns)

    def checkpoint_texts(self, texts: Mapping[str, str]) -> None:
        """Long texts that states refer to, by digest."""
        self._texts |= texts

    def checkpoint(self, cycle: int, state: bytes, unit: str = "") -> None:
        """The state before `cycle`: of all units, or of `unit` as a part of it. Blocks may come a little later."""
        if cycle > self._newest + self._cycles(PATIENCE):
            return
        self._states.add(cycle, unit, state)
        oldest = math.inf if self._kept is None else self._kept.oldest
        self._states.forget(min(oldest, self._newest - self._cycles(PATIENCE)))
        if self.current is not None and self._begin <= cycle <= self._end:
            write_states(self.current, self._texts, {cycle: {unit: state}})

    def flush_if_due(self, now: float) -> None:
        """`now` in s of any steady clock."""
        if self.current is not None:
            self.current.flush_if_due(now)
        self.carry_out(now)

    def note_missing(self, what: str) -> None:
        """Of the present recording."""
        if self.current is not None:
            self.current.note_missing(what)

    def close(self) -> None:
        """Carries out what was asked for, with what is there, and closes the present recording."""
        self.carry_out(math.inf)
        try:
            if self.current is not None:
                self.current.close()
        finally:
            self._writer.shutdown()
            self._answer_written()

    # what is asked for

    def start(self, file: str) -> Answer:
        """Begins a recording with the next block. Raises CncError 26113, 26190, 26192."""
        refused = f"{RECORDER}: start refused"
        if self.current is not None:
            reason = f"recording {self.current.path} is being written"
            raise CncError(ALREADY_RECORDING, reason, NOT_CHANGED, where=refused)
        require_new(file, where=refused)
        begin = self._newest
        self.current = self._make(file, self._settings, begin, f"asked for, from cycle {begin} on")
        self.failure = None
        self._begin, self._end = begin, math.inf
        for record in self._history.before(begin):
            write_record(self.current, record)
        write_states(self.current, self._texts, self._states.between(begin, begin))
        text = f"{RECORDER}: recording {file} begins with cycle {begin}"
        self._publish(Event(begin, RECORDER, Severity.INFO, RECORDING_BEGUN, text))
        return Answer(begin)

    def stop(self, done: Done) -> None:
        """Ends the present recording. Raises CncError 26191, and 26007 of the one that could not be continued."""
        if self.failure is not None:
            failure, self.failure = self.failure, None
            raise failure
        if self.current is None or self._end != math.inf:
            why = "no recording is being written" if self.current is None else "the recording is ending already"
            raise CncError(NOT_RECORDING, why, NOT_CHANGED, where=f"{RECORDER}: stop refused")
        self._end = self._newest
        self._jobs.append(Job(self._newest, self._close_current, done))

    def snapshot(self, file: str, seconds: float, until: float, done: Done) -> None:
        """Writes the `seconds` before the time `until` of the machine.

        `seconds` 0 or NaN: all that is kept before it. `until` 0 or NaN: now.
        Raises CncError 26113, 26192, 26193, 26197.
        """
        seconds, until = (0.0 if math.isnan(each) else each for each in (seconds, until))
        if not 0.0 <= seconds <= LONGEST:
            reason = f"seconds = {seconds:g} is not within 0 ... {LONGEST:g} s"
            raise CncError(BAD_SECONDS, reason, NOT_CHANGED, where=REFUSED, seconds=seconds, high=LONGEST)
        if self._kept is None:
            reason = "nothing is kept in memory; `cnc_ptp run` keeps the last seconds with --keep"
            raise CncError(NOTHING_KEPT, reason, NOT_CHANGED, where=REFUSED)
        whole = self._kept.first_whole(self._next)
        if whole is None:
            raise CncError(NOTHING_KEPT, "no block of all units has come yet", NOT_CHANGED, where=REFUSED)
        if until:
            self._require_kept(until, whole)
        require_new(file, where=REFUSED)
        self._ask_for_snapshot(file, seconds, self._cycles(until) if until else self._newest, done)

    def _require_kept(self, until: float, whole: int) -> None:
        """Raises CncError 26197 where no cycle from `whole` on is before `until`, or it is in the future."""
        low, high, half = (cycles * self.stamps.cycle_time_ns * 1e-9 for cycles in (whole + 1, self._newest, 0.5))
        if not low - half < until < high + half:
            reason = f"until = {until:.10g} is not within {low:.10g} ... {high:.10g} s, which are kept"
            raise CncError(BAD_SECONDS, reason, NOT_CHANGED, where=REFUSED, until=until, low=low, high=high)

    def fail(self, error: CncError, cycle: int) -> None:
        """The present recording could not be written: it gets its end, if there is room for it; tells so."""
        self.failure = error
        with suppress(CncError):
            self._end_current()
        text = f"{RECORDER}: {error.reason}; the run continues without it, about cycle {cycle} and later are missing"
        self._publish(Event(cycle, RECORDER, Severity.ERROR, ENDED_EARLY, text))

    def _end_current(self) -> None:
        ended, self.current = self.current, None
        if ended is not None:
            ended.close()

    # automatic snapshots

    def _look_for(self, holds: bool, cycle: int) -> None:
        if holds and not self._held_before:
            self._snapshot_by_itself("trigger", cycle)
        self._held_before = holds

    def _snapshot_by_itself(self, why: str, cycle: int) -> None:
        """Unless the last one has this cycle."""
        folder = self._snapshots.folder
        if folder is None or cycle < self._covered or self._taken_by_itself == MOST_SNAPSHOTS:
            return
        self._taken_by_itself += 1
        self._covered = cycle + self._cycles(AFTER)
        file = free_name(folder, f"{why}_{cycle}")
        self._ask_for_snapshot(
            str(file), self._snapshots.keep + AFTER, self._covered, lambda answer: self._tell(file, answer)
        )

    def _tell(self, file: Path, answer: Answer) -> None:
        if answer.error is None:
            text = f"{RECORDER}: snapshot {file} has cycles from {answer.cycle} on"
            self._publish(Event(self._tick_begin, RECORDER, Severity.INFO, SNAPSHOT_TAKEN, text))
        else:
            text = f"{RECORDER}: snapshot {file} was not taken: {answer.error.reason}; the run continues"
            self._publish(Event(self._tick_begin, RECORDER, Severity.WARNING, SNAPSHOT_FAILED, text))

    # carrying out

    def _ask_for_snapshot(self, file: str, seconds: float, until: int, done: Done) -> None:
        def carry_out() -> Future[Answer]:
            return self._write_snapshot(file, seconds, min(until, self._newest))

        self._jobs.append(Job(until, carry_out, done))

    def carry_out(self, now: float) -> None:
        """What is due of what was asked for; `now` as of flush_if_due."""
        for job in [*self._jobs]:
            if self._is_due(job, now):
                self._jobs.remove(job)
                self._writing.append((job.carry_out(), job.done))
        self._answer_written()

    def settle(self, now: float) -> None:
        """Everything has come up to now: carries out at once what waits for no later cycle, to its end."""
        for job in self._jobs:
            if job.end <= self._newest:
                job.settled_at = now
        self.carry_out(now)
        wait([future for future, _ in self._writing])
        self._answer_written()

    def _is_due(self, job: Job, now: float) -> bool:
        if job.deadline == math.inf:
            job.deadline = now + PATIENCE + max(0, job.end - self._newest) * self.stamps.cycle_time_ns * 1e-9
        if job.settled_at == math.inf and min(self._next.values()) >= job.end:
            job.settled_at = now + SETTLE
        return now >= min(job.settled_at, job.deadline)

    def _answer_written(self) -> None:
        for future, done in [*self._writing]:
            if future.done():
                self._writing.remove((future, done))
                done(future.result())

    def _close_current(self) -> Future[Answer]:
        """At once: whoever starts the next one must find this one closed."""
        try:
            self._end_current()
        except CncError as error:
            return known(Answer(error=error))
        return known(Answer(int(self._end)))

    def _write_snapshot(self, file: str, seconds: float, until: int) -> Future[Answer]:
        """In a thread of its own: in one process with all other nodes nothing may wait for it."""
        assert self._kept is not None
        whole = self._kept.first_whole(self._next) or 0
        try:
            self._require_kept(until * self.stamps.cycle_time_ns * 1e-9, whole)  # since it was asked for, some has gone
        except CncError as error:
            return known(Answer(error=error))
        wanted = self._kept.begin_of_block(until - self._cycles(seconds or self._snapshots.keep))
        begin, end = max(wanted, whole), self._kept.end_of_block(until, self._newest)
        states = self._states.between(begin, end)
        kept = Kept(self._history.before(end), states, dict(self._texts), self._kept.between(begin, end))
        warning = ""
        if seconds and wanted < whole:
            duration = (end - begin) * self.stamps.cycle_time_ns * 1e-9
            warning = f"{RECORDER}: {duration:g} s were kept and are in the snapshot, {seconds:g} s were asked for"
        return self._writer.submit(self._write_kept, file, begin, end, kept, warning)

    def _write_kept(self, file: str, begin: int, end: int, kept: Kept, warning: str) -> Answer:
        try:
            settings = Settings(self._settings.compression, files=self._settings.files)
            with self._make(file, settings, begin, f"snapshot of cycles {begin} to {end - 1}") as recording:
                kept.write(recording)
        except CncError as error:
            return Answer(error=error)
        return Answer(begin, warning)

    def _make(self, file: str, settings: Settings, begin: int, when: str) -> Recording:
        notes = {**origin(), RECORD_WHEN: when, **without_what(self._first_cycle, self._history.forgotten)}
        return Recording(
            file, self._machine_yaml, self.stamps.start_ns, self.stamps.cycle_time_ns, notes=notes, settings=settings
        )

    @property
    def _newest(self) -> int:
        """The cycle with which the next block begins: no unit has come further."""
        return max(self._tick_end, *self._next.values())

    def _cycles(self, seconds: float) -> int:
        return round(seconds * 1e9 / self.stamps.cycle_time_ns)


def known(answer: Answer) -> Future[Answer]:
    """That need not be waited for."""
    future: Future[Answer] = Future()
    future.set_result(answer)
    return future


def begun_file(error_id: int, text: str) -> str:
    """The file or folder of a recording on demand, of the event that it has begun; empty of all other events."""
    begun = re.fullmatch(rf"{RECORDER}: recording (.+) begins with cycle \d+", text, re.DOTALL)
    return begun[1] if begun is not None and error_id == RECORDING_BEGUN else ""


def write_states(recording: Recording, texts: Mapping[str, str], states: Mapping[int, StatesOfUnits]) -> None:
    """Checkpoints by their cycles, and the long texts that they refer to."""
    if states:
        recording.checkpoint_texts(texts)
    for cycle, of_units in states.items():
        for unit, state in of_units.items():
            recording.checkpoint(cycle, state, unit)


def without_what(first_cycle: int, forgotten: int = -1) -> dict[str, str]:
    """For the metadata: why a run cannot be computed again from 0 if it cannot, and from which cycle on it can."""
    if first_cycle <= 0 and forgotten < 0:
        return {}
    why = f"commands up to cycle {forgotten} were forgotten before it began, there were too many"
    if first_cycle > forgotten:
        why = f"the recorder came at cycle {first_cycle}, commands before it are not recorded"
    return {WITHOUT: why, COMPUTABLE_FROM: str(max(first_cycle, forgotten + 1))}


def free_name(folder: Path, stem: str) -> Path:
    """`stem.mcap`, or with a number where that exists."""
    file, number = folder / f"{stem}.mcap", 0
    while file.exists():
        number += 1
        file = folder / f"{stem}_{number}.mcap"
    return file
