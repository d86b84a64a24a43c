"""Output of the M, S, T, D and H functions of an NC block to spindles and PLC, and the waits of the path for them.

Synchronisation types: TF5200 spindle 2.5. Before the motion go all types but MNS_SNS (after it) and MNE_SNS (with the
measuring event). The path waits before the motion for MVS_SVS, at the block's end for MVS_SNS, MNS_SNS and MNE_SNS,
before the next G01, G02, G03 for MVS_SLM, at the next #EXPL SYN for MVS_SLP, never for MOS. In one block M19 decides
before M3, M4, M5, and these before S. Feedforward and compensations of axes act from the start of the next motion on.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping
from typing import Any

from cnc_ptp.channel.commanded_spindle import CommandedSpindle
from cnc_ptp.channel.control_functions import control_commands, reset_commands
from cnc_ptp.channel.cutting_speed import ConstantCuttingSpeed
from cnc_ptp.channel.handshake import UNSENT
from cnc_ptp.channel.spindle_functions import SpindleFunctions
from cnc_ptp.channel.spindle_reports import NOTHING, Expectation
from cnc_ptp.channel.waits import OUTPUT, WAITING, Moment, Outgoing, Wait, goes_out, waits_until
from cnc_ptp.nc.canonical import (
    AuxiliaryFunction,
    AxisFeedforward,
    CanonicalBlock,
    CompensationSwitch,
    CuttingSpeed,
    ExplicitSynchronisation,
    Function,
    GearChange,
    LanguageWarning,
    MachineData,
    Message,
    OrderedError,
    Source,
    SpindleCommand,
    SpindleFeedforward,
    SpindleFunction,
    SpindleLink,
)
from cnc_ptp.nc.gears import FIRST_M
from cnc_ptp.parameters import ChannelParameters, SpindleParameters, Synchronisation
from cnc_ptp.protocol.blocks import Command, HandshakeRequest

SPEED_WITHOUT_EFFECT = 22023


class FunctionOutput:
    """Turns the functions of canonical blocks into spindle commands, handshake requests and waits."""

    def __init__(
        self, channel: ChannelParameters, units: Mapping[str, SpindleParameters], request_numbers: Iterator[int]
    ) -> None:
        """`units`: the spindles of the machine by node name."""
        self._channel = channel
        self._request_numbers = request_numbers
        self.spindles = SpindleFunctions(channel, units)
        self.cutting_speed = ConstantCuttingSpeed(self.spindles)

    def of_block(self, block: CanonicalBlock, moment: Moment) -> Outgoing:
        """The functions of `block` that go out at `moment`."""
        outgoing = Outgoing()
        for function in block.functions:
            if self.moment(function) is moment:
                self._add(function, block, outgoing)
        return outgoing

    def at_program_start(self) -> list[Command]:
        """Resets what a program start sets back to its initial state."""
        self.cutting_speed.end()
        return reset_commands(self._channel)

    def moment(self, function: Function) -> Moment:
        """When a function goes out."""
        return goes_out(self._synchronisation(function))

    def without_stop(self, block: CanonicalBlock) -> bool:
        """The path may go on into the block: all its functions go out as it passes, and it waits for none of them."""
        return all(self._passes(function) for function in block.functions)

    def _passes(self, function: Function) -> bool:
        match function:
            case SpindleFunction() | AuxiliaryFunction():
                synchronisation = self._synchronisation(function)
                waits = waits_until(synchronisation)
                return goes_out(synchronisation) is Moment.BEFORE and waits in (None, Moment.EXPLICIT)
            case Message() | LanguageWarning() | ExplicitSynchronisation() | CuttingSpeed():
                return True
            case OrderedError():
                return not function.severe
        return False

    def waits_late(self, block: CanonicalBlock) -> bool:
        """#EXPL SYN waits for a function of the block."""
        return any(waits_until(self._synchronisation(function)) is Moment.EXPLICIT for function in block.functions)

    def goes_out_behind(self, block: CanonicalBlock) -> bool:
        """A function of the block goes out when its motion has ended, or with the measuring event."""
        return any(self.moment(function) is not Moment.BEFORE for function in block.functions)

    def gear_change(self, block: CanonicalBlock) -> Outgoing:
        """The gear that the block needs: everything else of the block follows when the spindle is in that gear."""
        outgoing = Outgoing()
        for function in block.functions:
            change = self.spindles.change_gear(function) if isinstance(function, GearChange) else None
            if isinstance(function, GearChange) and change is not None:
                command, expectation = change
                outgoing.commands.append(command)
                outgoing.expected.append(expectation)
                wait = Wait(Moment.BEFORE, expectation)
                outgoing.waits.append(wait)
                self._request_gear(function, block, wait, outgoing)
        return outgoing

    def _request_gear(self, change: GearChange, block: CanonicalBlock, wait: Wait, outgoing: Outgoing) -> None:
        """M40 to M45 go to the PLC when the gear changes, as their m_synch says (spindle p.37)."""
        number = FIRST_M + change.stage - 1
        synchronisation = self._channel.m_functions.get(number, Synchronisation.MOS)
        if not synchronisation & OUTPUT:
            return
        request = self._request(block.source, "M", self.spindles[change.spindle].title, number, synchronisation)
        outgoing.requests.append(request)
        if request.acknowledge_needed:
            wait.request_id = request.id

    def at_program_end(self, source: Source) -> Outgoing:
        """M05 for the spindles that the PLC wants stopped with the program (2.4.3); the others continue to turn."""
        self.cutting_speed.end()
        stopped = [spindle for spindle in self.spindles.turning if (spindle.leader or spindle).stops_at_program_end]
        self._forget_leaders()
        return self._stop(stopped, source, homes=True)

    def at_abort(self, source: Source, keep: Container[str] = ()) -> Outgoing:
        """M05 for every spindle that the channel has started, except the nodes in `keep`; couplings end first,
        so that a slave stops whoever has commanded its master.
        """
        self._forget_leaders()
        self.cutting_speed.end()
        others = [spindle for spindle in self.spindles if spindle.node not in keep]
        moving = [spindle for spindle in others if spindle.responsible or spindle.coupled]
        outgoing = self._stop(moving, source, homes=False)
        outgoing.commands = self.spindles.decouple_all() + outgoing.commands
        for spindle in others:
            spindle.forget()
        return outgoing

    def _forget_leaders(self) -> None:
        for spindle in self.spindles:
            spindle.leader = None

    def withdraw(self) -> None:
        """The program was aborted: functions that have not gone out are not sent."""
        for spindle in self.spindles:
            spindle.withdraw()

    def expect_nothing(self, keep: Container[str] = ()) -> None:
        """What earlier programs have commanded does not matter, except to the spindles (nodes) in `keep`."""
        for spindle in self.spindles:
            if spindle.node not in keep:
                spindle.expect_nothing()

    def acknowledged(self, request: HandshakeRequest) -> None:
        """A spindle that only the PLC knows has reached its position: it is at a standstill."""
        for spindle in self.spindles:
            if (request.kind, request.number, request.spindle) == ("M", 19, spindle.title) and spindle.unit is None:
                spindle.dismiss()

    def _stop(self, spindles: Iterable[CommandedSpindle], source: Source, *, homes: bool) -> Outgoing:
        """The PLC need not acknowledge: nobody waits for it."""
        outgoing = Outgoing()
        for spindle in spindles:
            outgoing.commands += self.spindles.stop(spindle, homes=homes)
            outgoing.expected.append(Expectation(spindle.node))
            if spindle.reported_to_plc and not spindle.follows:
                outgoing.requests.append(self._request(source, "M", spindle.title, 5, Synchronisation.MOS))
        return outgoing

    def _synchronisation(self, function: Function) -> Synchronisation:
        match function:
            case SpindleFunction():
                return self.spindles.synchronisation(function)
            case AuxiliaryFunction("M", number):
                return self._channel.m_functions[number]
            case AuxiliaryFunction("H", number):
                return self._channel.h_functions.get(number, Synchronisation.MOS)
        return Synchronisation.MOS

    def _add(self, function: Function, block: CanonicalBlock, outgoing: Outgoing) -> None:
        match function:
            case SpindleFunction():
                self._spindle_function(function, block.source, outgoing)
            case SpindleCommand():
                outgoing.commands += self.spindles.plain(function)
                if function.command == "home":
                    outgoing.expected.append(Expectation(self.spindles[function.spindle].node))
            case SpindleLink():
                self._link(function, outgoing, at_end=block.stop == "end")
            case AuxiliaryFunction():
                self._auxiliary(function, block.source, outgoing)
            case CuttingSpeed():
                self.cutting_speed.take(function)
            case AxisFeedforward() | CompensationSwitch() | MachineData():
                outgoing.commands += control_commands(self._channel, function)
                outgoing.waits.append(Wait(Moment.NEXT_MOTION, until_sent=True))
            case SpindleFeedforward():
                outgoing.commands += control_commands(self._channel, function)

    def _link(self, link: SpindleLink, outgoing: Outgoing, *, at_end: bool) -> None:
        commands, expectation = self.spindles.link(link)
        if not commands:
            return
        outgoing.commands += commands
        outgoing.waits.append(Wait(Moment.BEFORE, expectation))
        if at_end and not link.on:
            self.spindles[link.slave].leader = self.spindles[link.master]

    def _auxiliary(self, function: AuxiliaryFunction, source: Source, outgoing: Outgoing) -> None:
        synchronisation = self._synchronisation(function)
        if function.letter == "D":
            outgoing.commands += self.spindles.tool_limits(function.number)
        if synchronisation & OUTPUT:
            node = self.spindles[function.spindle].node if function.spindle else ""
            request = self._request(
                source, function.letter, node, function.number, synchronisation, value=function.value
            )
            self._ask(request, synchronisation, NOTHING, outgoing)

    def _spindle_function(self, function: SpindleFunction, source: Source, outgoing: Outgoing) -> None:
        spindle, synchronisation = self.spindles[function.spindle], self._synchronisation(function)
        commands, expectation = self.spindles.command(function)
        outgoing.commands += commands
        if expectation is None:
            note = self.spindles.without_effect(function)
            outgoing.notes += [(SPEED_WITHOUT_EFFECT, note)] if note else []
            return
        outgoing.expected.append(expectation)
        if (spindle.reported_to_plc or synchronisation & Synchronisation.PLC_INFO) and not spindle.follows:
            self._ask(self._of_spindle(function, source), synchronisation, expectation, outgoing)
        else:
            outgoing.add_wait(synchronisation, expectation)

    def _of_spindle(self, function: SpindleFunction, source: Source) -> HandshakeRequest:
        kind, number = ("S", 0) if function.m is None else ("M", function.m)
        return self._request(
            source,
            kind,
            self.spindles[function.spindle].title,
            number,
            self._synchronisation(function),
            value=function.speed_rpm or 0.0,
            position=function.position_deg or 0.0,
            direction=function.direction,
        )

    def _ask(
        self, request: HandshakeRequest, synchronisation: Synchronisation, expected: Expectation, outgoing: Outgoing
    ) -> None:
        """The PLC is notified; if it has to acknowledge, the path waits for that too."""
        outgoing.requests.append(request)
        if request.acknowledge_needed:
            outgoing.add_wait(synchronisation, expected, request.id)

    def _request(
        self, source: Source, kind: str, spindle: str, number: int, synchronisation: Synchronisation, **words: Any
    ) -> HandshakeRequest:
        """`words`: value, position and direction, if the function has them."""
        return HandshakeRequest(
            cycle=UNSENT,
            id=next(self._request_numbers),
            channel=self._channel.name,
            kind=kind,
            spindle=spindle,
            number=number,
            value=words.pop("value", 0.0),
            line=source.line,
            acknowledge_needed=bool(synchronisation & WAITING),
            synchronisation=synchronisation.constants,
            **words,
        )
