"""M, S, T and D functions of a block: what goes out to spindles and PLC, when, and what the path waits for.

Synchronisation types: TF5200 spindle 2.5. Before the motion go all types but MNS_SNS (after it) and MNE_SNS (with the
measuring event). The path waits before the motion for MVS_SVS, at the block's end for MVS_SNS, MNS_SNS and MNE_SNS,
before the next G01, G02, G03 for MVS_SLM, at the next #EXPL SYN for MVS_SLP, never for MOS. In one block M19 decides
before M3, M4, M5, and these before S. Feedforward and compensations of axes act from the begin of the next motion on.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from enum import Enum

from cnc_ptp.channel.control_functions import control_commands, reset_commands
from cnc_ptp.channel.spindle_output import SpindleOutput
from cnc_ptp.channel.waits import AFTER_MOTION, ON_EVENT, OUTPUT, WAIT_BEFORE, WAITING, Outputs, Wait
from cnc_ptp.nc.canonical import (
    AuxiliaryFunction,
    AxisFeedforward,
    CanonicalBlock,
    CompensationSwitch,
    Function,
    GearChange,
    Source,
    SpindleCommand,
    SpindleFeedforward,
    SpindleFunction,
    SpindleLink,
)
from cnc_ptp.nc.gears import FIRST_M
from cnc_ptp.parameters import ChannelParameters, ChannelSpindle, SpindleParameters, Synchronisation
from cnc_ptp.protocol.blocks import Block, Command, HandshakeRequest, SpindleBlock
from cnc_ptp.protocol.spindle_states import SpindleBit

NO_TOOL_RECORD = 22027


class Moment(Enum):
    """When functions of a block go out."""

    BEFORE = "before the motion"
    EVENT = "with the measuring event"
    AFTER = "after the motion"


class FunctionOutput:
    """Turns the functions of canonical blocks into spindle commands, handshake requests and waits."""

    def __init__(
        self, channel: ChannelParameters, units: Mapping[str, SpindleParameters], request_numbers: Iterator[int]
    ) -> None:
        """`units`: the spindles of the machine by node name."""
        self._channel = channel
        self._request_numbers = request_numbers
        self.spindles = SpindleOutput(channel, units)
        self._leaders: dict[str, str] = {}
        """Slave -> master, by name, of couplings that have ended with the program."""

    @property
    def channel(self) -> str:
        """Name of the channel."""
        return self._channel.name

    def of_block(self, block: CanonicalBlock, moment: Moment) -> Outputs:
        """The functions of `block` that go out at `moment`."""
        outputs = Outputs()
        for function in block.before + block.after:
            if self.moment(function) is moment:
                self._output(function, block, outputs)
        return outputs

    def at_program_start(self) -> list[Command]:
        """What a program start sets back to its initial state."""
        return reset_commands(self._channel)

    def moment(self, function: Function) -> Moment:
        """When a function goes out."""
        synchronisation = self._synchronisation(function)
        if synchronisation & AFTER_MOTION:
            return Moment.AFTER
        return Moment.EVENT if synchronisation & ON_EVENT else Moment.BEFORE

    def gear_change(self, block: CanonicalBlock, feedback: Mapping[str, Block]) -> Outputs:
        """The gear that the block needs: all else of it comes when the spindle is in that gear."""
        outputs = Outputs()
        for function in block.before:
            change = self.spindles.gear_change(function, feedback) if isinstance(function, GearChange) else None
            if isinstance(function, GearChange) and change is not None:
                command, wait = change
                outputs.commands.append(command)
                outputs.waits_before.append(wait)
                outputs.told.append(wait)
                self._tell_gear(function, block, wait, outputs)
        return outputs

    def _tell_gear(self, change: GearChange, block: CanonicalBlock, wait: Wait, outputs: Outputs) -> None:
        """M40 to M45 go to the PLC when the gear changes, as their m_synch says (spindle p.37)."""
        number = FIRST_M + change.stage - 1
        synchronisation = self._channel.m_functions.get(number, Synchronisation.MOS)
        if not synchronisation & OUTPUT:
            return
        spindle, waits = title(self.spindles[change.spindle]), bool(synchronisation & WAITING)
        request = self._request(block.source, "M", spindle, number, waits=waits)
        outputs.requests.append(request)
        if waits:
            wait.request_id = request.id

    def at_program_end(self, feedback: Mapping[str, Block], source: Source) -> Outputs:
        """M05 for the spindles that the PLC wants stopped with the program (2.4.3); the others turn on."""
        wanted = [
            node
            for node, block in feedback.items()
            if isinstance(block, SpindleBlock) and block.status_bits[-1] & SpindleBit.STOP_AT_PROGRAM_END
        ]
        leaders, self._leaders = self._leaders, {}
        turning = self.spindles.turning
        names = [name for name in turning if self.spindles[leaders.get(name, name)].node in wanted]
        return self._stop(names, source, homes=True)

    def at_abort(self, source: Source, keep: Container[str] = ()) -> Outputs:
        """M05 for every spindle that the channel has set in motion, except the nodes in `keep`; couplings end first,
        so that a slave stops whoever has commanded its master.
        """
        self._leaders = {}
        others = [name for name in self.spindles if self.spindles[name].node not in keep]
        moving = {*self.spindles.concern, *self.spindles.slaves}
        outputs = self._stop([name for name in others if name in moving], source, homes=False)
        outputs.commands = self.spindles.decouple_all() + outputs.commands
        for name in others:
            self.spindles.forget(name)
        return outputs

    def acknowledged(self, request: HandshakeRequest) -> None:
        """A spindle that only the PLC knows has come to its position: it stands."""
        for name in self.spindles:
            spindle = self.spindles[name]
            if (request.kind, request.number, request.spindle) == ("M", 19, title(spindle)) and spindle.plc_control:
                self.spindles.concern.drop(name)

    def _stop(self, names: Iterable[str], source: Source, *, homes: bool) -> Outputs:
        """The PLC need not acknowledge: nobody waits for it any more."""
        outputs = Outputs()
        for name in names:
            spindle = self.spindles[name]
            outputs.commands += self.spindles.stop(name, homes=homes)
            outputs.told.append(Wait(spindle.node))
            if self.spindles.told_to_plc(name) and not self.spindles.follows(name):
                outputs.requests.append(self._request(source, "M", title(spindle), 5, waits=False))
        return outputs

    def _synchronisation(self, function: Function) -> Synchronisation:
        match function:
            case SpindleFunction():
                return self.spindles.synchronisation(function)
            case AuxiliaryFunction("M", number):
                return self._channel.m_functions[number]
        return Synchronisation.MOS

    def _output(self, function: Function, block: CanonicalBlock, outputs: Outputs) -> None:
        match function:
            case SpindleFunction():
                self._spindle_function(function, block, outputs)
            case SpindleCommand():
                outputs.commands += self.spindles.plain(function)
                if function.command == "home":
                    outputs.told.append(Wait(self.spindles[function.spindle].node))
            case SpindleLink():
                commands, wait = self.spindles.link(function)
                outputs.commands += commands
                if commands:
                    outputs.add_wait(WAIT_BEFORE, wait)
                if commands and not function.on and block.stop == "end":
                    self._leaders[function.slave] = function.master
            case AuxiliaryFunction():
                self._auxiliary(function, block, outputs)
            case AxisFeedforward() | CompensationSwitch():
                outputs.commands += control_commands(self._channel, function)
                outputs.waits_motion.append(Wait(until_sent=True))
            case SpindleFeedforward():
                outputs.commands += control_commands(self._channel, function)

    def _auxiliary(self, function: AuxiliaryFunction, block: CanonicalBlock, outputs: Outputs) -> None:
        synchronisation = self._synchronisation(function)
        if function.letter == "D":
            outputs.commands += self.spindles.tool_limits(function.number)
            if function.number and function.number not in self._channel.tool_records:
                known = ", ".join(f"D{number}" for number in sorted(self._channel.tool_records)) or "none"
                text = (
                    f"D{function.number} in line {block.source.line} has no record wz[{function.number}] in the machine"
                )
                outputs.notes.append((NO_TOOL_RECORD, f"{text} file, nothing of the tool counts. Known: {known}"))
        if not synchronisation & OUTPUT:
            return
        node = self.spindles[function.spindle].node if function.spindle else ""
        request = self._request(
            block.source, function.letter, node, function.number, waits=bool(synchronisation & WAITING)
        )
        self._ask(request, synchronisation, Wait(), outputs)

    def _spindle_function(self, function: SpindleFunction, block: CanonicalBlock, outputs: Outputs) -> None:
        spindle, synchronisation = self.spindles[function.spindle], self._synchronisation(function)
        acts = self.spindles.acts(function)
        outputs.commands += self.spindles.commands(function)
        if not acts:
            outputs.stored += self.spindles.stored(function)
            return
        wait = self.spindles.wait(function)
        outputs.told.append(wait)
        told = self.spindles.told_to_plc(function.spindle) or synchronisation & Synchronisation.PLC_INFO
        if told and not self.spindles.follows(function.spindle):
            self._ask(self._of_spindle(function, spindle, synchronisation, block), synchronisation, wait, outputs)
        elif synchronisation & WAITING:
            outputs.add_wait(synchronisation, wait)

    def _of_spindle(
        self,
        function: SpindleFunction,
        spindle: ChannelSpindle,
        synchronisation: Synchronisation,
        block: CanonicalBlock,
    ) -> HandshakeRequest:
        kind, number = ("S", 0) if function.m is None else ("M", function.m)
        return self._request(
            block.source,
            kind,
            title(spindle),
            number,
            waits=bool(synchronisation & WAITING),
            value=function.speed_rpm or 0.0,
            position=function.position_deg or 0.0,
            direction=function.direction,
        )

    def _ask(self, request: HandshakeRequest, synchronisation: Synchronisation, wait: Wait, outputs: Outputs) -> None:
        """The PLC is told; where it has to acknowledge, `wait` waits for that too."""
        outputs.requests.append(request)
        if request.acknowledge_needed:
            wait.request_id = request.id
            outputs.add_wait(synchronisation, wait)

    def _request(
        self,
        source: Source,
        kind: str,
        spindle: str,
        number: int,
        *,
        waits: bool,
        value: float = 0.0,
        position: float = 0.0,
        direction: str = "",
    ) -> HandshakeRequest:
        request_id, line = next(self._request_numbers), source.line
        return HandshakeRequest(
            0, request_id, self._channel.name, kind, spindle, number, value, line, waits, position, direction
        )


def title(spindle: ChannelSpindle) -> str:
    """What the PLC knows a spindle by: its node, or its own name where it has none."""
    return spindle.node or spindle.own_name or spindle.name
