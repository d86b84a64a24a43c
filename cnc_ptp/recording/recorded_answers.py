"""What the PLC of a recording answered to channels and spindles, and how long after they had asked.

A changed run asks again, maybe at other times: the same request gets its answer after as many cycles as it did in the
recording. What the recording does not have is answered immediately.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

from cnc_ptp.protocol.blocks import (
    ChannelBlock,
    Command,
    CommandRecord,
    CycleBlock,
    HandshakeRequest,
    SpindleBlock,
    json_of,
)
from cnc_ptp.recording.run_inputs import RunInputs

CHANNEL_BLOCK, SPINDLE_BLOCK = "cnc_ptp/msg/ChannelBlock", "cnc_ptp/msg/SpindleBlock"
GEAR_CHANGED, COUPLING_ANSWER = "gear_changed", "coupling_answer"
IMMEDIATELY: Final = 0
Given = tuple[int, str, str, str]
"""Cycle, target, name and arguments of a command."""


class Asked(NamedTuple):
    """What was asked for, and the first cycle of the block that asked."""

    what: tuple[object, ...]
    first_cycle: int


class RecordedAnswers:
    """Requests of the recording from the block before `begin` on, with the delays of their answers in cycles.

    That block is the machine's, which need not be recorded. The others are read as far as the run has come, or as far
    as a request is looked for.
    """

    def __init__(self, recorded: RunInputs, begin: int) -> None:
        self._begin = begin
        self._channels = recorded.messages([CHANNEL_BLOCK], begin)
        self._spindles = recorded.messages([SPINDLE_BLOCK], begin)
        self._codec_of_channels, self._codec_of_spindles = recorded.codec(ChannelBlock), recorded.codec(SpindleBlock)
        self._channels_reached = self._spindles_reached = -1
        self._commands: Counter[Given] = Counter()
        """Those of the channels, which they give again."""
        self._requests: dict[int, Asked] = {}
        self._newest: dict[str, int] = defaultdict(int)
        """Number of the last request of each channel."""
        self._gears: dict[str, list[Asked]] = defaultdict(list)
        self._gear_waits: dict[str, int] = {}
        accepted = [record for record in recorded.commands if record.accepted]
        self._acknowledged = {
            Command.from_record(record).arguments["id"]: record.cycle
            for record in accepted
            if record.command == "acknowledge"
        }
        self._gears_changed: dict[str, list[int]] = defaultdict(list)
        for record in accepted:
            if record.command == GEAR_CHANGED:
                self._gears_changed[record.target].append(record.cycle)

    def take(self, blocks: Mapping[str, CycleBlock]) -> None:
        """The blocks before `begin`, by unit."""
        for name, block in blocks.items():
            if isinstance(block, ChannelBlock):
                self._note_requests(block)
            elif isinstance(block, SpindleBlock):
                self._note_gear(name, block)

    def gives(self, record: CommandRecord) -> bool:
        """A command that the changed run gives itself: of a channel, or an answer to what is asked for in it.

        To be asked once of each: of two equal ones in a cycle one may be of somebody else.
        """
        if record.cycle < self._begin:
            return False
        if record.command == COUPLING_ANSWER:
            return True
        if record.command == GEAR_CHANGED and record.accepted:
            self._read_spindles_to(record.cycle)
            return any(asked.first_cycle < record.cycle for asked in self._gears[record.target])
        self._read_channels_to(record.cycle)
        if record.command == "acknowledge":
            return record.accepted and Command.from_record(record).arguments["id"] in self._requests
        given = record.cycle, record.target, record.command, record.arguments_json
        self._commands[given] -= 1
        return self._commands[given] >= 0

    def acknowledged_after(self, request: HandshakeRequest, first_cycle: int) -> int | None:
        """Cycles from the block of a request, at `first_cycle`, to its acknowledgement; None: it never was."""
        self._read_channels_to(first_cycle)
        while self._newest[request.channel] < request.id and self._read_channels():
            pass
        asked = self._requests.get(request.id)
        if asked is None or asked.what != function_of(request):
            return IMMEDIATELY
        acknowledged = self._acknowledged.get(request.id)
        return None if acknowledged is None else acknowledged - asked.first_cycle

    def gear_changed_after(self, spindle: str, number: int, gear: int) -> int | None:
        """Cycles from the block of a spindle's gear change, its `number`th, to its answer; None: there was none."""
        while len(self._gears[spindle]) <= number and self._read_spindles():
            pass
        asked = self._gears[spindle][number] if number < len(self._gears[spindle]) else None
        if asked is None or asked.what != (gear,):
            return IMMEDIATELY
        answers = self._gears_changed[spindle]
        place = bisect_right(answers, asked.first_cycle)
        return answers[place] - asked.first_cycle if place < len(answers) else None

    def _read_channels_to(self, cycle: int) -> None:
        while self._channels_reached <= cycle and self._read_channels():
            pass

    def _read_spindles_to(self, cycle: int) -> None:
        while self._spindles_reached <= cycle and self._read_spindles():
            pass

    def _read_channels(self) -> bool:
        """One block; False behind the last one."""
        message = next(self._channels, None)
        if message is None:
            return False
        block = self._codec_of_channels.decode(message.cdr)
        self._channels_reached = block.first_cycle
        if block.first_cycle >= self._begin:
            self._note_requests(block)
            for command in block.commands:
                self._commands[block.first_cycle, command.target, command.command, json_of(command.arguments)] += 1
        return True

    def _read_spindles(self) -> bool:
        """The same for spindles."""
        message = next(self._spindles, None)
        if message is None:
            return False
        block = self._codec_of_spindles.decode(message.cdr)
        self._spindles_reached = block.first_cycle
        if block.first_cycle >= self._begin:
            self._note_gear(message.topic.removesuffix("/block").lstrip("/"), block)
        return True

    def _note_requests(self, block: ChannelBlock) -> None:
        for request in block.requests:
            self._requests[request.id] = Asked(function_of(request), block.first_cycle)
            self._newest[request.channel] = max(self._newest[request.channel], request.id)

    def _note_gear(self, name: str, block: SpindleBlock) -> None:
        if block.gear_request and not self._gear_waits.get(name):
            self._gears[name].append(Asked((block.gear_request,), block.first_cycle))
        self._gear_waits[name] = block.gear_request


