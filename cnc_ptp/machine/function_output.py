"""M, S, T and D functions of a block: what goes out to spindles and PLC, when, and what the path waits for.

Synchronisation types: TF5200 spindle 2.5. Before the motion go MOS, MVS_SVS and MVS_SNS, after it MNS_SNS; the path
waits before the motion for MVS_SVS, at the block's end for MVS_SNS and MNS_SNS, never for MOS. Priority M3/M4/M5 > S.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field

from cnc_ptp.machine.blocks import Block, Command, HandshakeRequest, SpindleBlock
from cnc_ptp.machine.control_functions import control_commands, reset_commands
from cnc_ptp.nc.canonical import AuxiliaryFunction, CanonicalBlock, ControlFunction, Function, SpindleFunction
from cnc_ptp.parameters import ChannelParameters, ChannelSpindle, Synchronisation

AFTER_MOTION = Synchronisation.MNS_SNS
LATE = Synchronisation.MVS_SLM | Synchronisation.MVS_SLP | Synchronisation.MNE_SNS
"""Types that wait later than they do here: until these are built, the path waits before the motion."""
WAIT_BEFORE = Synchronisation.MVS_SVS | LATE
WAIT_AFTER = Synchronisation.MVS_SNS | Synchronisation.MNS_SNS
TYPES = WAIT_BEFORE | WAIT_AFTER | Synchronisation.MOS
DIRECTIONS = {3: "cw", 4: "ccw"}


@dataclass(slots=True)
class Wait:
    """Something the path waits for: a spindle's speed and, or, the PLC's acknowledgement of request `request_id`."""

    spindle: str = ""
    request_id: int = 0
    sent_cycle: int | None = None
    """First cycle of the block in which the function went out; what was reported for earlier cycles does not count."""

    def fulfilled(self, cycle: int, spindles: Mapping[str, Block], open_requests: set[int]) -> bool:
        if self.sent_cycle is None or cycle <= self.sent_cycle or self.request_id in open_requests:
            return False
        block = spindles.get(self.spindle)
        return not self.spindle or (isinstance(block, SpindleBlock) and block.speed_reached[-1])

    def text(self, open_requests: set[int]) -> str:
        """What is waited for; empty before the function has gone out."""
        if self.sent_cycle is None:
            return ""
        if self.request_id in open_requests:
            return f"the acknowledgement of request {self.request_id}"
        return f"the speed of spindle {self.spindle}" if self.spindle else ""


@dataclass(slots=True)
class Outputs:
    """What is to go out at one moment of a block, and the waits that belong to it."""

    commands: list[Command] = field(default_factory=list)
    requests: list[HandshakeRequest] = field(default_factory=list)
    waits_before: list[Wait] = field(default_factory=list)
    waits_after: list[Wait] = field(default_factory=list)


class FunctionOutput:
    """Turns the functions of canonical blocks into spindle commands, handshake requests and waits."""

    def __init__(self, channel: ChannelParameters, request_numbers: Iterator[int]) -> None:
        self._channel = channel
        self._spindles = {spindle.name: spindle for spindle in channel.spindles}
        self._directions: dict[str, str] = {}
        self._request_numbers = request_numbers

    def of_block(self, block: CanonicalBlock, *, after_motion: bool) -> Outputs:
        """The functions of `block` that go out before, or after, its motion."""
        outputs = Outputs()
        for function in block.before + block.after:
            synchronisation = self._synchronisation(function)
            if bool(synchronisation & AFTER_MOTION) == after_motion:
                self._output(function, synchronisation, block, outputs)
        return outputs

    def at_program_start(self) -> list[Command]:
        """What a program start sets back to its initial state."""
        return reset_commands(self._channel)

    def stop_spindles(self, keep: Container[str] = ()) -> list[Command]:
        """M05 for every spindle that the channel has set turning, except the nodes in `keep`."""
        stopped = [name for name in self._directions if self._spindles[name].node not in keep]
        for name in stopped:
            del self._directions[name]
        return [Command(self._spindles[name].node, "stop", {}) for name in stopped]

    def _synchronisation(self, function: Function) -> Synchronisation:
        if isinstance(function, ControlFunction):
            return Synchronisation.NO_SYNCH
        if isinstance(function, AuxiliaryFunction):
            return self._channel.m_functions[function.number] if function.letter == "M" else Synchronisation.MOS
        spindle = self._spindles[function.spindle]
        return {3: spindle.m3, 4: spindle.m4, 5: spindle.m5, None: spindle.s}[function.m]

    def _output(
        self, function: Function, synchronisation: Synchronisation, block: CanonicalBlock, outputs: Outputs
    ) -> None:
        if isinstance(function, SpindleFunction):
            self._spindle_function(function, self._spindles[function.spindle], synchronisation, block, outputs)
        elif isinstance(function, ControlFunction):
            outputs.commands += control_commands(self._channel, function)
        elif synchronisation & TYPES:
            waits = bool(synchronisation & (WAIT_BEFORE | WAIT_AFTER))
            request = self._request(block, function.letter, "", function.number, 0.0, waits)
            outputs.requests.append(request)
            if waits:
                add_wait(outputs, synchronisation, Wait(request_id=request.id))

    def _spindle_function(
        self,
        function: SpindleFunction,
        spindle: ChannelSpindle,
        synchronisation: Synchronisation,
        block: CanonicalBlock,
        outputs: Outputs,
    ) -> None:
        command = self._spindle_command(function, spindle)
        if command is None:
            return
        outputs.commands.append(command)
        wait = Wait(spindle=spindle.node)
        waits = bool(synchronisation & (WAIT_BEFORE | WAIT_AFTER))
        if synchronisation & Synchronisation.PLC_INFO:
            kind, number = ("S", 0) if function.m is None else ("M", function.m)
            request = self._request(block, kind, spindle.node, number, function.speed_rpm or 0.0, waits)
            outputs.requests.append(request)
            wait.request_id = request.id if waits else 0
        if waits:
            add_wait(outputs, synchronisation, wait)

    def _spindle_command(self, function: SpindleFunction, spindle: ChannelSpindle) -> Command | None:
        """The command for the spindle; None for an S word while it stands (the speed counts for the next M3 or M4)."""
        if function.m == 5:
            self._directions.pop(function.spindle, None)
            return Command(spindle.node, "stop", {})
        if function.m is not None:
            self._directions[function.spindle] = DIRECTIONS[function.m]
        direction = self._directions.get(function.spindle)
        if direction is None or function.speed_rpm is None:
            return None
        if function.m is None:
            return Command(spindle.node, "set_speed", {"speed_rpm": function.speed_rpm})
        return Command(spindle.node, "start", {"direction": direction, "speed_rpm": function.speed_rpm})

    def _request(
        self, block: CanonicalBlock, kind: str, spindle: str, number: int, value: float, waits: bool
    ) -> HandshakeRequest:
        request_id = next(self._request_numbers)
        return HandshakeRequest(
            0, request_id, self._channel.name, kind, spindle, number, value, block.source.line, waits
        )


def add_wait(outputs: Outputs, synchronisation: Synchronisation, wait: Wait) -> None:
    """Files a wait under the moment at which its synchronisation type makes the path wait."""
    (outputs.waits_before if synchronisation & WAIT_BEFORE else outputs.waits_after).append(wait)