class DelayedAnswers:
    """Answers the functions and gear changes of a run after the delays of a recording; one of `PlcUnit.outside`."""

    def __init__(self, recorded: RecordedAnswers) -> None:
        self._recorded = recorded
        self._waiting: dict[tuple[str, int], tuple[int, Command]] = {}
        """By unit and number: the cycle of the answer, and the answer."""
        self._gears: dict[str, int] = defaultdict(int)
        """Gear changes of each spindle so far."""
        self._gear_waits: dict[str, int] = {}

    def __call__(self, cycle: int, inputs: Mapping[str, CycleBlock]) -> Iterable[Command]:
        """What is due in the block that begins at `cycle`; `inputs`: the blocks before it."""
        for name, block in inputs.items():
            if isinstance(block, ChannelBlock):
                self._note_functions(name, block)
            elif isinstance(block, SpindleBlock):
                self._note_gear(name, block)
        due = [key for key, (at, _) in self._waiting.items() if at <= cycle]
        return [self._waiting.pop(key)[1] for key in due]

    def _note_functions(self, name: str, block: ChannelBlock) -> None:
        for request in block.requests:
            if request.acknowledge_needed:
                delay = self._recorded.acknowledged_after(request, block.first_cycle)
                self._wait(name, request.id, block, delay, Command(name, "acknowledge", {"id": request.id}))
        if block.done:
            self._forget(name)

    def _note_gear(self, name: str, block: SpindleBlock) -> None:
        if not block.gear_request:
            self._forget(name)
        elif not self._gear_waits.get(name):
            number = self._gears[name]
            self._gears[name] += 1
            delay = self._recorded.gear_changed_after(name, number, block.gear_request)
            self._wait(name, number, block, delay, Command(name, GEAR_CHANGED, {}))
        self._gear_waits[name] = block.gear_request

    def _wait(self, name: str, number: int, block: CycleBlock, delay: int | None, answer: Command) -> None:
        if delay is not None:
            self._waiting[name, number] = (block.first_cycle + delay, answer)

    def _forget(self, name: str) -> None:
        """A unit no longer waits."""
        for key in [key for key in self._waiting if key[0] == name]:
            del self._waiting[key]


def function_of(request: HandshakeRequest) -> tuple[object, ...]:
    """What a request is about: the same number may be that of another function in another program."""
    return (request.kind, request.spindle, request.number)
